// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dampline/can_frame.hpp"
#include "sim_hw/noise.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {

/// What a bus or a logger does wrong.
struct TransportConfig {
  double loss_fraction{0.0};  ///< of the frames, each by itself
  double swap_fraction{0.0};  ///< of the frames: arrive after the next frame of their message
  double swap_time_s{-1.0};   ///< one swap of the frame channel at this time; negative: none
};

/// At most this many frames leave per sampling instant: each node's own and one that was held.
inline constexpr std::size_t kMaxFramesPerTick = 2 * kChannels;

class Transport {
 public:
  Transport(const TransportConfig& config, std::uint64_t seed);
  /// Takes the frames of one instant, gives those that arrive now, in the order of arrival.
  /// The span is valid until the next call.
  [[nodiscard]] std::span<const CanFrame> pass(const std::array<CanFrame, kChannels>& frames,
                                               double time_s) noexcept;

 private:
  struct Held {
    bool full{false};
    CanFrame frame{};
  };
  [[nodiscard]] Held* held_for(std::uint32_t id) noexcept;
  [[nodiscard]] bool swaps(std::size_t position, double time_s) noexcept;
  void emit(const CanFrame& frame) noexcept { out_[count_++] = frame; }
  TransportConfig config_;
  Random random_;
  bool swap_done_;
  bool active_;
  std::array<Held, kChannels> held_{};
  std::array<CanFrame, kMaxFramesPerTick> out_{};
  std::size_t count_{0};
};

/// What `add_fault_text` understands, one per line with its parameters and their defaults.
inline constexpr std::string_view kFaultHelp =
    "loss:fraction=0.05 (of the frames) | "
    "swap:fraction=0 and time_s=-1 (frames that arrive after the next of their message) | "
    "clipping:channel=wheelset1,range_mps2=3 (the sensor's full scale; needs its own DBC) | "
    "soft_clipping:channel=wheelset1,limit_mps2=3 (below full scale) | "
    "stuck:channel=wheelset1,start_s=100,end_s=130";

/// Adds a sensor or transport fault from text, NAME or NAME:parameter=value,...
/// Returns what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> add_fault_text(SimulationConfig& config,
                                                        TransportConfig& transport,
                                                        std::string_view text);

/// Faults of sensors and of transport between the anti-alias filter and the reader of the record.
/// Arrays are indexed by dampline::Channel; zero switches a fault off. What begins, begins at
/// start_s; what ends, ends at end_s.
struct RecordFaultConfig {
  double start_s{150.0};
  double end_s{180.0};
  std::array<double, kChannels> delay_step_s{};     ///< later (positive) from start_s on
  std::array<double, kChannels> jitter_s{};         ///< of each sampling instant, rms
  bool jitter_is_stamped{false};                    ///< in FaultyRecord::stamped()
  std::array<double, kChannels> clock_drift_ppm{};  ///< delay that grows over the whole record
  std::array<int, kChannels> lost_samples{};        ///< at start_s, in this channel only
  std::array<int, kChannels> repeated_samples{};    ///< at start_s, in this channel only
  int lost_everywhere{0};                           ///< at start_s, nobody counts them
  int counted_lost{0};                              ///< at start_s, the counter shows them
  int repeated_everywhere{0};                       ///< samples sent twice, 1.7 s apart
  std::array<double, kChannels> gain_step{};        ///< 0.03: 3 % more from start_s on
  std::array<double, kChannels> gain_drift{};       ///< reached linearly at end_s, from start_s
  std::array<double, kChannels> saturation_mps2{};  ///< reads s tanh(a / s)
  std::array<double, kChannels> dc_jump_mps2{};
  double dc_jump_time_s{0.0};                  ///< over which the zero moves: 0, at once
  std::array<double, kChannels> noise_mps2{};  ///< white, more of it, all the time
  std::array<double, kChannels> burst_mps2{};  ///< white, from start_s to end_s
  std::array<int, kChannels> spikes{};         ///< single wrong samples, at random times
  double spike_mps2{20.0};                     ///< their height
  double record_s{300.0};                      ///< spikes are spread over this
  /// Contacts that open a second, each for 2 to 50 ms, from start_s to end_s: a loose cable.
  std::array<double, kChannels> opens_hz{};
  double open_mps2{0.0};                   ///< what an open contact reads
  std::array<int, kChannels> lost_bits{};  ///< lowest bits that stay 0
  std::array<bool, kChannels> inverted{};
  std::array<std::size_t, kChannels> source{0, 1, 2};  ///< {1, 0, 2}: frame and wheelset 1 swapped
};

/// A simulated record with faults, sample by sample.
class FaultyRecord {
 public:
  FaultyRecord(const SimulationConfig& simulation, const RecordFaultConfig& faults);
  [[nodiscard]] SimulatedSample next();
  /// The newest as a sample, with its channels' own stamps.
  [[nodiscard]] Sample stamped() const;

 private:
  static constexpr std::int64_t kHistory = 512;
  static constexpr std::int64_t kAhead = 96;
  static constexpr std::int64_t kHalfTaps = 24;

  void pull();
  [[nodiscard]] const SimulatedSample& at(std::int64_t n) const;
  [[nodiscard]] double delay_samples(std::size_t channel, double time_s) const;
  [[nodiscard]] double delayed(std::size_t channel, double time_s);
  [[nodiscard]] bool is_open(std::size_t channel, std::int64_t n, double time_s);
  [[nodiscard]] double distorted(std::size_t channel, double accel_mps2, double time_s);
  void convert(SimulatedSample& sample, std::size_t channel, double accel_mps2) const;
  [[nodiscard]] SimulatedSample faulty(std::int64_t n);

  SimulationConfig simulation_config_;
  RecordFaultConfig faults_;
  Simulation simulation_;
  Random random_;
  std::vector<SimulatedSample> ring_;
  std::array<std::vector<std::int64_t>, kChannels> spike_ticks_{};
  std::array<std::int64_t, kChannels> open_until_{};
  std::int64_t pulled_{0};  // samples of the simulation so far
  std::int64_t source_{0};  // the next to hand out
  std::int64_t tick_{0};
  int repeats_left_{0};
  bool repeated_{false};
  SimulatedSample last_{};
  std::array<double, kChannels> late_s_{};  // that the newest was taken later, by jitter
};

}  // namespace dampline::sim
