// SPDX-License-Identifier: MIT
#include "sim_hw/writers.hpp"

#include <iterator>

namespace dampline::sim {
void append_csv(TextBuffer& text, const SimulatedSample& sample, bool extras) {
  const auto& a = sample.accel_mps2;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{:.9f},{:.6f},{:.6f},{:.6f}", sample.time_s, a[0], a[1], a[2]);
  if (extras) fmt::format_to(out, ",{:.6f},{:.6f}", sample.extra_mps2[0], sample.extra_mps2[1]);
  text.push_back('\n');
}

std::string truth_header(const SimulationConfig& config) {
  const TruckConfig& t = config.truck;
  const TrackConfig& track = config.track;
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "# seed = {}\n# moving_mass_kg = {}\n# stiffness_npm = {}\n", config.seed,
                 t.moving_mass_kg, t.stiffness_npm);
  fmt::format_to(out, "# friction_positive_n = {}\n# friction_negative_n = {}\n",
                 t.friction_scale * t.friction_positive_n,
                 t.friction_scale * t.friction_negative_n);
  fmt::format_to(out, "# speed_kmh = {}\n# track_amplitude_m_rad = {}\n# short_wave_mps2 = {}\n",
                 3.6 * config.speed.speed_mps, track.amplitude_m_rad, track.short_wave_mps2);
  fmt::format_to(out, "# noise_mps2 = {}\n# anti_alias_delay_s = {}\n", config.sensors.noise_mps2,
                 anti_alias_delay_s(config.sensors));
  if (config.vehicle) {
    const VehicleConfig& v = *config.vehicle;
    fmt::format_to(out,
                   "# vehicle = {}\n# frame_mass_kg = {}\n# gyration_radius_m = {}\n"
                   "# half_pivot_distance_m = {}\n# frame_pitch_inertia_kgm2 = {}\n",
                   v.instrumented == TruckPosition::kLeading ? "leading" : "trailing",
                   v.frame_mass_kg, v.gyration_radius_m, v.half_pivot_distance_m,
                   t.modes.pitch_inertia_kgm2);
  }
  fmt::format_to(out,
                 "# Columns without the suffix _instant went through the sensors' anti-alias "
                 "filter and have its delay.\n");
  for (const std::string_view suffix : {"", "_instant"}) {
    fmt::format_to(out, "{}deflection_m{},velocity_mps{},damping_force_n{},restoring_force_n{}",
                   suffix.empty() ? "time_s," : ",", suffix, suffix, suffix, suffix);
    fmt::format_to(out, ",frame_accel_mps2{}", suffix);
  }
  text += ",speed_mps,position_m\n";
  return text;
}

void append_truth(TextBuffer& text, const SimulatedSample& sample) {
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{:.9f}", sample.time_s);
  for (const Truth* truth : {&sample.truth, &sample.instant}) {
    fmt::format_to(out, ",{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", truth->deflection_m,
                   truth->velocity_mps, truth->damping_force_n, truth->restoring_force_n,
                   truth->frame_mps2);
  }
  fmt::format_to(out, ",{:.6f},{:.4f}\n", sample.speed_mps, sample.position_m);
}

}  // namespace dampline::sim
