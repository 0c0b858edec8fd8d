// SPDX-License-Identifier: MIT
#include "app/config/fields.hpp"

#include "dampline/faults.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::app {
namespace {

/// Names of the physical effects that a model may contain or lack.
constexpr std::array<std::string_view, 24> kEffects{"viscous",
                                                    "asymmetric_viscous",
                                                    "quadratic_damping",
                                                    "progressive_damping",
                                                    "coulomb",
                                                    "asymmetric_coulomb",
                                                    "offset_force",
                                                    "progressive_friction",
                                                    "stribeck",
                                                    "viscoelastic",
                                                    "presliding_hysteresis",
                                                    "backlash",
                                                    "bump_stop",
                                                    "cubic_stiffness",
                                                    "quadratic_stiffness",
                                                    "time_drift",
                                                    "unmodelled_mode",
                                                    "other_truck",
                                                    "time_skew",
                                                    "gain_error",
                                                    "cross_axis",
                                                    "asymmetric_stiffness",
                                                    "impulsive_input",
                                                    "all"};

constexpr std::array<std::string_view, 3> kInertiaWords{"auto", "identify", "none"};
constexpr std::array<std::string_view, 3> kStiffnessWords{"auto", "identify", "none"};
constexpr std::array<std::string_view, 2> kMethodWords{"wavelet", "all"};
constexpr std::array<std::string_view, 3> kMemoryWords{"infinite", "window", "forgetting"};
constexpr std::array<std::string_view, 3> kLeadingWords{"unknown", "wheelset1", "wheelset2"};
constexpr std::array<std::string_view, 2> kYesNoWords{"no", "yes"};
constexpr std::array<std::string_view, 2> kStateKindWords{"full", "light"};
/// Of the faults, and all of them.
constexpr auto kFaultWords = [] {
  std::array<std::string_view, kFaultKinds + 1> out{};
  for (std::size_t i = 0; i < kFaultKinds; ++i) out[i] = name_of(static_cast<FaultKind>(i));
  out.back() = "all";
  return out;
}();
constexpr std::array<double, 2> kCornersHz{0.7, 1.0};
constexpr std::array<std::string_view, kChannels> kAccelKeys{"frame_accel", "wheelset1_accel",
                                                             "wheelset2_accel"};
constexpr std::array<std::string_view, kExtras> kExtraKeys{"frame_end_accel", "far_frame_accel"};
constexpr std::array<std::string_view, kChannels> kCounterKeys{"frame_counter", "wheelset1_counter",
                                                               "wheelset2_counter"};

constexpr std::array<std::string_view, kChannels> kCornerKeys{
    "frame_corner_hz", "wheelset1_corner_hz", "wheelset2_corner_hz"};

using Fields = std::vector<Field>;

void add_record(RecordLabels& record, Fields& out) {
  out.push_back({"record", "vehicle", "whose record it is: number of the car, or of the rig",
                 TextField{&record.vehicle, {}}});
  out.push_back({"record", "truck", "which truck of it", TextField{&record.truck, {}}});
  out.push_back({"record", "load", R"("laden", "empty": what merges are grouped by)",
                 TextField{&record.load, {}}});
  out.push_back({"record", "note", "anything that a reader should know: route, parts changed",
                 TextField{&record.note, {}}});
}

void add_car(CarConfig& car, Fields& out) {
  out.push_back({"car", "moving_mass_kg", "truck frame and its share of the body",
                 NumberField{&car.moving_mass_kg, {1.0, 1e6}}});
  out.push_back({"car", "far_mass_kg",
                 "body's mass at the other truck; with it, far_frame_accel is wanted",
                 OptionalNumberField{&car.far_mass_kg, {1.0, 1e6}, ""}});
  out.push_back({"car", "frame_pitch_mass_kg",
                 "I / a^2 of the frame's pitch; with it, frame_end_accel is wanted",
                 OptionalNumberField{&car.frame_pitch_mass_kg, {1.0, 1e6}, ""}});
  out.push_back({"car", "suspension_stiffness_npm", "start value, identified too; absent: unknown",
                 OptionalNumberField{&car.suspension_stiffness_npm, {1.0, 1e12}, ""}});
  out.push_back({"car", "wheelbase_m", "of the truck, for the guards; absent: unknown",
                 OptionalNumberField{&car.wheelbase_m, {0.3, 10.0}, ""}});
}

void add_can(CanConfig& can, Fields& out) {
  out.push_back(
      {"input.can", "dbc", "empty: the project's own simulated sensors", TextField{&can.dbc, {}}});
  for (std::size_t c = 0; c < kChannels; ++c)
    out.push_back({"input.can", kAccelKeys[c], "MESSAGE.SIGNAL of the DBC file, in m/s^2",
                   TextField{&can.accel[c], {}}});
  for (std::size_t e = 0; e < kExtras; ++e)
    out.push_back({"input.can", kExtraKeys[e], "of a fourth and fifth accelerometer, see [car]",
                   TextField{&can.extra_accel[e], {}}});
  for (std::size_t c = 0; c < kChannels; ++c)
    out.push_back({"input.can", kCounterKeys[c], "sample counter; empty: found by its name",
                   TextField{&can.counter[c], {}}});
  out.push_back({"input.can", "interface", "only frames of this one; empty: all",
                 TextField{&can.interface, {}}});
  out.push_back({"input.can", "receive_buffer_kib", "of a live interface's socket",
                 IntegerField{&can.receive_buffer_kib, {4.0, 1048576.0}}});
}

void add_csv(InputConfig& input, Fields& out) {
  for (std::size_t i = 0; i < kColumns; ++i)
    out.push_back({"input.columns", kColumnNames[i], "header name in the file; empty: this name",
                   TextField{&input.columns[i], {}}});
  for (std::size_t i = 0; i < kColumns; ++i)
    out.push_back({"input.scale", kColumnNames[i], "factor from the file's number to this unit",
                   NumberField{&input.scale[i], {-1e12, 1e12}}});
}

void add_input(InputConfig& input, Fields& out) {
  out.push_back({"input", "sample_rate_hz",
                 "nominal; the records' own time decides, and a CSV file's where this is absent",
                 NumberField{&input.sample_rate_hz, {1.0, InputConfig::kHighestRateHz}}});
  out.push_back({"input", "speed_mps", "of the car, if constant and known; absent: unknown",
                 OptionalNumberField{&input.speed_mps, {0.1, 150.0}, ""}});
  out.push_back({"input", "leading", "which wheelset meets the track first",
                 TextField{&input.leading, kLeadingWords}});
  out.push_back({"input.anti_alias", "corner_hz", "of the sensors' low-pass; 0: none, or unknown",
                 NumberField{&input.anti_alias.corner_hz, {0.0, 1e5}}});
  for (std::size_t c = 0; c < kChannels; ++c)
    out.push_back({"input.anti_alias", kCornerKeys[c], "of that sensor; absent: corner_hz",
                   OptionalNumberField{&input.anti_alias.own_hz[c], {1.0, 1e5}, ""}});
  out.push_back({"input.anti_alias", "order", "of that Butterworth filter",
                 IntegerField{&input.anti_alias.order, {1.0, 8.0}}});
  for (std::size_t c = 0; c < kChannels; ++c)
    out.push_back({"input.range_mps2", kTruckChannels[c],
                   "|a| at or beyond it is clipping; absent: from the DBC file",
                   OptionalNumberField{&input.range_mps2[c], {1e-3, 1e6}, ""}});
  for (std::size_t c = 0; c < kChannels; ++c)
    out.push_back({"input.noise_mps2", kTruckChannels[c],
                   "white noise of the sensor, rms; absent: unknown",
                   OptionalNumberField{&input.noise_mps2[c], {1e-6, 1e3}, ""}});
  add_can(input.can, out);
  add_csv(input, out);
}

void add_model(ModelConfig& model, Fields& out) {
  constexpr std::span<const std::string_view> kAll{kEffects};
  out.push_back({"model", "base", "effects beside the linear spring",
                 TextListField{&model.base, kAll.first(kEffects.size() - 1)}});
  out.push_back({"model", "candidates", "effects to try where the base fails",
                 TextListField{&model.candidates, kAll}});
  out.push_back({"model", "inertia",
                 "of a rig's force: identify for a driven mass; auto: explain tells, else none",
                 TextField{&model.inertia, kInertiaWords}});
  out.push_back({"model", "stiffness", "linear spring; auto: identified for a truck, none on a rig",
                 TextField{&model.stiffness, kStiffnessWords}});
  out.push_back({"model", "rig_corner_hz", "of a rig's test function; auto: from the data",
                 OptionalNumberField{&model.rig_corner_hz, {1e-3, 1e5}, "auto"}});
  out.push_back({"model", "curve_nodes_mps", "right ends of the 8 segments; empty: default",
                 NumberListField{&model.curve_nodes_mps, {1e-5, 10.0}, kCurveSegments}});
  out.push_back({"model", "velocity_corner_hz",
                 "of the drift filter, 0.7 or 1.0; auto: from the noise",
                 OptionalNumberField{&model.velocity_corner_hz, {0.7, 1.0}, "auto", kCornersHz}});
}

void add_estimate(EstimateConfig& estimate, Fields& out) {
  out.push_back({"estimate", "methods",
                 "of a truck: wavelet, or all: Fokker-Planck, known input and phase beside it",
                 TextField{&estimate.methods, kMethodWords}});
  out.push_back({"estimate", "memory", "infinite, window or forgetting",
                 TextField{&estimate.memory, kMemoryWords}});
  out.push_back({"estimate", "window_s", "length of the window",
                 NumberField{&estimate.window_s, {10.0, 1e7}}});
  out.push_back({"estimate", "time_constant_s", "of forgetting",
                 NumberField{&estimate.time_constant_s, {10.0, 1e7}}});
}

void add_guards(GuardSettings& guards, Fields& out) {
  out.push_back({"guards", "wait_s", "samples wait so long for the guards; 0: nothing is left out",
                 NumberField{&guards.wait_s, {0.0, 25.0}}});
}

void add_blackbox(BlackboxSettings& blackbox, Fields& out) {
  out.push_back({"blackbox", "rotate_mib", "a live recording begins a new file beyond this size",
                 IntegerField{&blackbox.rotate_mib, {1.0, 65536.0}}});
  out.push_back(
      {"blackbox", "rotate_s", "and after this time", NumberField{&blackbox.rotate_s, {1.0, 1e7}}});
  out.push_back({"blackbox", "keep_mib", "the oldest files go beyond this size of all; 0: none",
                 IntegerField{&blackbox.keep_mib, {0.0, 1e9}}});
  out.push_back({"blackbox", "keep_s", "and beyond this age; 0: none",
                 NumberField{&blackbox.keep_s, {0.0, 3.2e9}}});
  out.push_back({"blackbox", "reserve_free_mib",
                 "stays free on the disk; the oldest files go, or recording stops",
                 IntegerField{&blackbox.reserve_free_mib, {0.0, 1e9}}});
  out.push_back({"blackbox", "sync_s", "at most so much is lost with the power",
                 NumberField{&blackbox.sync_s, {0.1, 3600.0}}});
}

void add_live(LiveSettings& live, Fields& out) {
  out.push_back({"live", "keep_runs",
                 "older run directories of the interface's name go, without --out; 0: none",
                 IntegerField{&live.keep_runs, {0.0, 1e6}}});
}

void add_serve(ServeSettings& serve, Fields& out) {
  out.push_back({"serve", "address",
                 "HOST:PORT of page, metrics and events, 127.0.0.1:9464; empty: nothing is served",
                 TextField{&serve.address, {}}});
  out.push_back({"serve", "token_file",
                 "its first line is the token of readers; beyond this machine it is needed, or "
                 "client_ca_file",
                 TextField{&serve.token_file, {}}});
  out.push_back({"serve", "cert_file", "this server's certificate; empty: no TLS",
                 TextField{&serve.cert_file, {}}});
  out.push_back({"serve", "key_file", "and its key", TextField{&serve.key_file, {}}});
  out.push_back({"serve", "client_ca_file",
                 "certificates that each reader's is held against; empty: none is asked for",
                 TextField{&serve.client_ca_file, {}}});
}

void add_mqtt(MqttSettings& mqtt, Fields& out) {
  out.push_back({"mqtt", "broker",
                 "HOST:PORT of the broker that a live run tells, 127.0.0.1:1883; empty: none",
                 TextField{&mqtt.broker, {}}});
  out.push_back({"mqtt", "topic", "first part of the topics: TOPIC/VEHICLE/TRUCK/live",
                 TextField{&mqtt.topic, {}}});
  out.push_back({"mqtt", "user", "name for the broker; empty: none", TextField{&mqtt.user, {}}});
  out.push_back({"mqtt", "password_file", "its first line is the password",
                 TextField{&mqtt.password_file, {}}});
  out.push_back({"mqtt", "ca_file", "certificates that the broker's is held against; empty: no TLS",
                 TextField{&mqtt.ca_file, {}}});
  out.push_back({"mqtt", "cert_file", "this client's certificate", TextField{&mqtt.cert_file, {}}});
  out.push_back({"mqtt", "key_file", "and its key", TextField{&mqtt.key_file, {}}});
}

void add_spool(SpoolSettings& spool, Fields& out) {
  out.push_back({"spool", "folder",
                 "states of a live run's segments, for forward and collect; empty: none are kept",
                 TextField{&spool.folder, {}}});
  out.push_back({"spool", "segment_s", "length of a segment, from full hours of UTC",
                 NumberField{&spool.segment_s, {10.0, 86400.0}}});
  out.push_back({"spool", "every_s", "between two states of a segment, the later one in its place",
                 NumberField{&spool.every_s, {1.0, 86400.0}}});
  out.push_back({"spool", "kind", "full, or light: 5 KB without what its own deviations need",
                 TextField{&spool.kind, kStateKindWords}});
  out.push_back({"spool", "keep_mib",
                 "the oldest states go beyond this, those that were sent first",
                 IntegerField{&spool.keep_mib, {1.0, 1e9}}});
  out.push_back({"spool", "reserve_free_mib", "stays free on the disk; states that were sent go",
                 IntegerField{&spool.reserve_free_mib, {0.0, 1e9}}});
}

void add_alarm(AlarmSettings& alarm, Fields& out) {
  constexpr Limits kForce{1.0, 1e9};
  constexpr Limits kPercent{0.1, 1000.0};
  out.push_back({"alarm", "coulomb_below_n", "raised where the level is lower; absent: not watched",
                 OptionalNumberField{&alarm.coulomb_below_n, kForce, ""}});
  out.push_back({"alarm", "coulomb_above_n", "or higher; absent: not watched",
                 OptionalNumberField{&alarm.coulomb_above_n, kForce, ""}});
  out.push_back({"alarm", "reference", "run directory of a truck as it should be; empty: none",
                 TextField{&alarm.reference, {}}});
  out.push_back({"alarm", "below_percent", "raised where the level is so much below the reference",
                 OptionalNumberField{&alarm.below_percent, {0.1, 99.9}, ""}});
  out.push_back({"alarm", "above_percent", "or above it; absent: not watched",
                 OptionalNumberField{&alarm.above_percent, kPercent, ""}});
  out.push_back({"alarm", "drift", "yes: raised where a parameter is not what it was",
                 TextField{&alarm.drift, kYesNoWords}});
  out.push_back({"alarm", "faults", "raised by these faults of the data, or all; empty: by none",
                 TextListField{&alarm.faults, kFaultWords}});
  out.push_back({"alarm", "hysteresis_percent", "of a limit: so far inside before it is cleared",
                 NumberField{&alarm.hysteresis_percent, {0.0, 50.0}}});
  out.push_back({"alarm", "hold_s", "raised and cleared by what lasts so long",
                 NumberField{&alarm.hold_s, {0.0, 1e6}}});
  out.push_back({"alarm", "on_alarm", "program and its arguments, started at each change; no shell",
                 TextListField{&alarm.on_alarm, {}}});
}

void add_gpio(GpioConfig& gpio, Fields& out) {
  out.push_back(
      {"gpio", "chip", "gpiochip0, ...; empty: no lines are used", TextField{&gpio.chip, {}}});
  out.push_back({"gpio", "edges", "pulse:LINE, marker:LINE or wheel:LINE, with :active_low",
                 TextListField{&gpio.edges, {}}});
  out.push_back({"gpio", "lamp", "line of the status lamp, LINE or LINE:active_low; empty: none",
                 TextField{&gpio.lamp, {}}});
}

}  // namespace

std::vector<Field> fields(Config& config) {
  Fields out;
  add_record(config.record, out);
  add_car(config.car, out);
  add_input(config.input, out);
  add_model(config.model, out);
  add_estimate(config.estimate, out);
  add_guards(config.guards, out);
  add_blackbox(config.blackbox, out);
  add_live(config.live, out);
  add_serve(config.serve, out);
  add_mqtt(config.mqtt, out);
  add_spool(config.spool, out);
  add_alarm(config.alarm, out);
  add_gpio(config.gpio, out);
  return out;
}

}  // namespace dampline::app
