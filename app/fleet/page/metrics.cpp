// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "app/fleet/page/page.hpp"
#include "app/run/provenance.hpp"
#include "app/serve/exposition.hpp"

namespace dampline::app::fleet::page {

std::string fleet_metrics(const Fleet& fleet) {
  constexpr double kNsPerS = 1e9;
  constexpr double kHourS = 3600.0;
  Exposition text;
  const std::string version_text = version();
  const std::string commit_text = commit();
  text.begin("build_info", "gauge", "Always 1; which program this is.");
  text.value(1, {{"version", version_text}, {"commit", commit_text}});
  text.single("fleet_cars", "gauge", "Cars with a state.", fleet.cars);
  text.single("fleet_trucks", "gauge", "Trucks with a state.", fleet.trucks);
  text.single("fleet_segments", "gauge", "Segments with a state.", fleet.segments);
  text.single("fleet_motion_seconds", "gauge", "Length of all of them.", kHourS * fleet.hours);
  text.single("fleet_newest_contact_timestamp_seconds", "gauge",
              "End of the newest segment, since 1970.",
              static_cast<double>(fleet.last_ns) / kNsPerS);
  text.begin("fleet_alarms", "gauge", "Trucks in whose newest segment that alarm was raised.");
  for (const auto& [alarm, trucks] : fleet.alarms)
    text.value(static_cast<double>(trucks), {{"alarm", alarm}});
  text.single("fleet_trucks_silent", "gauge",
              "Trucks without contact in the week before the newest one.", fleet.silent.all);
  text.single("fleet_trucks_faulty", "gauge",
              "Trucks whose newest segment faults of the data spoil.", fleet.faulty.all);
  text.single("fleet_files_refused", "gauge", "Files that held no state.", fleet.refused);
  const auto labels_of = [](const Norm& n, const std::string& mass) {
    return Exposition::Labels{{"load", n.load.name},
                              {"moving_mass_kg", mass},
                              {"quantity", n.quantity},
                              {"unit", n.unit}};
  };
  const auto each = [&](const char* name, const char* help, const auto& value) {
    text.begin(name, "gauge", help);
    for (const Norm& n : fleet.norms)
      text.value(value(n), labels_of(n, fmt::format("{}", n.load.moving_mass_kg)));
  };
  each("fleet_median", "Median of the trucks of a load, in the unit of its label.",
       [](const Norm& n) { return n.median; });
  each("fleet_scatter", "Robust standard deviation of these trucks, in the same unit.",
       [](const Norm& n) { return n.scatter; });
  text.begin("fleet_outlier_deviations", "gauge",
             "Of each truck that lies outside of its fleet, in standard deviations.");
  for (const Outlier& o : fleet.outliers) {
    const std::string mass = fmt::format("{}", o.load.moving_mass_kg);
    text.value(o.deviations, {{"vehicle", o.vehicle},
                              {"truck", o.truck},
                              {"load", o.load.name},
                              {"moving_mass_kg", mass},
                              {"quantity", o.quantity}});
  }
  return text.take();
}

}  // namespace dampline::app::fleet::page
