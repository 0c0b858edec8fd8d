// SPDX-License-Identifier: MIT
// Writes pages of results with everything in them into FOLDER, for browser_test.py.
#include <filesystem>
#include <fstream>
#include <string>

#include "app/report/page.hpp"
#include "tests/app/fake_result.hpp"

namespace {

using namespace dampline::app;

constexpr const char* kRun = "[car]\nmoving_mass_kg = 37200.0\n[input]\nspeed_mps = 22.2\n";
constexpr const char* kHostile =
    "\"><script>window.pwned = 1</script><img src=x onerror=\"window.pwned = 1\">]]></svg><!--";

void write(const std::filesystem::path& file, const RunResult& result, const std::string& name) {
  std::ofstream{file} << make_page(result, {"0.1.0", {{name, "record", 12, std::string(64, 'f')}}},
                                   kRun);
}

RunResult faulty() {
  RunResult out = fake_result();
  make_live(out);
  out.trust = Trust::kDataFaulty;
  out.headline = "The data are faulty, so no number is stated here. The data have faults: spikes.";
  out.trust_reasons = {"The data have faults: spikes (wheelset1), lost_samples (all)."};
  out.warnings = {"The kernel dropped 12 frames: the receive buffer was full."};
  out.faults.list = {{"spikes", "wheelset1", 12.0, 61.0, 31.5, "m/s^2", 4, {{12.0, 13.0}}},
                     {"lost_samples", "all", 40.0, 200.0, 31.0, "samples", 2, {{40.0, 42.0}}}};
  out.faults.drift = DriftFinding{"coulomb", true, 150.0, 16.0, 0.2, {12.0, 1.5}};
  out.events = {{-0.5, "marker_on", 0, 1}, {100.0, "link_down", 0, 0}, {103.0, "link_up", 0, 0}};
  return out;
}

RunResult hostile() {
  RunResult out = faulty();
  out.headline = kHostile;
  out.trust_reasons = {kHostile};
  out.events = {{1.0, kHostile, 0, 0}};
  out.excluded = {{1.0, 2.0, kHostile}};
  out.faults.list.front().name = kHostile;
  out.convergence.names.front() = kHostile;
  out.parameters.front().name = kHostile;
  out.methods.front().title = kHostile;
  out.notes = {std::string(300, 'n')};
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder{argv[1]};
  write(folder / "truck.html", fake_result(), "laden.log");
  write(folder / "live.html", faulty(), "can0");
  write(folder / "hostile.html", hostile(), kHostile);
  return 0;
}
