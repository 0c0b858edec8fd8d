// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "app/error.hpp"
#include "app/verify/subjects.hpp"
#include "app/verify/wavelet/figures.hpp"
#include "app/verify/wavelet/print.hpp"
#include "app/verify/wavelet/properties.hpp"
#include "app/verify/wavelet/results.hpp"

namespace dampline::app {
namespace {

/// A case to recompute, known by the tables that it appears in.
struct CaseTask {
  std::vector<std::string> tables;
  std::function<CaseFigures()> run;
};

struct GroupTask {
  std::vector<std::string> tables;
  std::function<std::vector<CheckGroup>()> run;
};

/// Tables 1, 3 to 6 and 8 to 16; "signs" and "noise" beside them.
const std::vector<CaseTask>& case_tasks() {
  static const std::vector<CaseTask> all{
      {{"1"}, product_result},
      {{"1"}, product_by_omega_result},
      {{"3"}, [] { return duffing_result(Drive::kEquations); }},
      {{"3"}, [] { return duffing_result(Drive::kHalfSlope); }},
      {{"3", "4"}, [] { return van_der_pol_result(Drive::kEquations); }},
      {{"3", "4"}, [] { return van_der_pol_result(Drive::kHalfSlope); }},
      {{"5"}, [] { return duffing_result(Drive::kFree); }},
      {{"5", "6"}, [] { return van_der_pol_result(Drive::kFree); }},
      {{"8"}, [] { return duffing_chain_result(true); }},
      {{"9"}, [] { return van_der_pol_chain_result(true); }},
      {{"10"}, [] { return duffing_chain_result(false); }},
      {{"11"}, [] { return van_der_pol_chain_result(false); }},
      {{"12"}, coulomb_free_result},
      {{"12"}, coulomb_decrement_result},
      {{"13"}, coulomb_forced_result},
      {{"13"}, coulomb_tanh_result},
      {{"14"}, coulomb_chain_result},
      {{"15"}, [] { return linear_coulomb_result(1.2, 5); }},
      {{"15"}, [] { return linear_coulomb_result(1.2, 10); }},
      {{"15"}, [] { return linear_coulomb_result(0.6, 5); }},
      {{"15"}, [] { return linear_coulomb_result(0.6, 10); }},
      {{"15"}, [] { return linear_coulomb_tanh_result(5); }},
      {{"15"}, [] { return linear_coulomb_tanh_result(10); }},
      {{"16"}, teflon_result},
      {{"signs"}, coulomb_erf_result},
      {{"signs"}, coulomb_arctangent_result},
      {{"signs"}, coulomb_rational_result},
      {{"noise"}, quantised_duffing_result},
  };
  return all;
}

constexpr int kSeeds = 20;

/// Tables 17 and 18; "step", "precision" and "accelerometers" beside them.
const std::vector<GroupTask>& group_tasks() {
  static const std::vector<GroupTask> all{
      {{"3", "4"}, sweep_readings},
      {{"17"}, single_responses},
      {{"17"}, single_selection},
      {{"18"}, chain_responses},
      {{"18"}, chain_selection},
      {{"step"}, stiffness_drop},
      {{"precision"}, recursive_against_batch},
      {{"accelerometers"}, [] { return accelerometers_alone(kSeeds); }}};
  return all;
}

bool wanted(const VerifyOptions& options, const std::vector<std::string>& tables) {
  return std::any_of(tables.begin(), tables.end(),
                     [&](const std::string& table) { return options.wants(table); });
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
WaveletFigures recompute_all(const VerifyOptions& options, bool as_text) {
  WaveletFigures out;
  for (const CaseTask& task : case_tasks()) {
    if (!wanted(options, task.tables)) continue;
    out.cases.push_back(task.run());
    if (as_text) print_now(text_of(out.cases.back()));
  }
  for (const GroupTask& task : group_tasks()) {
    if (!wanted(options, task.tables)) continue;
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
  const WaveletFigures figures = recompute_all(options, as_text);
  const Tally count = tally(figures);
  if (as_text) {
    fmt::print("\n{} of {} bounds met\n", count.met, count.bound);
    for (const std::string& line : missed(figures)) fmt::print("MISSED: table {}\n", line);
  }
  if (options.json) put(options, json_of(figures));
  if (options.markdown) put(options, markdown_of(figures));
  return count.met == count.bound ? 0 : 1;
}

}  // namespace dampline::app
