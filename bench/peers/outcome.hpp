// SPDX-License-Identifier: MIT
#pragma once

namespace dampline::bench {

/// Of an estimator on a long run.
struct Outcome {
  double nan_after_s{-1.0};  ///< of the run, the first look without a number; negative: never
  double error_before{0.0};  ///< after the first five minutes
  double error_after{0.0};   ///< at the end
};

}  // namespace dampline::bench
