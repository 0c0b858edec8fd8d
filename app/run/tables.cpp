// SPDX-License-Identifier: MIT
#include "app/run/tables.hpp"

#include <fmt/format.h>

#include "app/error.hpp"
#include "app/run/csv_text.hpp"

namespace dampline::app {

std::string to_csv(const std::vector<CurveRow>& curve, const std::vector<MethodSummary>& methods) {
  std::string out = "velocity_mps,force_n,std_n,samples";
  for (const MethodSummary& m : methods) out += fmt::format(",{0}_n,{0}_std_n", m.name);
  out += '\n';
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const CurveRow& r = curve[i];
    out += fmt::format("{:.9g},{:.9g},{:.6g},{}", r.velocity_mps, r.force_n, r.std_n, r.samples);
    for (const MethodSummary& m : methods)
      out += fmt::format(",{:.9g},{:.6g}", m.curve_n.at(i).value, m.curve_n.at(i).std);
    out += '\n';
  }
  return out;
}

std::string to_csv(const std::vector<DensityTable>& densities) {
  std::string out = "quantity,centre,density,samples,outside_share\n";
  for (const DensityTable& table : densities)
    for (const DensityRow& r : table.rows)
      out += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.6g}\n", table.quantity, r.centre, r.density,
                         r.samples, table.outside_share);
  return out;
}

std::string to_csv(const Convergence& convergence) {
  std::string out = "time_s";
  for (std::size_t i = 0; i < convergence.names.size(); ++i)
    out += fmt::format(",{0} [{1}],{0}_std [{1}]", convergence.names[i], convergence.units[i]);
  out += '\n';
  for (const Convergence::Row& row : convergence.rows) {
    out += fmt::format("{:.9g}", row.time_s);
    for (const Estimate& e : row.estimates) out += fmt::format(",{:.9g},{:.6g}", e.value, e.std);
    out += '\n';
  }
  return out;
}

std::string to_csv(const std::vector<MotionRow>& motion) {
  std::string out = "time_s,deflection_m,velocity_mps\n";
  for (const MotionRow& r : motion)
    out += fmt::format("{:.9g},{:.6g},{:.6g}\n", r.time_s, r.deflection_m, r.velocity_mps);
  return out;
}

std::string to_csv(const std::vector<ForceRow>& force) {
  std::string out = "time_s,velocity_mps,measured_n,fitted_n\n";
  for (const ForceRow& r : force)
    out += fmt::format("{:.9g},{:.6g},{:.6g},{:.6g}\n", r.time_s, r.velocity_mps, r.measured_n,
                       r.fitted_n);
  return out;
}

std::string to_csv(const std::vector<Excluded>& excluded) {
  std::string out = "start_s,end_s,reason\n";
  for (const Excluded& r : excluded)
    out += fmt::format("{:.9g},{:.9g},{}\n", r.start_s, r.end_s, r.reason);
  return out;
}

std::string to_csv(const std::vector<RunEvent>& events) {
  std::string out = "time_s,event,line,value\n";
  for (const RunEvent& r : events)
    out += fmt::format("{:.6f},{},{},{}\n", r.time_s, r.name, r.line, r.value);
  return out;
}

std::string to_csv(const std::vector<LatenessRow>& lateness) {
  std::string out = "from_us,to_us,frames\n";
  for (const LatenessRow& r : lateness)
    out += fmt::format("{:.9g},{:.9g},{}\n", r.from_us, r.to_us, r.frames);
  return out;
}

void read_curve(std::string_view text, const std::string& origin, RunResult& result) {
  read_rows(text, origin, [&](const Cells& c) {
    result.curve.push_back({number(c.at(0)), number(c.at(1)), number(c.at(2)),
                            static_cast<std::uint64_t>(number(c.at(3)))});
    const std::size_t expected = 4 + 2 * result.methods.size();
    if (c.size() < expected)
      throw RunError{
          fmt::format("{} columns, expected {}: a force and its deviation for each "
                      "method of parameters.json",
                      c.size(), expected)};
    for (std::size_t i = 0; i < result.methods.size(); ++i)
      result.methods[i].curve_n.push_back({number(c.at(4 + 2 * i)), number(c.at(5 + 2 * i))});
  });
}

std::vector<DensityTable> read_densities(std::string_view text, const std::string& origin) {
  std::vector<DensityTable> densities;
  read_rows(text, origin, [&](const Cells& c) {
    if (densities.empty() || densities.back().quantity != c.at(0))
      densities.push_back({std::string{c.at(0)}, number(c.at(4)), {}});
    densities.back().rows.push_back({number(c.at(1)), number(c.at(2)), number(c.at(3))});
  });
  return densities;
}

Convergence read_convergence(std::string_view text, const std::string& origin) {
  Convergence convergence;
  const auto header = read_rows(text, origin, [&](const Cells& c) {
    Convergence::Row row{number(c.at(0)), {}};
    for (std::size_t i = 1; i + 1 < c.size(); i += 2)
      row.estimates.push_back({number(c[i]), number(c[i + 1])});
    convergence.rows.push_back(std::move(row));
  });
  for (std::size_t i = 1; i + 1 < header.size(); i += 2) {
    const std::string& name = header[i];
    const std::size_t bracket = name.find(" [");
    convergence.names.push_back(name.substr(0, bracket));
    convergence.units.push_back(
        bracket == std::string::npos ? "" : name.substr(bracket + 2, name.size() - bracket - 3));
  }
  return convergence;
}

std::vector<MotionRow> read_motion(std::string_view text, const std::string& origin) {
  std::vector<MotionRow> motion;
  read_rows(text, origin, [&](const Cells& c) {
    motion.push_back({number(c.at(0)), number(c.at(1)), number(c.at(2))});
  });
  return motion;
}

std::vector<ForceRow> read_force(std::string_view text, const std::string& origin) {
  std::vector<ForceRow> force;
  read_rows(text, origin, [&](const Cells& c) {
    force.push_back({number(c.at(0)), number(c.at(1)), number(c.at(2)), number(c.at(3))});
  });
  return force;
}

std::vector<Excluded> read_excluded(std::string_view text, const std::string& origin) {
  std::vector<Excluded> excluded;
  read_rows(text, origin, [&](const Cells& c) {
    excluded.push_back({number(c.at(0)), number(c.at(1)), std::string{c.at(2)}});
  });
  return excluded;
}

std::vector<RunEvent> read_events(std::string_view text, const std::string& origin) {
  std::vector<RunEvent> events;
  read_rows(text, origin, [&](const Cells& c) {
    events.push_back({number(c.at(0)), std::string{c.at(1)},
                      static_cast<std::uint64_t>(number(c.at(2))),
                      static_cast<std::int64_t>(number(c.at(3)))});
  });
  return events;
}

std::vector<LatenessRow> read_lateness(std::string_view text, const std::string& origin) {
  std::vector<LatenessRow> lateness;
  read_rows(text, origin, [&](const Cells& c) {
    lateness.push_back(
        {number(c.at(0)), number(c.at(1)), static_cast<std::uint64_t>(number(c.at(2)))});
  });
  return lateness;
}

}  // namespace dampline::app
