// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/run/provenance.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// The parts of the page that are text and tables, as HTML.
[[nodiscard]] std::string warning_section(const RunResult& result);
[[nodiscard]] std::string parameter_section(const RunResult& result);
/// The law that identify states, where an explanation added to it; else empty.
[[nodiscard]] std::string base_section(const RunResult& result);
/// The law of an explanation as an equation with its numbers; else empty. Throws RunError where
/// law.json is none.
[[nodiscard]] std::string law_section(const RunResult& result);
[[nodiscard]] std::string quality_section(const RunResult& result);
[[nodiscard]] std::string excluded_section(const RunResult& result);
/// The methods beside the wavelet windows; those that the record contradicts are grey, with the
/// reasons. Empty where there are none.
[[nodiscard]] std::string method_section(const RunResult& result);
/// The planes of the phase space as density pictures, with the sections. Empty without them.
[[nodiscard]] std::string phase_section(const RunResult& result);
/// Of a live run; empty for a record.
[[nodiscard]] std::string live_section(const RunResult& result);
[[nodiscard]] std::string provenance_section(const Provenance& provenance,
                                             const std::string& run_toml);
/// Faults with channel, time and size, inputs that are no faults, and a parameter that changed.
/// Empty for a rig's record.
[[nodiscard]] std::string fault_section(const RunResult& result);

// Of a run with row_method; else empty.

/// Term, estimate, deviation, t and coefficient of variation of each term, and the errors.
[[nodiscard]] std::string term_section(const RunResult& result);
/// Sets of terms with one less and one more.
[[nodiscard]] std::string term_set_section(const RunResult& result);

// Of an explanation.

/// An effect that the model lacked, with its size.
struct LackingEffect {
  std::string name;
  std::vector<Parameter> parameters;
};
/// What explanation.json says that a reader must know first.
struct Finding {
  std::string verdict;  ///< empty: there is no explanation
  std::vector<LackingEffect> effects;
  std::string signature;  ///< a sentence on what is left; may be empty
};
[[nodiscard]] Finding finding_of(const Evidence& evidence);

/// The verdict and the error before and after in plain sentences.
[[nodiscard]] std::string explanation_headline(const Evidence& evidence);
/// Verdict, errors and what is left.
[[nodiscard]] std::string verdict_section(const Evidence& evidence);
/// Every candidate that was near: gain, significance, verdict.
[[nodiscard]] std::string candidate_section(const Evidence& evidence);
/// Errors on records that were never fitted.
[[nodiscard]] std::string validation_section(const Evidence& evidence);

}  // namespace dampline::app
