// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/library.hpp"
#include "app/diagnosis/rig/trials.hpp"

namespace dampline::app::rig {

/// A figure of which a model's force is no linear function: a travel, a gap, a width, a lateness.
struct Place {
  enum class Of : std::uint8_t { kA, kB, kSkew, kFrequency, kDamping };
  Of of{Of::kA};
  std::vector<std::size_t> columns{};  ///< of the model, that share it; none where the records do
  double step{0.0};                    ///< for a difference
};

/// All figures of a model at once: its coefficients, its places, what changed over the record.
struct Joint {
  bool ok{false};
  std::size_t coefficients{0};
  std::vector<Place> places;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd half_difference;  ///< of the first halves of the records less the second
  Eigen::VectorXd changes;          ///< of the friction, as shares of it

  [[nodiscard]] Eigen::Index size() const { return covariance.rows(); }
  /// Where a place stands among all; -1: it is none.
  [[nodiscard]] Eigen::Index of_column(std::size_t column, Place::Of of) const;
  [[nodiscard]] Eigen::Index of_records(Place::Of of) const;
  [[nodiscard]] Eigen::Index of_change(std::size_t i) const {
    return static_cast<Eigen::Index>(coefficients + places.size() + i);
  }
};

/// A model's coefficients, then its places.
[[nodiscard]] Eigen::VectorXd unknowns_of(const Model& model, const Joint& joint);
/// The model with others.
[[nodiscard]] Model with_unknowns(Model model, const Joint& joint, const Eigen::VectorXd& unknowns);

/// Whether a change of the friction over a record scales the column.
[[nodiscard]] bool is_friction_like(const Regressor& column) noexcept;
/// On which side of the force a column of memory acts: 1, -1, or 0 for both.
[[nodiscard]] int side_of(const Regressor& column) noexcept;

/// Moves a model's places to where it leaves least, by Gauss and Newton, and fits everything once
/// more together: deviations from the scatter of the blocks, of the places as of the coefficients.
/// `records`: as the model sees them; a lateness that moves is moved in them. What changes is
/// written into the model's columns.
[[nodiscard]] Joint fit_jointly(Model& model, std::vector<Series>& records, double ridge,
                                const Scale& scale);

/// The friction's own change over the record that leaves least, and what it is worth; nothing where
/// none helps.
[[nodiscard]] std::optional<Trial> try_change(const Model& model,
                                              const std::vector<Series>& records, double ridge);

}  // namespace dampline::app::rig
