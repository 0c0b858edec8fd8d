// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "dampline/snapshot.hpp"

namespace dampline::app {

/// Something in the record that a method assumes and that does not hold.
struct Objection {
  std::string reason;  ///< a plain sentence
  double size{0.0};    ///< of the violation
  double limit{0.0};   ///< the most, or the least, that the method can stand
  std::string unit;    ///< of both; empty: a pure number
};

/// What another method than the wavelet windows makes of the same record.
struct MethodSummary {
  std::string name;   ///< "fokker_planck_weak", ...: as in parameters.json and curve.csv
  std::string title;  ///< for people
  Estimate level_n;   ///< Coulomb level
  bool has_level{false};
  bool trusted{false};
  std::vector<Objection> objections;
  std::vector<Estimate> curve_n;  ///< at the velocities of RunResult::curve; NaN: no support
};

/// One bin of an online histogram.
struct DensityRow {
  double centre{0.0};
  double density{0.0};  ///< per unit of the quantity
  double samples{0.0};  ///< forgetting makes fractions of samples
};

/// Density of one quantity; its integral over the range is 1 - outside_share.
struct DensityTable {
  std::string quantity;  ///< with its unit: "deflection_m"
  double outside_share{0.0};
  std::vector<DensityRow> rows;
};

}  // namespace dampline::app
