// SPDX-License-Identifier: MIT
#include "app/run/evidence_tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "app/run/csv_text.hpp"

namespace dampline::app {

std::string to_csv(const std::vector<ResidualRow>& residual) {
  std::string out = "over,place,samples,before_mean_n,before_rms_n,after_mean_n,after_rms_n\n";
  for (const ResidualRow& r : residual)
    fmt::format_to(std::back_inserter(out), "{},{:.9g},{},{:.6g},{:.6g},{:.6g},{:.6g}\n", r.over,
                   r.place, r.samples, r.before_mean_n, r.before_rms_n, r.after_mean_n,
                   r.after_rms_n);
  return out;
}

std::string to_csv(const std::vector<LoopRow>& loops) {
  std::string out = "time_s,deflection_m,velocity_mps,measured_n,base_n,final_n\n";
  for (const LoopRow& r : loops)
    fmt::format_to(std::back_inserter(out), "{:.6f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", r.time_s,
                   r.deflection_m, r.velocity_mps, r.measured_n, r.base_n, r.final_n);
  return out;
}

std::string to_csv(const std::vector<LawRow>& law) {
  std::string out = "velocity_mps,base_n,final_n\n";
  for (const LawRow& r : law)
    fmt::format_to(std::back_inserter(out), "{:.6g},{:.6g},{:.6g}\n", r.velocity_mps, r.base_n,
                   r.final_n);
  return out;
}

std::string to_csv(const std::vector<PredictedRow>& prediction) {
  std::string out =
      "record,time_s,measured_n,predicted_n,residual_n,base_predicted_n,reference_n\n";
  for (const PredictedRow& r : prediction) {
    fmt::format_to(std::back_inserter(out), "{},{:.6f},{:.6g},{:.6g},{:.6g},{:.6g},", r.record,
                   r.time_s, r.measured_n, r.predicted_n, r.measured_n - r.predicted_n, r.base_n);
    if (std::isfinite(r.reference_n))
      fmt::format_to(std::back_inserter(out), "{:.6g}", r.reference_n);
    out += '\n';
  }
  return out;
}

std::vector<ResidualRow> read_residual(std::string_view text, const std::string& origin) {
  std::vector<ResidualRow> out;
  read_rows(text, origin, [&](const Cells& c) {
    out.push_back({std::string{c.at(0)}, number(c.at(1)),
                   static_cast<std::uint64_t>(number(c.at(2))), number(c.at(3)), number(c.at(4)),
                   number(c.at(5)), number(c.at(6))});
  });
  return out;
}

std::vector<LoopRow> read_loops(std::string_view text, const std::string& origin) {
  std::vector<LoopRow> out;
  read_rows(text, origin, [&](const Cells& c) {
    out.push_back({number(c.at(0)), number(c.at(1)), number(c.at(2)), number(c.at(3)),
                   number(c.at(4)), number(c.at(5))});
  });
  return out;
}

std::vector<LawRow> read_law(std::string_view text, const std::string& origin) {
  std::vector<LawRow> out;
  read_rows(text, origin, [&](const Cells& c) {
    out.push_back({number(c.at(0)), number(c.at(1)), number(c.at(2))});
  });
  return out;
}

std::vector<PredictedRow> read_prediction(std::string_view text, const std::string& origin) {
  std::vector<PredictedRow> out;
  read_rows(text, origin, [&](const Cells& c) {
    PredictedRow row;
    row.record = static_cast<std::uint32_t>(number(c.at(0)));
    row.time_s = number(c.at(1));
    row.measured_n = number(c.at(2));
    row.predicted_n = number(c.at(3));
    row.base_n = number(c.at(5));
    if (!c.at(6).empty()) row.reference_n = number(c.at(6));
    out.push_back(row);
  });
  return out;
}

}  // namespace dampline::app
