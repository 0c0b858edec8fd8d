// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

#include "app/run/result.hpp"

namespace dampline::app {

/// What a parameter is, in a few plain words; empty for a name that is not known.
[[nodiscard]] std::string meaning_of_parameter(std::string_view name);

/// What a counter counts, in a few plain words; the name itself when it is not known.
[[nodiscard]] std::string meaning_of_count(std::string_view name);

/// A result as a short table for a terminal: parameters with deviation and unit, the fit, what was
/// left out.
[[nodiscard]] std::string summarize(const RunResult& result);

/// Of a run with row_method: "D8 at level 2 (step 4 ms), least squares over 1 234 rows".
[[nodiscard]] std::string describe_rows(const RunResult& result);

/// "12.5 m/s^2"; empty for a fault that has none.
[[nodiscard]] std::string fault_size(const FaultFinding& fault);
/// "+12.1 ± 0.9 % at 150 s" and the like.
[[nodiscard]] std::string describe_drift(const DriftFinding& drift);
/// The same as a sentence, which begins with kNotConstant.
inline constexpr std::string_view kNotConstant = "A parameter is not constant";
[[nodiscard]] std::string drift_text(const DriftFinding& drift);
/// That, and over what ("record", "segments") the values stated are means.
[[nodiscard]] std::string drift_warning(const DriftFinding& drift, std::string_view over);
/// "coulomb changed by -12.1 % since 4210 s, told at 4450 s".
[[nodiscard]] std::string describe_alarm(const AlarmFinding& alarm);
/// How late the live alarm is and how often it is wrong, in a sentence.
[[nodiscard]] std::string describe_alarm_figures();

}  // namespace dampline::app
