// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "app/run/result.hpp"
#include "app/wavelet/equations.hpp"
#include "app/wavelet/measured.hpp"

namespace dampline::app::wavelet {

/// An estimated term.
struct TermEstimate {
  RunTimeTerm term;
  int element{0};
  double value{0.0};
  double std{0.0};  ///< of the value: by the jackknife over blocks, or of the windows' mean
  double cov{0.0};  ///< of the windows' estimates; else std over |value|
};

/// What the rows say about the terms. Errors as in equation 35 of Ghanem and Romeo, of each mass:
/// 100 / (N var a) sum (a - a_model)^2; where the mass is not known, of the force.
struct WaveletFit {
  std::vector<TermEstimate> terms;
  std::vector<double> mse_percent;
  std::vector<double> held_out_mse_percent;
  /// The same of all rows, those across reversals too; empty where none was left out.
  std::vector<double> all_rows_mse_percent;
  Convergence course;   ///< what was known when, names and units empty
  Convergence windows;  ///< the estimate of each window; empty without windows
  std::vector<CovRow> cov;
  std::vector<TermSet> sets;
  std::size_t rows{0};  ///< instants
  std::size_t windows_held{0};
  bool gated{false};
  std::vector<dampline::app::MotionRow> motion;
  std::vector<ForceRow> force;
};

/// The instants whose rows count.
[[nodiscard]] std::size_t count_rows(const Measured& measured, const Question& question);

/// Fits the question's terms. Throws RunError where the rows do not suffice, or do not determine
/// the terms; UsageError for too many terms.
[[nodiscard]] WaveletFit fit_terms(const Measured& measured, const Question& question);

}  // namespace dampline::app::wavelet
