// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "published/wavelet/daubechies.hpp"

namespace dampline {

/// The latest `Size` values. back(0) is the newest.
template <class T, std::size_t Size>
class RecentValues {
 public:
  void push(const T& value) noexcept {
    newest_ = newest_ + 1 == Size ? 0 : newest_ + 1;
    values_[newest_] = value;
    if (count_ < Size) ++count_;
  }
  [[nodiscard]] const T& back(std::size_t age) const noexcept {
    return values_[newest_ >= age ? newest_ - age : newest_ + Size - age];
  }
  [[nodiscard]] bool full() const noexcept { return count_ == Size; }
  void clear() noexcept { count_ = 0; }

 private:
  std::array<T, Size> values_{};
  std::size_t newest_{0};
  std::size_t count_{0};
};

/// Rate of change at the sample `age` steps ago: 1/D sum_k Gamma1_k (s_(+k) - s_(-k)).
/// Needs kReach samples on each side. kReach multiplications.
template <class Wavelet, std::size_t Size>
[[nodiscard]] double first_derivative(const RecentValues<double, Size>& samples, std::size_t age,
                                      double step) noexcept {
  double sum = 0.0;
  for (std::size_t k = Wavelet::kReach; k > 0; --k) {
    sum += Wavelet::kFirst[k] * (samples.back(age - k) - samples.back(age + k));
  }
  return sum / step;
}

/// Second derivative at the sample `age` steps ago. The constant part drops out before anything is
/// multiplied: 1/D^2 sum_k Gamma2_k (s_(+k) - 2 s_0 + s_(-k)), since the coefficients sum to zero.
template <class Wavelet, std::size_t Size>
[[nodiscard]] double second_derivative(const RecentValues<double, Size>& samples, std::size_t age,
                                       double step) noexcept {
  const double centre = samples.back(age);
  double sum = 0.0;
  for (std::size_t k = Wavelet::kReach; k > 0; --k) {
    sum +=
        Wavelet::kSecond[k] * ((samples.back(age - k) - centre) + (samples.back(age + k) - centre));
  }
  return sum / (step * step);
}

}  // namespace dampline
