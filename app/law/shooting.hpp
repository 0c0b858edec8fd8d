// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "app/law/free_run.hpp"
#include "app/law/left_over.hpp"

namespace dampline::app::law {

/// A record of a mass that a force drives: what moved it, and where it was seen.
struct Drive {
  Input input;
  Eigen::VectorXd deflection_m;
  Eigen::VectorXd velocity_mps;  ///< where the states of the segments begin
  Eigen::VectorXd counts;        ///< 0: the sample takes no part in the error; empty: all do
};

/// Unknowns of a law by their places in a vector.
using LawOf = std::function<Law(const Eigen::VectorXd&)>;

/// What a law leaves of the deflection when the force alone moves it, from segment to segment.
struct Shot {
  bool ok{false};
  Eigen::VectorXd unknowns;
  Eigen::MatrixXd
      covariance;    ///< from the scatter of blocks in time, no less than white noise makes
  double nmse{0.0};  ///< of the deflection
  double held_out_nmse{0.0};             ///< each of five parts by the unknowns without it
  double residual_m{0.0};                ///< rms
  std::optional<LeftDensity> density{};  ///< of what is left; noise has a ratio of 1
  double segment_s{0.0};
  double first_segment_s{0.0};  ///< the shortest that were followed
  std::size_t segments{0};
  State start;  ///< of the first segment
};

/// How far segments grow: to the whole record, or not at all, which is quick and less certain, but
/// forgets what noise of the force has moved; a trial is to be compared, its deviations are rough.
enum class Reach : std::uint8_t { kWhole, kFirstSegments, kTrial };

/// Multiple shooting: the unknowns, and the state at the start of each segment, that leave least of
/// the measured deflection (output error; Bock, "Recent advances in parameter identification
/// techniques for O.D.E.", 1983), by Levenberg and Marquardt with the states eliminated segment by
/// segment. Segments begin at four periods of the motion and grow to the whole record while the
/// longer ones leave little more; what terms remember is handed on. `scale`: sizes of the unknowns'
/// first steps, all above 0; `positive`: unknowns that stay above 0.
[[nodiscard]] Shot shoot(const LawOf& law_of, const Eigen::VectorXd& start,
                         const Eigen::VectorXd& scale, const std::vector<bool>& positive,
                         const std::vector<Drive>& drives, Reach reach = Reach::kWhole);

/// The unknowns as they are: only the states at the segments' starts fit. `segment_s`: as shoot()
/// had it.
[[nodiscard]] Shot follow(const LawOf& law_of, const Eigen::VectorXd& unknowns,
                          const std::vector<Drive>& drives, double segment_s);

}  // namespace dampline::app::law
