// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "dampline/effect/candidates.hpp"
#include "dampline/effect/gram_store.hpp"

namespace dampline::effect {

using ScaleWeights = std::array<double, kScales>;

/// The sums of a record with its scales weighted and added: what models are fitted to. About 1 MiB:
/// place it yourself.
struct Evidence {
  ScaleWeights weight{};
  ScaleWeights rows{};
  std::size_t count{0};
  std::array<Gram, kScales> scale{};  ///< of the whole record, not weighted
  std::array<Gram, kEffectEntries> entry{};
  Gram total;

  /// Sums by scale; scales with too few rows are left out. Weights become the inverse of the
  /// target's variance. False when no scale is left.
  bool load(const GramStore& store) noexcept;
  /// The sums of the entries anew with other weights.
  void weigh(const GramStore& store, const ScaleWeights& weights) noexcept;
};

/// Friction of one width, spring, and the effects in the model; the law's width is profiled again
/// for every model.
struct Model {
  static constexpr std::size_t kMostEffects = 5;
  std::size_t count{0};
  std::array<Candidate, kMostEffects> effect{};

  [[nodiscard]] Model with(const Candidate& candidate) const noexcept {
    Model out = *this;
    out.effect[out.count++] = candidate;
    return out;
  }
  [[nodiscard]] Model without(std::size_t i) const noexcept {
    Model out = *this;
    for (; i + 1 < out.count; ++i) out.effect[i] = out.effect[i + 1];
    --out.count;
    return out;
  }
  /// How many of its effects pass a test of a Candidate.
  template <class Test>
  [[nodiscard]] std::size_t count_of(const Test& test) const noexcept {
    std::size_t out = 0;
    for (std::size_t i = 0; i < count; ++i) out += test(effect[i]) ? 1U : 0U;
    return out;
  }
};

/// Two for each effect, of which one mode, which may have three, and one that has a single one.
inline constexpr int kMostTerms = 3 + 2 * static_cast<int>(Model::kMostEffects);

/// Unknowns in order: friction, spring, change of friction with its width, then the effects'.
struct ModelFit {
  static constexpr int kCoulomb = 0;
  static constexpr int kStiffness = 1;
  static constexpr int kWidthChange = 2;
  static constexpr int kFirstEffect = 3;
  using Vector = Eigen::Matrix<double, kMostTerms, 1>;
  using Square = Eigen::Matrix<double, kMostTerms, kMostTerms>;

  /// Where the unknowns of a model's i-th effect begin.
  [[nodiscard]] static int first_of(const Model& model, std::size_t i) noexcept {
    int term = kFirstEffect;
    for (std::size_t e = 0; e < i; ++e) term += static_cast<int>(model.effect[e].count);
    return term;
  }

  bool ok{false};
  int terms{0};
  std::size_t width_index{0};
  double width_mps{0.0};
  Vector theta = Vector::Zero();
  Square covariance = Square::Zero();  ///< from the scatter of the entries
  double nmse{0.0};
  double held_out_nmse{0.0};
  std::array<double, kEffectEntries> held_out_error{};  ///< of each entry, of the total's target
};

[[nodiscard]] inline BaseForce base_of(const ModelFit& fit) noexcept {
  return {fit.theta[ModelFit::kCoulomb], fit.theta[ModelFit::kStiffness]};
}

/// Fits a model and judges it on entries that were held out, in interleaved folds; the neighbours
/// of what is held out take no part in the fit either, since windows overlap.
class ModelFitter {
 public:
  explicit ModelFitter(const Evidence& evidence) noexcept : evidence_{&evidence} {}
  [[nodiscard]] ModelFit fit(const Model& model) noexcept;
  /// NMSE of a model with the coefficients of another record.
  [[nodiscard]] double nmse_of(const Model& model, const ModelFit& fit) const noexcept;
  /// The force of a model in a row, per unit of moving mass.
  [[nodiscard]] static double force(const Model& model, const ModelFit& fit,
                                    const Row& row) noexcept;
  /// The inverse residual variance of a fit, scale by scale: the weights that belong to it.
  [[nodiscard]] ScaleWeights weights_of(const Model& model, const ModelFit& fit) const noexcept;

 private:
  static constexpr int kMostColumns = kMostTerms + 1;
  using Small = Eigen::Matrix<double, kMostColumns, kMostColumns>;
  using Terms = std::array<Regressor, kMostColumns>;

  /// Fills in the columns of a model with the law's width i; returns how many, the target included.
  [[nodiscard]] static int columns(const Model& model, std::size_t i, Terms& terms) noexcept;
  void project(const Gram& gram, const Terms& terms, int count, Small& out) const noexcept;
  [[nodiscard]] bool choose_width(const Model& model, std::size_t& best) const noexcept;
  void judge(ModelFit& fit) noexcept;
  void spread(ModelFit& fit) noexcept;

  const Evidence* evidence_;
  Small total_;
  std::array<Small, kEffectEntries> entry_;
};

}  // namespace dampline::effect
