// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/blocks.hpp"
#include "dampline/numeric/information.hpp"
#include "published/wavelet/motion_rows.hpp"

namespace dampline {

/// Which unknowns of a model take part; the others are zero.
template <int Unknowns>
using TermMask = std::array<bool, static_cast<std::size_t>(Unknowns)>;

/// The information of consecutive blocks of instants, per equation of the model. When all blocks
/// are full, neighbours join two by two and blocks are twice as long from then on: any run fits.
template <int Dof, int Unknowns>
class ModelBlocks {
 public:
  static constexpr std::size_t kBlocks = 16;
  using Factor = Information<Unknowns + 1>;
  using Factors = std::array<Factor, static_cast<std::size_t>(Dof)>;
  using Vector = typename Factor::Vector;

  explicit ModelBlocks(std::int64_t instants_per_block) noexcept : length_{instants_per_block} {}

  /// Begins the next instant; its equations follow by absorb().
  void begin_instant() noexcept {
    if (count_ == 0 || instants_[count_ - 1] == length_) open();
    ++instants_[count_ - 1];
  }
  void absorb(std::size_t dof, const typename Factor::Row& row) noexcept {
    blocks_[count_ - 1][dof].absorb(row);
  }

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] const Factors& block(std::size_t i) const noexcept { return blocks_[i]; }

  /// The information about the masked unknowns of the blocks for which `takes(block)`, all
  /// equations together. Columns of other unknowns are zero.
  template <class Takes>
  [[nodiscard]] Factor sum(const TermMask<Unknowns>& mask, const Takes& takes) const noexcept {
    Factor out;
    for (std::size_t b = 0; b < count_; ++b) {
      if (!takes(b)) continue;
      for (const Factor& factor : blocks_[b]) add_masked(factor, mask, out);
    }
    return out;
  }

  /// Solves for the masked unknowns; false where they are not determined.
  [[nodiscard]] static bool solve(const Factor& factor, const TermMask<Unknowns>& mask,
                                  Vector& theta, double tolerance = 1e-9) noexcept {
    theta.setZero();
    for (int i = Unknowns - 1; i >= 0; --i) {
      if (!mask[static_cast<std::size_t>(i)]) continue;
      if (!(factor.at(i, i) > tolerance * factor.column_norm(i))) return false;
      double sum = factor.at(i, Unknowns);
      for (int j = i + 1; j < Unknowns; ++j) sum -= factor.at(i, j) * theta[j];
      theta[i] = sum / factor.at(i, i);
    }
    return true;
  }

  /// |A theta - b|^2 of one equation over one block.
  [[nodiscard]] double residual(std::size_t b, std::size_t dof,
                                const Vector& theta) const noexcept {
    double sum = 0.0;
    for (int i = 0; i <= Unknowns; ++i) {
      double r = -blocks_[b][dof].at(i, Unknowns);
      for (int j = i; j < Unknowns; ++j) r += blocks_[b][dof].at(i, j) * theta[j];
      sum += r * r;
    }
    return sum;
  }

 private:
  static void add_masked(const Factor& from, const TermMask<Unknowns>& mask, Factor& out) noexcept {
    for (int i = 0; i <= Unknowns; ++i) {
      typename Factor::Row row = from.row(i);
      for (int j = 0; j < Unknowns; ++j) {
        if (!mask[static_cast<std::size_t>(j)]) row[j] = 0.0;
      }
      out.absorb(row, i);
    }
  }

  void open() noexcept {
    if (count_ == kBlocks) halve();
    if (count_ > 0 && instants_[count_ - 1] < length_) return;
    blocks_[count_] = Factors{};
    instants_[count_++] = 0;
  }

  void halve() noexcept {
    join_neighbours(instants_, kBlocks, [](auto& block, auto next) { block += next; });
    count_ = join_neighbours(blocks_, kBlocks, [](Factors& block, const Factors& next) {
      for (std::size_t d = 0; d < block.size(); ++d) block[d].merge(next[d]);
    });
    length_ *= 2;
  }

  std::array<Factors, kBlocks> blocks_{};
  std::array<std::int64_t, kBlocks> instants_{};
  std::size_t count_{0};
  std::int64_t length_;
};

/// One model's fit to a run.
template <int Dof, int Unknowns>
struct ModelFit {
  using Vector = Eigen::Matrix<double, Unknowns, 1>;
  TermMask<Unknowns> terms{};
  Vector theta = Vector::Zero();
  Vector deviation = Vector::Zero();   ///< by the block jackknife
  Vector t_ratio = Vector::Zero();     ///< theta / deviation; 0 for terms that do not take part
  PerDof<Dof> mse_percent{};           ///< equation 35: in-sample
  PerDof<Dof> held_out_mse_percent{};  ///< of instants that the parameters were not fitted to
  bool valid{false};
};

/// Decides which terms of an over-specified model a run supports.
///
/// Ghanem and Romeo (2001), section 3, compare models by the error of the acceleration that a model
/// predicts, MSE = 100 / (N var x'') sum (x'' - x''_model)^2 (their equation 35). In-sample that
/// can only fall when a term is added, so it rejects models that lack a term, never one that has a
/// term too many. Two figures that can are added: the same error over blocks that were held out,
/// in interleaved folds, and each term's t-ratio, with the standard deviation from the jackknife
/// over blocks (valid for correlated and unequal errors). choose() drops the term with the smallest
/// |t| until all are above `least_t`.
///
/// absorb() costs the same for every instant but for every kBlocks-th block, whose first one pays
/// for joining the blocks: 8 Dof (Unknowns + 1) absorbed rows.
template <Model M>
class ModelSelection {
 public:
  static constexpr int kUnknowns = M::kUnknowns;
  using Fit = ModelFit<M::kDof, kUnknowns>;
  using Mask = TermMask<kUnknowns>;
  using Vector = typename Fit::Vector;
  static constexpr std::size_t kFolds = 4;
  static constexpr double kLeastT = 4.0;

  explicit ModelSelection(std::int64_t instants_per_block = 64) noexcept
      : blocks_{instants_per_block} {}

  /// Takes a usable row. Equations are divided by their mass, so that residuals are accelerations.
  void absorb(const MotionRow<M>& row, const PerDof<M::kDof>& mass_kg) noexcept {
    blocks_.begin_instant();
    ++instants_;
    for (std::size_t d = 0; d < kDof; ++d) {
      blocks_.absorb(d, row.equation(static_cast<int>(d)) / mass_kg[d]);
      const double from_old = row.accel_mps2[d] - accel_mean_[d];
      accel_mean_[d] += from_old / static_cast<double>(instants_);
      accel_squares_[d] += from_old * (row.accel_mps2[d] - accel_mean_[d]);
    }
  }

  /// Fit of the model that has only the masked terms. Not valid where the run does not determine
  /// them from any three of the four folds.
  [[nodiscard]] Fit fit(const Mask& terms) const noexcept {
    Fit out;
    out.terms = terms;
    if (blocks_.count() < 2 * kFolds) return out;
    const auto all = [](std::size_t) { return true; };
    if (!Blocks::solve(blocks_.sum(terms, all), terms, out.theta)) return out;
    for (std::size_t b = 0; b < blocks_.count(); ++b) add_errors(b, out.theta, out.mse_percent);
    for (std::size_t fold = 0; fold < kFolds; ++fold) {
      if (!hold_out(fold, out)) return out;
    }
    out.valid = jackknife(out);
    return out;
  }

  /// All terms.
  [[nodiscard]] static Mask everything() noexcept {
    Mask mask;
    mask.fill(true);
    return mask;
  }

  /// Starts with `terms` and drops the least significant one as long as its |t| is below `least_t`.
  [[nodiscard]] Fit choose(const Mask& terms = everything(),
                           double least_t = kLeastT) const noexcept {
    Fit best = fit(terms);
    for (int dropped = 0; best.valid && dropped + 1 < kUnknowns; ++dropped) {
      const int weakest = weakest_term(best);
      if (weakest < 0 || std::abs(best.t_ratio[weakest]) >= least_t) break;
      Mask fewer = best.terms;
      fewer[static_cast<std::size_t>(weakest)] = false;
      const Fit next = fit(fewer);
      if (!next.valid) break;
      best = next;
    }
    return best;
  }

  [[nodiscard]] std::int64_t instants() const noexcept { return instants_; }

 private:
  static constexpr auto kDof = static_cast<std::size_t>(M::kDof);
  using Blocks = ModelBlocks<M::kDof, kUnknowns>;

  /// Adds a block's share of equation 35 under `theta`.
  void add_errors(std::size_t b, const Vector& theta, PerDof<M::kDof>& mse_percent) const noexcept {
    for (std::size_t d = 0; d < kDof; ++d) {
      mse_percent[d] += 100.0 * blocks_.residual(b, d, theta) / accel_squares_[d];
    }
  }

  /// Predicts every kFolds-th block from the others.
  [[nodiscard]] bool hold_out(std::size_t fold, Fit& out) const noexcept {
    const auto kept = [fold](std::size_t b) { return b % kFolds != fold; };
    Vector theta;
    if (!Blocks::solve(blocks_.sum(out.terms, kept), out.terms, theta)) return false;
    for (std::size_t b = fold; b < blocks_.count(); b += kFolds) {
      add_errors(b, theta, out.held_out_mse_percent);
    }
    return true;
  }

  /// Deviations from the estimates that leave out one block each.
  [[nodiscard]] bool jackknife(Fit& out) const noexcept {
    const auto count = static_cast<double>(blocks_.count());
    Vector mean = Vector::Zero();
    Vector squares = Vector::Zero();
    for (std::size_t b = 0; b < blocks_.count(); ++b) {
      const auto others = [b](std::size_t i) { return i != b; };
      Vector theta;
      if (!Blocks::solve(blocks_.sum(out.terms, others), out.terms, theta)) return false;
      const Vector from_old = theta - mean;
      mean += from_old / static_cast<double>(b + 1);
      squares += from_old.cwiseProduct(theta - mean);
    }
    out.deviation = ((count - 1.0) / count * squares).cwiseSqrt();
    for (int i = 0; i < kUnknowns; ++i) {
      if (out.terms[static_cast<std::size_t>(i)]) out.t_ratio[i] = out.theta[i] / out.deviation[i];
    }
    return true;
  }

  static int weakest_term(const Fit& fit) noexcept {
    int weakest = -1;
    for (int i = 0; i < kUnknowns; ++i) {
      if (!fit.terms[static_cast<std::size_t>(i)]) continue;
      if (weakest < 0 || std::abs(fit.t_ratio[i]) < std::abs(fit.t_ratio[weakest])) weakest = i;
    }
    return weakest;
  }

  Blocks blocks_;
  std::int64_t instants_{0};
  PerDof<M::kDof> accel_mean_{};
  PerDof<M::kDof> accel_squares_{};
};

}  // namespace dampline
