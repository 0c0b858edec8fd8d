// SPDX-License-Identifier: MIT
#pragma once
#include "app/wavelet/measured.hpp"

namespace dampline::app::wavelet {

/// Polynomials of so many coefficients are taken from velocity and deflection of each window: what
/// a bias, a drift and the unknown start make is among them, and so is what is lost of the motion.
inline constexpr int kSlow = 8;

/// `accelerations` holds accelerations of the masses in place of deflections and of the base in
/// place of forces. Gives deflections against the base, by two running integrals in windows of
/// 2 block_s less their least-squares polynomials, and the base's acceleration with the sign turned
/// in place of the force: x'' + g(x, x') / m = -base''. Windows overlap by half: their middles,
/// `blocks`, follow each other. Throws RunError where no stretch is as long as a window.
[[nodiscard]] Measured deflections_from_accelerations(const Measured& accelerations,
                                                      double block_s);

}  // namespace dampline::app::wavelet
