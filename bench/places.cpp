// SPDX-License-Identifier: MIT
// Sensors that sit elsewhere: what `explain` says of trucks, by a simulation of its own, whose
// sensors see pitch, roll, hunting or their own mounts.
// `places [RECORDS_PER_ROW_AND_TRUCK [FIRST_SEED [ROW]]]`; a record of 300 s takes four seconds.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tests/app/plain_truck.hpp"

namespace {

using namespace dampline;
using dampline::test::PlainSensors;
using dampline::test::PlainTruck;

constexpr double kLengthS = 300.0;

struct Placed {
  const char* name{""};
  const char* fault{""};  ///< that it should be; empty: none
  PlainSensors sensors;
};
constexpr std::array kPlaces{
    Placed{"where they should be", "", {}},
    Placed{"frame's 0.03 m off the middle", "off_centre", {.off_centre_m = 0.03}},
    Placed{"frame's 0.05 m off", "off_centre", {.off_centre_m = 0.05}},
    Placed{"frame's 0.1 m off", "off_centre", {.off_centre_m = 0.1}},
    Placed{"frame's 0.3 m off", "off_centre", {.off_centre_m = 0.3}},
    Placed{"wheelsets see 10 % of roll", "foreign_motion", {.roll = 0.1}},
    Placed{"wheelsets see 20 % of roll", "foreign_motion", {.roll = 0.2}},
    Placed{"wheelsets see 30 % of roll", "foreign_motion", {.roll = 0.3}},
    Placed{"wheelsets and frame see 10 % of roll",
           "foreign_motion",
           {.roll = 0.1, .frame_rolls = true}},
    Placed{"wheelsets and frame see 30 % of roll",
           "foreign_motion",
           {.roll = 0.3, .frame_rolls = true}},
    Placed{"hunting, 0.05 m/s^2 in the frame's", "foreign_motion", {.hunting_mps2 = 0.05}},
    Placed{"hunting, 0.3 m/s^2", "foreign_motion", {.hunting_mps2 = 0.3}},
    Placed{"frame's mount rings at 40 Hz", "ringing_mount", {.frame_mount_hz = 40.0}},
    Placed{"frame's mount rings at 70 Hz", "ringing_mount", {.frame_mount_hz = 70.0}},
    Placed{"frame's mount rings at 110 Hz", "ringing_mount", {.frame_mount_hz = 110.0}},
    Placed{"wheelset 1's mount rings at 70 Hz", "ringing_mount", {.wheelset_mount_hz = 70.0}},
};

struct Tally {
  int records{0}, named{0}, other_faults{0}, effects{0}, trusted{0}, incomplete{0};
  double worst_trusted{0.0};  ///< error of a level that is trusted, of the truth
  void add(const Placed& place, const PlainTruck& truck, const test::PlainExplained& found) {
    const std::string fault = place.fault;
    const auto& list = found.result.faults.list;
    ++records;
    named += static_cast<int>(!fault.empty() && found.has_fault(fault));
    other_faults += static_cast<int>(
        std::any_of(list.begin(), list.end(), [&](const auto& f) { return f.name != fault; }));
    effects += static_cast<int>(found.names_effect());
    incomplete += static_cast<int>(found.result.trust == app::Trust::kModelIncomplete);
    if (found.result.trust != app::Trust::kTrusted) return;
    ++trusted;
    const app::Parameter* const level = find_parameter(found.result.parameters, "coulomb");
    if (level != nullptr)
      worst_trusted = std::max(worst_trusted, std::abs(level->value / truck.coulomb_n - 1.0));
  }
};

void print_row(const Placed& place, int records, std::uint64_t seed) {
  Tally tally;
  for (const PlainTruck& truck : test::kPlainTrucks)
    for (int i = 0; i < records; ++i)
      tally.add(place, truck,
                test::explained_from(truck, place.sensors, kLengthS,
                                     seed + static_cast<std::uint64_t>(i)));
  fmt::print("| {} | {} | {} of {} | {} | {} | {} | {} | {} |\n", place.name,
             *place.fault == '\0' ? "none" : place.fault, tally.named, tally.records,
             tally.other_faults, tally.effects, tally.incomplete, tally.trusted,
             tally.trusted > 0 ? fmt::format("{:.2f}", 100.0 * tally.worst_trusted) : "");
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 5;
  const std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 8001;
  const std::string only = argc > 3 ? argv[3] : "";
  fmt::print(
      "| sensors | fault | named | another fault | an effect | model_incomplete | trusted "
      "| worst trusted Fc, % |\n|---|---|---|---|---|---|---|---|\n");
  for (const Placed& place : kPlaces)
    if (only.empty() || place.name == only) print_row(place, records, seed);
  return 0;
}
