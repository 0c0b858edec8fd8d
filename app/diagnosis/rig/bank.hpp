// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/library.hpp"

namespace dampline::app::rig {

/// What a bank says in lengths and forces: coming from full slip on one side and moving to full
/// slip on the other, slowly.
struct BankFigures {
  double level_up_n{0.0};
  double level_down_n{0.0};
  double free_play_m{0.0};
  double step_m{0.0};  ///< to which lengths are read
  double stiffness_npm{0.0};
  double play_share{0.0};  ///< soft travel over that between nine tenths of either level
};

[[nodiscard]] double longest_of(const std::vector<BankElement>& bank);
/// The elements of memory among the columns, beside the sign of v.
[[nodiscard]] BankFigures read_bank(const std::vector<Regressor>& columns,
                                    const Eigen::VectorXd& theta, double longest_m);

}  // namespace dampline::app::rig
