// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/config/columns.hpp"
#include "dampline/sample.hpp"

namespace dampline::app {

/// As messages and results call them, by Channel.
inline constexpr std::array<std::string_view, kChannels> kTruckChannels{"frame", "wheelset1",
                                                                        "wheelset2"};

struct CarConfig {
  double moving_mass_kg{37200.0};             ///< truck frame and its share of the body
  std::optional<double> far_mass_kg;          ///< of the body at the other truck; absent: no sensor
  std::optional<double> frame_pitch_mass_kg;  ///< I / a^2 of the frame; absent: no sensor
  std::optional<double> suspension_stiffness_npm;  ///< start value; absent: unknown
  std::optional<double> wheelbase_m;               ///< of the truck; absent: unknown
  /// By Extra: the accelerometers that the masses ask for.
  [[nodiscard]] std::array<bool, kExtras> extras() const {
    return {frame_pitch_mass_kg.has_value(), far_mass_kg.has_value()};
  }
};

/// Frames on a bus or in a candump log. A signal is MESSAGE.SIGNAL of the DBC file.
struct CanConfig {
  std::string dbc;  ///< path, relative to the configuration file; empty: the project's own sensors
  std::array<std::string, kChannels> accel{};      ///< indexed by Channel; empty: the project's own
  std::array<std::string, kExtras> extra_accel{};  ///< by Extra; empty: the project's own
  std::array<std::string, kChannels> counter{};    ///< empty: found in the accel's message by name
  std::string interface;                           ///< empty: every interface of the log
  int receive_buffer_kib{4096};                    ///< of a live interface's socket
};

/// Anti-aliasing filters of the sensors: Butterworth low passes.
struct AntiAliasInput {
  double corner_hz{100.0};                                ///< -3 dB; 0: none, or not known
  std::array<std::optional<double>, kChannels> own_hz{};  ///< where a channel's is another
  int order{4};
};

struct InputConfig {
  static constexpr double kHighestRateHz = 1e5;
  double sample_rate_hz{300.0};    ///< nominal; the records' own time decides
  bool sample_rate_is_set{false};  ///< by the configuration; a CSV file has its own otherwise
  AntiAliasInput anti_alias;
  CanConfig can;
  std::array<std::string, kColumns> columns{};  ///< header names; empty: the canonical name
  std::array<double, kColumns> scale{};  ///< factor from the file's number to the canonical unit
  /// Full scale per channel: |a| at or beyond it is clipping. Absent: from the DBC, or not known.
  std::array<std::optional<double>, kChannels> range_mps2{};
  /// White noise of each sensor, rms per sample. Absent: unknown, and more of it is no fault.
  std::array<std::optional<double>, kChannels> noise_mps2{};
  /// Of the car, where it hardly changes and something else measured it. Absent: unknown.
  std::optional<double> speed_mps;
  std::string leading{"unknown"};  ///< which wheelset meets the track first
  InputConfig() { scale.fill(1.0); }
  [[nodiscard]] std::string header(Column column) const {
    const std::string& own = columns[index(column)];
    return own.empty() ? std::string{name(column)} : own;
  }
};

struct ModelConfig {
  std::vector<std::string> base{"coulomb"};  ///< effect names beside the linear spring
  bool base_is_set{false};  ///< by the configuration; of a rig the record tells otherwise
  std::vector<std::string> candidates{"all"};  ///< effect names, or "all"
  std::string inertia{
      "auto"};  ///< of a rig's force: "identify", "none"; "auto": explain tells, else none
  /// Linear spring: "none", "identify", or "auto": identified for a truck, none in a rig's force.
  std::string stiffness{"auto"};
  std::optional<double> rig_corner_hz;  ///< of a rig's test function; absent: "auto", from the data
  std::vector<double> curve_nodes_mps;  ///< right ends of the curve's segments; empty: default
  std::optional<double> velocity_corner_hz;  ///< absent: "auto", from the measured noise
};

struct EstimateConfig {
  std::string methods{"wavelet"};  ///< of a truck: "wavelet", or "all": the others beside it
  std::string memory{"infinite"};  ///< "infinite", "window" or "forgetting"
  double window_s{600.0};
  double time_constant_s{600.0};
};

/// The guards that name faults of the data.
struct GuardSettings {
  /// Samples wait so long for what the guards find before anything is made of them. 0: they do not
  /// wait, faults are named all the same.
  double wait_s{24.0};
};

/// Recording of a live run.
struct BlackboxSettings {
  int rotate_mib{64};        ///< a new file beyond this size
  double rotate_s{3600.0};   ///< and after this time
  int keep_mib{8192};        ///< the oldest files go beyond this size of all; 0: none goes
  double keep_s{0.0};        ///< and beyond this age; 0: none goes
  int reserve_free_mib{64};  ///< stays free on the disk, for the results
  double sync_s{1.0};        ///< at most so much is lost with the power
};

/// Of a live run.
struct LiveSettings {
  int keep_runs{0};  ///< run directories without --out, the oldest go; 0: none goes
};

/// Where a live run can be seen while it runs.
struct ServeSettings {
  std::string address;              ///< "127.0.0.1:9464"; empty: nowhere
  std::string token_file;           ///< its first line is what a reader must know; empty: nothing
  std::string cert_file, key_file;  ///< of this server; empty: no TLS
  std::string client_ca_file;       ///< who vouches for readers; empty: nobody has to
};

/// The MQTT broker that a live run tells.
struct MqttSettings {
  std::string broker;  ///< "127.0.0.1:1883"; empty: none
  std::string topic{"dampline"};
  std::string user, password_file;
  std::string ca_file;              ///< TLS; empty: none
  std::string cert_file, key_file;  ///< of this client
};

/// The states of a live run's segments on disk, from where `forward` sends them.
struct SpoolSettings {
  std::string folder;        ///< empty: none are kept
  double segment_s{3600.0};  ///< full hours of UTC
  double every_s{300.0};     ///< between two states of a segment
  std::string kind{"full"};  ///< or "light"
  int keep_mib{1024};        ///< of all states; then the oldest sent ones go
  int reserve_free_mib{16};  ///< stays free on the disk
};

/// What a live run tells at once.
struct AlarmSettings {
  std::optional<double> coulomb_below_n;
  std::optional<double> coulomb_above_n;
  std::string reference;                ///< run directory; empty: none
  std::optional<double> below_percent;  ///< of the reference's level
  std::optional<double> above_percent;
  std::string drift{"no"};          ///< "yes": the watch over parameters tells, too
  std::vector<std::string> faults;  ///< names, or "all"
  double hysteresis_percent{2.0};   ///< of a limit
  double hold_s{30.0};
  std::vector<std::string> on_alarm;  ///< program and its arguments; empty: none
};

/// Digital lines of a live run.
struct GpioConfig {
  std::string chip;                ///< "gpiochip0"; empty: no lines are used
  std::vector<std::string> edges;  ///< "pulse:3", "marker:4:active_low", "wheel:5"
  std::string lamp;                ///< "7" or "7:active_low"; empty: no lamp
};

/// What a record is of: words that the results carry with them.
struct RecordLabels {
  std::string vehicle;
  std::string truck;
  std::string load;
  std::string note;
};

/// Everything a person can set, with defaults that work.
struct Config {
  RecordLabels record;
  CarConfig car;
  InputConfig input;
  ModelConfig model;
  EstimateConfig estimate;
  GuardSettings guards;
  BlackboxSettings blackbox;
  LiveSettings live;
  ServeSettings serve;
  MqttSettings mqtt;
  SpoolSettings spool;
  AlarmSettings alarm;
  GpioConfig gpio;
  /// Those that the file has; none of a run directory's own run.toml, which has them all.
  std::vector<std::string> tables;
};

/// Reads a TOML file over the defaults. Relative paths in it become relative to its folder.
/// Throws UsageError naming file, line and key for an unknown key, a wrong type or a value out of
/// range, or no key at all; the table [run] of a run directory's own run.toml is passed over.
[[nodiscard]] Config load_config(const std::filesystem::path& file);

/// The same from text; `origin` is what errors call it.
[[nodiscard]] Config parse_config(std::string_view text, const std::string& origin);

/// The complete configuration as TOML that loads back to the same values.
[[nodiscard]] std::string show_config(const Config& config);

}  // namespace dampline::app
