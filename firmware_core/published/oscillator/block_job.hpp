// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "published/oscillator/drift_free_window.hpp"
#include "published/oscillator/sensitivity.hpp"

namespace dampline {

/// The newest accelerations by a number that counts samples: of the mass, and of the mass against
/// its base.
template <int Capacity>
class SampleRing {
 public:
  void set(std::int64_t n, double mass_mps2, double base_mps2) noexcept {
    mass_[at(n)] = mass_mps2;
    relative_[at(n)] = mass_mps2 - base_mps2;
  }
  [[nodiscard]] double mass_mps2(std::int64_t n) const noexcept { return mass_[at(n)]; }
  [[nodiscard]] double relative_mps2(std::int64_t n) const noexcept { return relative_[at(n)]; }

 private:
  static constexpr std::size_t kSize = std::bit_ceil(static_cast<std::size_t>(Capacity));
  [[nodiscard]] static std::size_t at(std::int64_t n) noexcept {
    return static_cast<std::size_t>(n) & (kSize - 1);
  }
  std::array<double, kSize> mass_{};
  std::array<double, kSize> relative_{};
};

/// Galerkin rows of one block: a'' = -sum theta_i g_i(x, v) under a short compact test function.
/// Before the terms stand columns for what the drift removal took from deflection and velocity, a
/// polynomial over the block: the polynomials p_j themselves, exact for the terms that are linear,
/// and h p_j for each function h that a derivative of another term contains, exact to first order.
/// Triangularisation leaves the information about the terms alone in the last rows.
template <class Terms, int Block, int Slow>
class BlockRows {
 public:
  using Factors = Sensitivities<Terms>;
  static constexpr int kTerms = Terms::kCount;
  static constexpr int kNuisance = Slow * (1 + Factors::kCount);
  static constexpr int kColumns = kNuisance + kTerms + 1;
  using Row = typename Information<kColumns>::Row;
  using Polynomials = GramPolynomials<Slow, Block>;

  static constexpr int kHalf = 3;    ///< the test function reaches so many samples to either side
  static constexpr int kStride = 3;  ///< between rows
  static constexpr int kRows = (Block - 2 * kHalf + kStride - 1) / kStride;

  explicit BlockRows(const Terms& terms) noexcept : terms_{terms} {
    double sum = 0.0;
    for (int m = -kHalf; m <= kHalf; ++m) {
      const double u = static_cast<double>(m) / (kHalf + 1);
      weights_[at(m + kHalf)] = (1.0 - u * u) * (1.0 - u * u) * (1.0 - u * u);
      sum += weights_[at(m + kHalf)];
    }
    for (double& w : weights_) w /= sum;
  }

  [[nodiscard]] static int centre(int row) noexcept { return kHalf + row * kStride; }
  [[nodiscard]] const Polynomials& polynomials() const noexcept { return polynomials_; }

  /// Whether velocity keeps its sign and stays above `least_mps` under the test function. Always so
  /// where no term jumps at rest.
  template <class Window>
  [[nodiscard]] bool usable(int centre, const Window& window, double least_mps) const noexcept {
    if constexpr (!Terms::kKinkAtRest) return true;
    const double sign = window.velocity_mps(centre) > 0.0 ? 1.0 : -1.0;
    for (int n = centre - kHalf; n <= centre + kHalf; ++n) {
      if (sign * window.velocity_mps(n) < least_mps) return false;
    }
    return true;
  }

  /// `mass(n)` is the acceleration of the mass at sample n of the block.
  template <class Window, class Accel>
  [[nodiscard]] Row row(int centre, const Window& window, const Accel& mass) const noexcept {
    Row out = Row::Zero();
    for (int m = -kHalf; m <= kHalf; ++m) {
      const int n = centre + m;
      add(weights_[at(m + kHalf)], n, window.deflection_m(n), window.velocity_mps(n), mass(n), out);
    }
    return out;
  }

 private:
  static constexpr std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

  void add(double weight, int n, double x, double v, double mass_mps2, Row& out) const noexcept {
    Eigen::Matrix<double, 1 + Factors::kCount, 1> factors;
    factors[0] = 1.0;
    Factors::fill(x, v, factors, 1);
    const auto slow = polynomials_.at(n);
    int column = 0;
    for (int i = 0; i <= Factors::kCount; ++i) {
      for (const double p : slow) out[column++] += weight * factors[i] * p;
    }
    Eigen::Matrix<double, kTerms, 1> values;
    terms_.fill(x, v, weight, values);
    for (int i = 0; i < kTerms; ++i) out[column++] += values[i];
    out[column] -= weight * mass_mps2;
  }

  Terms terms_;
  Polynomials polynomials_;
  std::array<double, static_cast<std::size_t>(2 * kHalf + 1)> weights_{};
};

/// What became of a block.
enum class BlockOutcome : std::uint8_t { kPending, kUsed, kQuiet, kUndetermined };

/// From the accelerations of one window to the information of its block about the terms, in pieces
/// that are small enough for one sample each. A block depends on its own window alone, so blocks
/// can be made anywhere and merged in any order.
///
/// Where a term is not linear, a second pass takes the deflection with the polynomial that the
/// first pass found to be lost, its constant apart (that may be a bias of the sensors).
template <class Terms, int Block, int Guard>
class BlockJob {
  static constexpr int kSpring = kPlaceOf<Spring, Terms>;
  static constexpr bool kTwoPasses = Sensitivities<Terms>::kCount > 0;
  static_assert(!kTwoPasses || kSpring >= 0, "terms that are not linear need a spring beside them");

 public:
  using Window = DriftFreeWindow<Block, Guard>;
  using Rows = BlockRows<Terms, Block, Window::kSlow>;
  using Factor = Information<Rows::kTerms + 1>;
  /// Everything that the job of one window may look at, and what arrives while it runs.
  using Ring = SampleRing<Window::kBefore + Window::kLength + Window::kAfter + Block>;

  BlockJob(const Terms& terms, double step_s, double least_velocity_mps) noexcept
      : rows_{terms}, step_s_{step_s}, least_velocity_mps_{least_velocity_mps} {}

  /// Starts with the window whose first sample is `first`. The job before must be done.
  void start(std::int64_t first) noexcept {
    first_ = first;
    window_.clear();
    enter(Phase::kVelocity);
  }

  /// The next piece. kPending until the last one.
  BlockOutcome step(const Ring& ring) noexcept {
    if (phase_ == Phase::kIdle) return BlockOutcome::kPending;
    if (phase_ == Phase::kRows) return add_row(ring);
    for (int i = 0; i < kSamplesPerStep; ++i) {
      if (!sample(ring)) break;
    }
    return phase_ == Phase::kQuiet ? leave(BlockOutcome::kQuiet) : BlockOutcome::kPending;
  }

  /// After kUsed: information about the terms, and the rows that it rests on.
  [[nodiscard]] Factor factor() const noexcept {
    Factor out;
    for (int i = 0; i <= Rows::kTerms; ++i) {
      typename Factor::Row row = Factor::Row::Zero();
      for (int j = i; j <= Rows::kTerms; ++j) {
        row[j] = factor_.at(Rows::kNuisance + i, Rows::kNuisance + j);
      }
      out.absorb(row, i);
    }
    return out;
  }
  [[nodiscard]] double rows() const noexcept { return used_rows_ - Rows::kNuisance; }

 private:
  enum class Phase : std::uint8_t {
    kIdle,
    kVelocity,
    kDeflection,
    kDrift,
    kRows,
    kCorrection,
    kQuiet
  };
  static constexpr int kSamplesPerStep = 20;
  static constexpr int kLeastRows = Rows::kNuisance + 5 * Rows::kTerms;
  static constexpr double kGate = 0.1;  // of the rms of velocity
  static constexpr int kSteps =
      (Window::kVelocitySteps + Window::kDeflectionSteps + 2 * Block) / kSamplesPerStep +
      2 * Rows::kRows + 8;
  static_assert(kSteps < Block, "a job must be done before the next window is complete");

  void enter(Phase phase) noexcept {
    phase_ = phase;
    cursor_ = 0;
    if (phase != Phase::kRows) return;
    factor_.clear();
    used_rows_ = 0;
  }

  BlockOutcome leave(BlockOutcome outcome) noexcept {
    enter(Phase::kIdle);
    second_pass_ = false;
    return outcome;
  }

  /// One sample of a phase; false at the end of the phase.
  bool sample(const Ring& ring) noexcept {
    const int i = cursor_++;
    switch (phase_) {
      case Phase::kVelocity:
        window_.integrate_velocity(i, step_s_,
                                   [&](long j) { return ring.relative_mps2(first_ + j); });
        return goes_on(Window::kVelocitySteps, Phase::kDeflection);
      case Phase::kDeflection:
        window_.integrate_deflection(i, step_s_);
        return goes_on(Window::kDeflectionSteps, Phase::kDrift);
      case Phase::kDrift:
        window_.remove_drift(i);
        if (goes_on(Block, Phase::kRows)) return true;
        if (window_.velocity_rms_mps() < least_velocity_mps_) phase_ = Phase::kQuiet;
        return false;
      default:
        window_.shift_deflection(i, Rows::Polynomials::sum(lost_, rows_.polynomials().at(i)));
        return goes_on(Block, Phase::kRows);
    }
  }

  bool goes_on(int length, Phase next) noexcept {
    if (cursor_ < length) return true;
    enter(next);
    return false;
  }

  BlockOutcome add_row(const Ring& ring) noexcept {
    const int centre = Rows::centre(cursor_++);
    const double gate = std::max(kGate * window_.velocity_rms_mps(), least_velocity_mps_);
    if (rows_.usable(centre, window_, gate)) {
      factor_.absorb(
          rows_.row(centre, window_, [&](int n) { return ring.mass_mps2(first_ + Guard + n); }));
      ++used_rows_;
    }
    return cursor_ < Rows::kRows ? BlockOutcome::kPending : after_rows();
  }

  BlockOutcome after_rows() noexcept {
    if (used_rows_ < kLeastRows) return leave(BlockOutcome::kUndetermined);
    if constexpr (kTwoPasses) {
      if (!second_pass_ && find_lost()) {
        second_pass_ = true;
        enter(Phase::kCorrection);
        return BlockOutcome::kPending;
      }
    }
    return leave(BlockOutcome::kUsed);
  }

  /// The lost deflection is (sum_j c_j p_j) / k. False where the block does not say, or where it
  /// would be larger than what was found of the motion.
  bool find_lost() noexcept {
    typename Information<Rows::kColumns>::Vector all;
    if (!factor_.solve(all)) return false;
    const double stiffness = all[Rows::kNuisance + kSpring];
    lost_[0] = 0.0;
    double square = 0.0;
    for (std::size_t j = 1; j < lost_.size(); ++j) {
      lost_[j] = all[static_cast<int>(j)] / stiffness;
      square += lost_[j] * lost_[j];
    }
    return square < window_.deflection_square_m2();
  }

  Rows rows_;
  double step_s_;
  double least_velocity_mps_;
  Window window_;
  Information<Rows::kColumns> factor_;
  typename Rows::Polynomials::Values lost_{};
  std::int64_t first_{0};
  int cursor_{0};
  int used_rows_{0};
  bool second_pass_{false};
  Phase phase_{Phase::kIdle};
};

}  // namespace dampline
