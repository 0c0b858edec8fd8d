// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dampline/sample.hpp"

namespace dampline::app {

/// Samples of a record that make one of the identification's, whose rate is at most 400 Hz.
[[nodiscard]] int thinning(double rate_hz);

/// Lowers the rate of samples by a whole factor, without aliases and without delay: a symmetric
/// low pass (Kaiser's window, 60 dB), flat up to 0.38 and closed from 0.5 of the lower rate, then
/// every factor-th sample. Samples that are missing leave out what they would have been part of.
class Thinner {
 public:
  explicit Thinner(int factor);
  /// Takes the record's next sample; true where `out` is the next of the lower rate.
  [[nodiscard]] bool take(const Sample& in, Sample& out);
  [[nodiscard]] int factor() const noexcept { return factor_; }

 private:
  static constexpr int kReach = 16;  // of the filter to either side, in samples of the lower rate
  [[nodiscard]] const Sample& at(std::int64_t tick) const;
  void filter(std::int64_t centre, Sample& out) const;

  int factor_;
  std::int64_t half_;  // of the filter, in samples of the record
  std::vector<double> taps_;
  std::vector<Sample> ring_;
  std::int64_t unbroken_from_{0};
  std::int64_t newest_{-1};
};

}  // namespace dampline::app
