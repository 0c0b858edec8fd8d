// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>

#include "app/diagnosis/truck/explanation_json.hpp"
#include "app/diagnosis/truck/verdict.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {

namespace {

using effect::Explanation;

std::string quantity(const Estimate& estimate, const std::string& unit) {
  const QuantityText text = format_quantity(estimate.value, estimate.std);
  const std::string end = unit.empty() ? "" : " " + unit;
  return text.std.empty() ? text.value + end : text.value + " ± " + text.std + end;
}

const char* sentence(effect::Conclusion conclusion) {
  switch (conclusion) {
    case effect::Conclusion::kComplete:
      return "no effect of the library improves the model";
    case effect::Conclusion::kExplained:
      return "the model lacked what follows";
    case effect::Conclusion::kPartlyExplained:
      return "the model lacked what follows, and something more";
    case effect::Conclusion::kUnexplained:
      return "something is left that no effect of the library explains";
    case effect::Conclusion::kNotReady:
      break;
  }
  return "too little data";
}

std::string inseparable_text(const effect::EffectParameter& p) {
  return std::abs(p.correlation) > effect::kInseparable
             ? fmt::format(", not separable here from {} (correlation {:.3f})", p.twin,
                           p.correlation)
             : "";
}

std::string step_text(const effect::Step& step) {
  std::string text = fmt::format("+ {:<18} held-out error {:.4g} -> {:.4g} (nmse), t {:.1f}\n",
                                 effect::name_of(step.chosen.effect), step.restated_before,
                                 step.restated_after, step.block_t);
  for (std::size_t i = 0; i < step.parameter_count; ++i)
    text += fmt::format("    {:<32} {}{}\n", step.parameter[i].name,
                        quantity(step.parameter[i].estimate, step.parameter[i].unit),
                        inseparable_text(step.parameter[i]));
  for (std::size_t i = 0; i < step.runner_up_count; ++i)
    text += fmt::format("    {:<32} {} {:.4g}\n", i == 0 ? "next best" : "",
                        effect::name_of(step.runner_up[i].effect), step.runner_up[i].held_out_nmse);
  return text;
}

std::string fault_text(const Explained& explained) {
  const DataFaults& faults = explained.identified.faults;
  std::string text;
  for (const FaultFinding& f : faults.list)
    text += fmt::format("  fault              {}, {}, at {:.1f} s\n", f.name, f.channel, f.time_s);
  if (explained.withheld) text += "  the data have faults that look like effects: none is named\n";
  if (faults.drift && !explained.drifts)
    text += fmt::format("  time_drift         {}\n", describe_drift(*faults.drift));
  return text;
}

std::string drift_text(const Explained& explained) {
  return fmt::format("+ {:<18} held-out error {:.4g} -> {:.4g} (nmse)\n    {}\n", "time_drift",
                     explained.explanation.base.held_out_nmse, left_nmse(explained),
                     describe_drift(*explained.identified.faults.drift));
}

}  // namespace

std::string summarize(const Explained& explained) {
  const Explanation& e = explained.explanation;
  std::string text = fmt::format(
      "{}: {}\n", effect::name_of(conclusion_of(explained)),
      explained.drifts ? "a parameter changed while the record was made" : sentence(e.conclusion));
  text += fault_text(explained);
  text += fmt::format("  {:<18} held-out error {:.4g} (nmse), coulomb {}, stiffness {}\n", "base",
                      base_error(e), quantity(e.base_coulomb_n, "N"),
                      quantity(e.base_stiffness_npm, "N/m"));
  if (explained.drifts) text += drift_text(explained);
  for (std::size_t i = 0; i < e.step_count; ++i) text += step_text(e.step[i]);
  if (e.step_count > 0)
    text += fmt::format("  {:<18} held-out error {:.4g} (nmse), coulomb {}, stiffness {}\n",
                        "final", e.final.held_out_nmse, quantity(e.final_coulomb_n, "N"),
                        quantity(e.final_stiffness_npm, "N/m"));
  if (e.floor_nmse > 0.0)
    text += fmt::format(
        "  {:<18} {:.4g} (nmse) by sensors and rounding alone; left: {:.2f} times that\n", "floor",
        e.floor_nmse, left_over_floor(explained));
  if (e.step_count > 0 && floor_ratio(e) > effect::kIncompleteAbove)
    text += fmt::format("  {:<18} like {}, law incomplete\n", "",
                        effect::name_of(e.step[0].chosen.effect));
  if (explained.signature.rms_n > 0.0)
    text += fmt::format("  {:<18} {}\n", "what is left", describe(explained.signature));
  if (!(e.floor_nmse > 0.0))
    text +=
        "  what the sensors alone would leave is not known: whether more is left is not judged\n";
  for (const Validated& v : explained.validation)
    text += fmt::format("  {:<18} error {:.4g} -> {:.4g} (nmse)\n", v.record, v.nmse_before,
                        v.nmse_after);
  return text;
}

}  // namespace dampline::app
