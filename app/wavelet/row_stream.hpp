// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "app/wavelet/terms.hpp"
#include "published/wavelet/models.hpp"
#include "published/wavelet/motion_rows.hpp"

namespace dampline::app::wavelet {

/// A model of one mass, or of the chain of two of ChainModel, whose terms are chosen at run time.
/// Column i of the unknowns is term i; unknowns that no term has stay zero. The last Dof columns
/// are the accelerations of the masses; add_inertia() fills them.
template <int Dof>
class TermsModel {
 public:
  static constexpr int kDof = Dof;
  static constexpr int kTerms = Dof == 1 ? 24 : 32;  ///< of all elements together
  static constexpr int kUnknowns = kTerms + Dof;
  static constexpr int kGates = Dof;
  static constexpr bool kGateSign = true;

  /// A term of an element: 0 is the one to the ground, 1 the one between the masses.
  struct Placed {
    RunTimeTerm term;
    int element{0};
  };

  TermsModel() noexcept = default;
  /// `largest_m`: of all deflections, which tells the gate from what it need not watch.
  /// Precondition: at most kTerms terms, none of them inertia.
  TermsModel(const std::vector<Placed>& terms, double largest_m) noexcept
      : count_{terms.size()}, aside_m_{4.0 * largest_m} {
    for (std::size_t i = 0; i < count_; ++i) terms_[i] = terms[i];
  }
  /// Rows may not reach across x = 0 of the element either.
  void watch_centre(int element) noexcept { watched_[static_cast<std::size_t>(element)] = true; }

  [[nodiscard]] Regressors<Dof, kUnknowns> regressors(const PerDof<Dof>& x,
                                                      const PerDof<Dof>& v) const noexcept {
    Regressors<Dof, kUnknowns> out = Regressors<Dof, kUnknowns>::Zero();
    for (std::size_t i = 0; i < count_; ++i) {
      const int column = static_cast<int>(i);
      const bool to_ground = Dof == 1 || terms_[i].element == 0;
      constexpr auto kLast = static_cast<std::size_t>(Dof) - 1;
      if (to_ground) {
        out(0, column) = terms_[i].term(x[0], v[0]);
      } else {
        out(Dof - 1, column) = terms_[i].term(x[kLast] - x[0], v[kLast] - v[0]);
        out(0, column) = -out(Dof - 1, column);
      }
    }
    return out;
  }

  /// A deflection whose side does not matter is moved aside, where it never changes its sign.
  [[nodiscard]] GateSignals<kGates> gates(const PerDof<Dof>& x) const noexcept {
    GateSignals<kGates> out;
    out.deflection_m[0] = x[0] + (watched_[0] ? 0.0 : aside_m_);
    if constexpr (Dof == 2) out.deflection_m[1] = x[1] - x[0] + (watched_[1] ? 0.0 : aside_m_);
    return out;
  }

 private:
  std::array<Placed, static_cast<std::size_t>(kTerms)> terms_{};
  std::size_t count_{0};
  double aside_m_{0.0};
  std::array<bool, static_cast<std::size_t>(Dof)> watched_{};
};

template <int Dof>
using TermsRow = dampline::MotionRow<TermsModel<Dof>>;

/// The equation with the acceleration as a regressor: M is among the unknowns, or nothing moves.
template <int Dof>
void add_inertia(TermsRow<Dof>& row) noexcept {
  for (int d = 0; d < Dof; ++d)
    row.regressors(d, TermsModel<Dof>::kTerms + d) = row.accel_mps2[static_cast<std::size_t>(d)];
}

enum class Wavelet : std::uint8_t { kD6, kD8, kD12, kD16 };
inline constexpr std::array<std::string_view, 4> kWaveletNames{"D6", "D8", "D12", "D16"};
inline constexpr int kDeepestLevel = 8;

/// MotionRows (level 0) or CoarseRows of a wavelet and a level that are chosen at run time.
template <int Dof>
class RowStream {
 public:
  RowStream() = default;
  RowStream(const RowStream&) = delete;
  RowStream& operator=(const RowStream&) = delete;
  virtual ~RowStream() = default;
  /// As MotionRows::push. row.usable: the stretch holds no reversal.
  [[nodiscard]] virtual bool push(const MotionSample<Dof>& sample, TermsRow<Dof>& row) = 0;
  virtual void restart() = 0;
};

/// Preconditions: 0 <= level <= kDeepestLevel; a step and masses above 0.
template <int Dof>
[[nodiscard]] std::unique_ptr<RowStream<Dof>> make_row_stream(Wavelet wavelet, int level,
                                                              const MotionRowsConfig<Dof>& config,
                                                              const TermsModel<Dof>& model);

}  // namespace dampline::app::wavelet
