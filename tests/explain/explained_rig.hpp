// SPDX-License-Identifier: MIT
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "app/diagnosis/rig/explain.hpp"
#include "app/record/columns.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::test {

/// Dry friction and viscous damping, nothing else declared.
inline app::Config two_terms() {
  app::Config out;
  out.model.base = {"coulomb", "viscous"};
  return out;
}

/// What `dampline explain` finds in a rig's CSV text.
inline app::rig::Explanation explained(const std::string& text,
                                       const app::Config& config = two_terms()) {
  const TemporaryFile file{text, ".csv"};
  const app::RecognisedColumns seen = app::recognise_columns(config, {file.path(), false});
  return app::rig::explain(seen.config, {{file.path()}, {}, "", false});
}

/// A parameter of the final model; a failure where it has none of this name.
inline app::Parameter parameter(const app::rig::Explanation& found, const std::string& name) {
  for (const app::Parameter& p : found.final.parameters)
    if (p.name == name) return p;
  ADD_FAILURE() << "no " << name << '\n' << app::rig::summarize(found);
  return {};
}
inline double value_of(const app::rig::Explanation& found, const std::string& name) {
  return parameter(found, name).value;
}
/// So many of its own deviations from the truth, at most.
inline void expect_size(const app::rig::Explanation& found, const std::string& name, double truth,
                        double deviations) {
  const app::Parameter p = parameter(found, name);
  EXPECT_NEAR(p.value, truth, deviations * p.std) << name << '\n' << app::rig::summarize(found);
}

}  // namespace dampline::test
