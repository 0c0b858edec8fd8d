// SPDX-License-Identifier: MIT
#include "app/verify/phase.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <utility>

#include "app/error.hpp"
#include "app/verify/phase/rows.hpp"

namespace dampline::app {
namespace {

constexpr int kRuns = 10;  // the benchmark takes a hundred

using Table = std::pair<std::string, std::function<std::vector<PhaseRow>()>>;

const std::vector<Table>& tables() {
  static const std::vector<Table> all{{"resonance", [] { return resonance_rows(); }},
                                      {"planarity", [] { return planarity_rows(3); }},
                                      {"linearity", [] { return linearity_rows(kRuns); }},
                                      {"friction", [] { return friction_rows(kRuns); }}};
  return all;
}

void check_names(const std::vector<std::string>& wanted) {
  for (const std::string& name : wanted) {
    const bool known = std::any_of(tables().begin(), tables().end(),
                                   [&](const Table& table) { return table.first == name; });
    if (!known)
      throw UsageError{fmt::format(
          "verify phase --table: found '{}', expected resonance, planarity, linearity or friction",
          name)};
  }
}

}  // namespace

int verify_phase(const VerifyOptions& options) {
  check_names(options.tables);
  std::vector<PhaseRow> rows;
  for (const auto& [name, make] : tables()) {
    const auto& wanted = options.tables;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    for (PhaseRow& row : make()) rows.push_back(std::move(row));
  }
  if (!options.quiet) {
    const std::string text = options.json       ? json_of(rows)
                             : options.markdown ? markdown_of(rows)
                                                : text_of(rows);
    fmt::print("{}", text);
  }
  return std::all_of(rows.begin(), rows.end(), [](const PhaseRow& row) { return row.met(); }) ? 0
                                                                                              : 1;
}

}  // namespace dampline::app
