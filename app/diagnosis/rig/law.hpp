// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/joint.hpp"
#include "app/law/document.hpp"

namespace dampline::app::rig {

[[nodiscard]] constexpr bool is_inertia(Kind kind) noexcept {
  return kind == Kind::kInertia || kind == Kind::kAcceleration;
}
/// Friction whose way over which it builds up is shorter than can be seen.
[[nodiscard]] bool is_sharp(const Regressor& column, const Scale& scale);

/// A model of a driven mass as a law that can be moved; nothing where it has no mass, or parts that
/// a free run does not have: changes over time, lateness, modes, a bank of elements.
[[nodiscard]] std::optional<law::Law> law_of(const Model& model, const Scale& scale);

/// A model as law.json has it, with the covariance of all its numbers; what it leaves is not yet in
/// it. `joint`: where the model's numbers were last refined.
[[nodiscard]] law::Document document_of(const Model& model, const Joint& joint, const Scale& scale);

/// Puts into the model's document what it leaves of the first record, and that record's own.
void measure_left(const Model& model, const Series& series, law::Document& document);

/// What the fit has as columns, of a law: its mass, if any, first.
[[nodiscard]] std::vector<Regressor> columns_of(const law::Document& document);
/// Their coefficients.
[[nodiscard]] Eigen::VectorXd theta_of(const law::Law& law);

}  // namespace dampline::app::rig
