// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "app/report/html.hpp"
#include "app/report/sections.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
namespace {

std::string mebibytes(std::uint64_t bytes) {
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
}

}  // namespace

std::string live_section(const RunResult& result) {
  if (!result.live) return "";
  const LiveFigures& f = *result.live;
  const std::string lateness =
      fmt::format("{} / {} / {} / {} / {}", format_microseconds(f.lateness_p50_us),
                  format_microseconds(f.lateness_p90_us), format_microseconds(f.lateness_p99_us),
                  format_microseconds(f.lateness_p999_us), format_microseconds(f.lateness_max_us));
  std::vector<std::vector<std::string>> rows{
      {"lateness", lateness,
       "from a frame's stamp to its result: p50 / p90 / p99 / p99.9 / largest"},
      {"cycle slips", format_count(f.cycle_slips),
       "frames later than one sampling period; no result depends on it"},
      {"page faults", fmt::format("{} + {}", f.minor_faults, f.major_faults),
       "minor + major, of the acquisition after its warm-up"},
      {"memory locked", f.memory_locked ? "yes" : "no", ""},
      {"real-time scheduling", f.realtime_scheduled ? "yes" : "no", ""},
      {"recorded", mebibytes(f.recorded_bytes), "in the black box"},
      {"records lost", format_count(f.records_lost), "that the black box could not take"}};
  if (f.first_sample_s)
    rows.push_back({"first sample", fmt::format("{:.3f} s", *f.first_sample_s),
                    "after the start of the program"});
  return html_table({"", "", "meaning"}, rows, 1);
}

}  // namespace dampline::app
