// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/basis/columns.hpp"
#include "dampline/density/drift_fit.hpp"
#include "dampline/density/histogram.hpp"
#include "dampline/density/input_statistics.hpp"
#include "dampline/density/joint_histogram.hpp"
#include "dampline/density/paper_form.hpp"
#include "dampline/density/trust.hpp"
#include "dampline/motion/motion.hpp"
#include "dampline/result.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

struct FokkerPlanckConfig {
  double sample_rate_hz{300.0};  ///< 150...400
  std::array<double, kCurveSegments> curve_nodes_mps{kDefaultCurveNodesMps};
  BinRange velocity_mps{.resolution = 3.125e-5, .warm_up_samples = 6000};
  BinRange deflection_m{.resolution = 2.0e-6, .warm_up_samples = 6000};
  double memory_s{0.0};                ///< time constant of forgetting; 0: none
  double anti_alias_corner_hz{100.0};  ///< of the accelerations; 0: none
  /// The deflection has its true mean. Otherwise a constant in the force is not observable, and
  /// every curve is given without it.
  bool deflection_is_absolute{false};
};

/// One method's answer. Without `verdict.has_number` nothing else means anything.
struct MethodResult {
  static constexpr std::size_t kMaxPoints = 2 * (kPaperSegments + 1);
  TrustVerdict verdict;
  Estimate level_n;                            ///< (F1 + F2) / 2
  std::array<CurvePoint, kMaxPoints> curve{};  ///< from the lowest velocity to the highest
  std::size_t points{0};                       ///< of curve; velocity 0 appears on both sides
};

struct FokkerPlanckEstimates {
  MethodResult paper;        ///< region around v = 0 left out, as the method needs
  MethodResult weak;         ///< weak form of the Fokker-Planck equation
  MethodResult known_input;  ///< conditional mean with the measured input
  Estimate input_level;      ///< D, two-sided, (m/s^2)^2 / Hz
};

/// Damping from the stationary densities of the motion: histograms and sums of a stream in a fixed
/// size, and on demand the curve by three methods, each with its verdict. update() costs a bounded
/// number of operations and allocates nothing.
class FokkerPlanck {
 public:
  static constexpr double kBlockS = 2.0;
  using Joint = JointHistogram<32, 32>;

  /// kInvalidConfig when a setting is out of its range.
  [[nodiscard]] static Result<FokkerPlanckConfig> check(const FokkerPlanckConfig& config) noexcept;

  /// Precondition: check(config).ok().
  explicit FokkerPlanck(const FokkerPlanckConfig& config) noexcept;

  /// Takes the next instant. Standstill is counted and left out; a jump of the tick is a gap.
  void update(const Motion& motion) noexcept;

  /// Adds another record's statistics. kMismatch when bins, nodes, rate or memory differ; then
  /// nothing is changed. Returns the samples of both. Counts add exactly.
  Result<std::uint64_t> merge(const FokkerPlanck& other) noexcept;

  /// M in kg, k in N/m, as in M z_b'' + k y + F(v) = 0. Solves some 50 small systems.
  [[nodiscard]] FokkerPlanckEstimates estimates(double mass_kg,
                                                double stiffness_npm) const noexcept;

  /// The paper's estimator with a bandwidth and an excluded region of choice; its mean level D as
  /// measured. Not ok without motion.
  [[nodiscard]] PaperForm paper_form(double mass_kg, double stiffness_npm, double bandwidth_mps,
                                     double excluded_mps, double reach_mps = 0.0,
                                     std::size_t segments = kPaperSegments) const noexcept;

  [[nodiscard]] const VelocityHistogram& velocities() const noexcept { return velocities_; }
  [[nodiscard]] const DeflectionHistogram& deflections() const noexcept { return deflections_; }
  /// x: deflection, y: velocity.
  [[nodiscard]] const Joint& joint() const noexcept { return joint_; }
  /// Two-sided spectral level of the input at spectrum_frequency_hz(line), (m/s^2)^2 / Hz.
  [[nodiscard]] double input_spectrum(std::size_t line) const noexcept;
  [[nodiscard]] double spectrum_frequency_hz(std::size_t line) const noexcept {
    return spectrum_.frequency_hz(line);
  }
  [[nodiscard]] double velocity_rms_mps() const noexcept;
  [[nodiscard]] const FokkerPlanckConfig& config() const noexcept { return config_; }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }  ///< in motion
  [[nodiscard]] std::uint64_t still() const noexcept { return still_; }
  [[nodiscard]] std::uint64_t not_finite() const noexcept { return not_finite_; }

 private:
  /// Of every 16th block.
  struct Group {
    DriftSums all, away;  // away: not beside a reversal
    InputSpectrum::Sums input;
  };
  struct Scalars {
    double weight{0.0}, weight_squares{0.0};
    double v2{0.0}, y2{0.0};
    double frame{0.0}, frame2{0.0}, input{0.0}, input2{0.0};
    double crossings{0.0};  // of zero, by v
    void add(const Scalars& other, double factor) noexcept;
  };
  friend class FokkerPlanckSolver;

  void begin_block(std::int64_t block) noexcept;
  void scale(double factor) noexcept;
  void take_scalars(const Motion& motion, double weight) noexcept;

  FokkerPlanckConfig config_;
  std::int64_t block_ticks_;
  double reversal_s_;
  DriftBins bins_;
  GrowingWeight weight_;  // steps at every block
  VelocityHistogram velocities_;
  DeflectionHistogram deflections_;
  Joint joint_;
  InputSpectrum spectrum_;
  Modulation modulation_;
  BlockPowers powers_;
  Scalars scalars_;
  std::array<Group, kSampleGroups> groups_{};

  bool any_{false};
  std::int64_t last_tick_{0};
  std::int64_t block_{0};
  std::size_t group_{0};
  bool last_positive_{false};
  std::uint64_t samples_{0};
  std::uint64_t still_{0};
  std::uint64_t not_finite_{0};
};

}  // namespace dampline
