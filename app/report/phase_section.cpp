// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "app/report/html.hpp"
#include "app/report/plot_phase.hpp"
#include "app/report/sections.hpp"

namespace dampline::app {
namespace {

constexpr std::string_view kPhaseText =
    "How often the motion passed each place of the extended phase space (y, y', y''), seen along "
    "its three axes; the shade follows the root of the density. Points are stroboscopic (Poincare) "
    "sections.";

}  // namespace

std::string phase_section(const RunResult& result) {
  if (!result.phase) return "";
  return fmt::format("<figure>\n{}\n<figcaption>{} {}</figcaption></figure>\n",
                     plot_phase(*result.phase, "phase-planes"), kPhaseText,
                     escape_html(describe_period(*result.phase)));
}

}  // namespace dampline::app
