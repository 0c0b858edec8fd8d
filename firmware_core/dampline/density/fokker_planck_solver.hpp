// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/density/fokker_planck.hpp"

namespace dampline {

/// alpha at the points of a method's curve, and its level: what the scatter of groups is taken of.
struct FokkerPlanckSolution {
  bool ok{false};
  double level{0.0};
  std::array<double, MethodResult::kMaxPoints> alpha{};
};

/// Everything that one call of estimates() works with.
class FokkerPlanckSolver {
 public:
  FokkerPlanckSolver(const FokkerPlanck& data, double mass_kg, double stiffness_npm) noexcept;

  [[nodiscard]] FokkerPlanckEstimates estimates() const noexcept;
  [[nodiscard]] PaperForm paper(double bandwidth_mps, double excluded_mps, double reach_mps,
                                std::size_t left_out,
                                std::size_t segments = kPaperSegments) const noexcept;

 private:
  static constexpr std::size_t kNone = kSampleGroups;
  using Solve = FokkerPlanckSolution (FokkerPlanckSolver::*)(std::size_t left_out) const;

  [[nodiscard]] FokkerPlanck::Group without(std::size_t left_out) const noexcept;
  [[nodiscard]] FokkerPlanckSolution solve_paper(std::size_t left_out) const noexcept;
  [[nodiscard]] FokkerPlanckSolution solve_weak(std::size_t left_out) const noexcept;
  [[nodiscard]] FokkerPlanckSolution solve_known(std::size_t left_out) const noexcept;
  [[nodiscard]] FokkerPlanckSolution from_fit(const DriftFit& fit) const noexcept;
  [[nodiscard]] TrustVerdict support() const noexcept;
  static void require_segments(std::size_t segments, TrustVerdict& verdict) noexcept;
  [[nodiscard]] double force_of(std::size_t first, std::size_t end) const noexcept;
  void require_level(TrustVerdict& verdict) const noexcept;
  void require_range(TrustVerdict& verdict) const noexcept;
  void require_white(TrustVerdict& verdict) const noexcept;
  void require_stationary(TrustVerdict& verdict) const noexcept;
  void require_independent(TrustVerdict& verdict) const noexcept;
  void complete(Solve solve, MethodResult& result) const noexcept;
  void place_points(const DriftSums& sums, MethodResult& result) const noexcept;
  void place_paper_points(MethodResult& result) const noexcept;
  [[nodiscard]] Estimate input_level() const noexcept;
  template <class F>
  void jackknife(std::size_t size, F&& value, double* std) const noexcept;

  const FokkerPlanck& data_;
  double half_mass_kg_;
  double beta_;
  double weight_;
  FokkerPlanck::Group total_{};
  std::size_t segments_{0};
  std::size_t away_segments_{0};
  DeflectionIntegrals deflections_{};
  Modulation::Polynomial modulation_{};
  double bandwidth_mps_{0.0};
  double reach_mps_{0.0};
};

}  // namespace dampline
