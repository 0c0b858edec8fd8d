// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstddef>

#include "published/wavelet/terms.hpp"

namespace dampline {

/// One number per degree of freedom.
template <int Dof>
using PerDof = std::array<double, static_cast<std::size_t>(Dof)>;

/// Equation d of a system with `Dof` degrees of freedom, linear in its unknowns:
///   m_d x_d'' + sum_i G(d, i)(x, v) theta_i = f_d.
template <int Dof, int Unknowns>
using Regressors = Eigen::Matrix<double, Dof, Unknowns, Dof == 1 ? Eigen::RowMajor : 0>;

/// A deflection whose rate (and, for some terms, whose own sign) must not change within a stencil.
template <int Count>
struct GateSignals {
  static constexpr int kCount = Count;
  std::array<double, static_cast<std::size_t>(Count)> deflection_m{};
};

/// What turns motion into regressors.
///   kDof, kUnknowns
///   kGates             number of deflections that the gate watches, 0 for a smooth model
///   kGateSign          whether the sign of each counts, beside that of its rate
///   regressors(x, v)   the matrix G
///   gates(x)           the deflections that the gate watches, m
template <class M>
concept Model = requires(const M& model, const PerDof<M::kDof>& x) {
  { M::kGates } -> std::convertible_to<int>;
  { M::kGateSign } -> std::convertible_to<bool>;
  { model.regressors(x, x) } -> std::same_as<Regressors<M::kDof, M::kUnknowns>>;
  { model.gates(x) } -> std::same_as<GateSignals<M::kGates>>;
};

/// m x'' + sum theta_i g_i(x, x') = f.
template <class Terms>
class SingleModel {
 public:
  static constexpr int kDof = 1;
  static constexpr int kUnknowns = Terms::kCount;
  static constexpr bool kGateSign = Terms::kKinkAtCentre;
  static constexpr int kGates = Terms::kKinkAtRest || kGateSign ? 1 : 0;

  constexpr SingleModel() noexcept = default;
  constexpr explicit SingleModel(const Terms& terms) noexcept : terms_{terms} {}

  [[nodiscard]] Regressors<1, kUnknowns> regressors(const PerDof<1>& x,
                                                    const PerDof<1>& v) const noexcept {
    Regressors<1, kUnknowns> out;
    terms_.fill(x[0], v[0], 1.0, out);
    return out;
  }
  [[nodiscard]] GateSignals<kGates> gates(const PerDof<1>& x) const noexcept {
    GateSignals<kGates> out;
    if constexpr (kGates > 0) out.deflection_m[0] = x[0];
    return out;
  }

 private:
  Terms terms_{};
};

/// A chain: element 1 between the ground and mass 1, element 2 between mass 1 and mass 2,
///   m1 x1'' + g1(x1, v1) - g2(x2 - x1, v2 - v1) = f1
///   m2 x2''              + g2(x2 - x1, v2 - v1) = f2.
/// Unknowns: those of element 1, then those of element 2, which both equations share.
template <class First, class Second>
class ChainModel {
 public:
  static constexpr int kDof = 2;
  static constexpr int kUnknowns = First::kCount + Second::kCount;
  static constexpr bool kGateSign = First::kKinkAtCentre || Second::kKinkAtCentre;
  static constexpr int kGates = First::kKinkAtRest || Second::kKinkAtRest || kGateSign ? 2 : 0;

  constexpr ChainModel() noexcept = default;
  constexpr ChainModel(const First& first, const Second& second) noexcept
      : first_{first}, second_{second} {}

  [[nodiscard]] Regressors<2, kUnknowns> regressors(const PerDof<2>& x,
                                                    const PerDof<2>& v) const noexcept {
    Regressors<2, kUnknowns> out = Regressors<2, kUnknowns>::Zero();
    Eigen::Matrix<double, 1, kUnknowns> row = Eigen::Matrix<double, 1, kUnknowns>::Zero();
    second_.fill(x[1] - x[0], v[1] - v[0], 1.0, row, First::kCount);
    out.row(1) = row;
    out.row(0) = -row;
    row.setZero();
    first_.fill(x[0], v[0], 1.0, row);
    out.row(0) += row;
    return out;
  }
  [[nodiscard]] GateSignals<kGates> gates(const PerDof<2>& x) const noexcept {
    GateSignals<kGates> out;
    if constexpr (kGates > 0) out.deflection_m = {x[0], x[1] - x[0]};
    return out;
  }

 private:
  First first_{};
  Second second_{};
};

/// Two masses on springs, each with damping and friction of its own against the ground:
///   m1 x1'' + c11 v1 + k11 x1 + k12 x2 + e1 sign(v1) = f1
///   m2 x2'' + c22 v2 + k12 x1 + k22 x2 + e2 sign(v2) = f2.
/// Unknowns, in this order: c11, k11, k12, c22, k22, e1, e2.
template <class Sign = ExactSign>
class GroundedFrictionModel {
 public:
  static constexpr int kDof = 2;
  static constexpr int kUnknowns = 7;
  static constexpr bool kGateSign = false;
  static constexpr int kGates = Sign::kKinkAtRest ? 2 : 0;
  enum Unknown : int { kC11, kK11, kK12, kC22, kK22, kE1, kE2 };

  constexpr GroundedFrictionModel() noexcept = default;
  constexpr explicit GroundedFrictionModel(const Sign& sign) noexcept : sign_{sign} {}

  [[nodiscard]] Regressors<2, kUnknowns> regressors(const PerDof<2>& x,
                                                    const PerDof<2>& v) const noexcept {
    Regressors<2, kUnknowns> out = Regressors<2, kUnknowns>::Zero();
    out(0, kC11) = v[0];
    out(0, kK11) = x[0];
    out(0, kK12) = x[1];
    out(0, kE1) = sign_(v[0]);
    out(1, kC22) = v[1];
    out(1, kK12) = x[0];
    out(1, kK22) = x[1];
    out(1, kE2) = sign_(v[1]);
    return out;
  }
  [[nodiscard]] GateSignals<kGates> gates(const PerDof<2>& x) const noexcept {
    GateSignals<kGates> out;
    if constexpr (kGates > 0) out.deflection_m = x;
    return out;
  }

 private:
  Sign sign_{};
};

}  // namespace dampline
