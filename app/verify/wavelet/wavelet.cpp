// SPDX-License-Identifier: MIT
#include "app/verify/wavelet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <string>

#include "app/error.hpp"
#include "app/verify/wavelet/print.hpp"
#include "app/verify/wavelet/tasks.hpp"

namespace dampline::app {
namespace {

bool wanted(const std::vector<std::string>& tables, const std::vector<std::string>& asked) {
  return asked.empty() || std::any_of(tables.begin(), tables.end(), [&](const std::string& table) {
           return std::find(asked.begin(), asked.end(), table) != asked.end();
         });
}

void check_tables(const std::vector<std::string>& asked) {
  std::vector<std::string> known;
  const auto add = [&](const std::vector<std::string>& tables) {
    for (const std::string& table : tables) {
      if (std::find(known.begin(), known.end(), table) == known.end()) known.push_back(table);
    }
  };
  for (const CaseTask& task : case_tasks()) add(task.tables);
  for (const GroupTask& task : group_tasks()) add(task.tables);
  for (const std::string& table : asked) {
    if (std::find(known.begin(), known.end(), table) != known.end()) continue;
    throw UsageError{fmt::format("verify wavelet: --table: found '{}', expected one of: {}", table,
                                 table_names(known))};
  }
}

void print_now(const std::string& text) {
  fmt::print("{}", text);
  std::fflush(stdout);
}

/// All figures; with `as_text`, each is printed as soon as it is there.
WaveletFigures recompute_all(const std::vector<std::string>& asked, bool as_text) {
  WaveletFigures out;
  for (const CaseTask& task : case_tasks()) {
    if (!wanted(task.tables, asked)) continue;
    out.cases.push_back(task.run());
    if (as_text) print_now(text_of(out.cases.back()));
  }
  for (const GroupTask& task : group_tasks()) {
    if (!wanted(task.tables, asked)) continue;
    for (const CheckGroup& group : task.run()) {
      out.groups.push_back(group);
      if (as_text) print_now(text_of(group));
    }
  }
  return out;
}

constexpr const char* kIntroduction =
    "Cases of Ghanem and Romeo, A wavelet-based approach for model and parameter identification of "
    "non-linear systems,\nInternational Journal of Non-Linear Mechanics 36 (2001) 835-859. Errors "
    "are relative to the truth; COV is the standard\ndeviation over the windows' estimates, or by "
    "the residual of a recursive estimate, over the estimate. Table 2 holds inputs,\ntable 7 "
    "parameters: no figures of their own.\n";

}  // namespace

int verify_wavelet(const VerifyOptions& options) {
  check_tables(options.tables);
  const bool as_text = !options.json && !options.markdown && !options.quiet;
  if (as_text) print_now(kIntroduction);
  const WaveletFigures figures = recompute_all(options.tables, as_text);
  const Tally count = tally(figures);
  if (as_text) {
    fmt::print("\n{} of {} bounds met\n", count.met, count.bound);
    for (const std::string& line : missed(figures)) fmt::print("MISSED: table {}\n", line);
  }
  if (options.json && !options.quiet) fmt::print("{}", json_of(figures));
  if (options.markdown && !options.quiet) fmt::print("{}", markdown_of(figures));
  return count.met == count.bound ? 0 : 1;
}

}  // namespace dampline::app
