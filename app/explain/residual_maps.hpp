// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "app/explain/evidence_point.hpp"
#include "app/explain/signature.hpp"

namespace dampline::app {

/// Free-form maps of what is left: over (y, v), and over direction and travel since the last
/// reversal. Each half of the record is explained by the map of the other half.
class ResidualMaps {
 public:
  /// `deflection_m`, `velocity_mps`: the size of the motion; `noise_m`: smaller turns are none.
  ResidualMaps(double deflection_m, double velocity_mps, double noise_m, double half_s)
      : deflection_m_{deflection_m},
        velocity_mps_{velocity_mps},
        turn_m_{noise_m},
        half_s_{half_s} {}
  void add(const EvidencePoint& point);
  void gap() {
    moving_ = false;
    waiting_.clear();
  }
  void describe(Signature& out) const;

 private:
  static constexpr std::size_t kSide = 9;  // odd: a cell about zero
  static constexpr std::size_t kTravels = 12;
  struct Cell {
    double count{0.0};
    double sum{0.0};
    double squares{0.0};
    void absorb(double x) {
      count += 1.0;
      sum += x;
      squares += x * x;
    }
  };
  template <std::size_t N>
  using Map = std::array<std::array<Cell, N>, 2>;  // by half

  [[nodiscard]] std::size_t surface_cell(const EvidencePoint& point) const;
  /// A point since the farthest: of the way there, or of the way back once that is clear.
  struct Waiting {
    double deflection_m;
    double left_n;
    std::size_t half;
  };
  void settle();

  double deflection_m_, velocity_mps_, turn_m_, half_s_;
  Map<kSide * kSide> surface_{};
  Map<2 * kTravels> travel_{};
  bool moving_{false};
  bool up_{false};
  std::vector<Waiting> waiting_;
  double extreme_m_{0.0};  // farthest in the present direction
  double turned_m_{0.0};   // where the last reversal was
};

}  // namespace dampline::app
