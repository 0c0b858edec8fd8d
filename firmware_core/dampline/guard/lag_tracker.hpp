// SPDX-License-Identifier: MIT
#pragma once
#include <complex>
#include <cstddef>

#include "dampline/guard/pair_spectra.hpp"

namespace dampline {

/// Follows from block to block by how much the frame lags a reference channel, against the transfer
/// of the blocks before, whose own lags are taken out. Bin by bin, in three passes over a band.
class LagTracker {
 public:
  using Complex = std::complex<double>;
  struct Bin {
    Complex cross{};    ///< conj(reference channel) times frame
    double frame{0.0};  ///< powers
    double channel{0.0};
    [[nodiscard]] double coherence() const noexcept;
  };

  explicit LagTracker(double sample_rate_hz) noexcept : rate_hz_{sample_rate_hz} {}
  void start() noexcept;
  /// First pass: the spectrum of the whitened correlation with the reference.
  [[nodiscard]] Complex whitened(std::size_t k, const Bin& bin) noexcept;
  /// Then: the correlation at whole lags round the lag of the block before.
  template <class Correlation>
  void find_peak(const Correlation& at) noexcept {
    const int expected = expected_samples();
    lag_samples_ = expected;
    for (int lag = expected - kReach; lag <= expected + kReach; ++lag) {
      if (at(lag) > at(lag_samples_)) lag_samples_ = lag;
    }
    if (adopts_) lag_samples_ = 0;
  }
  /// Second pass: the slope of what phase is left.
  void add_phase(std::size_t k, const Bin& bin) noexcept;
  void conclude(double bins_in_band) noexcept;
  /// Third pass: the block joins the reference.
  void learn(std::size_t k, const Bin& bin) noexcept;
  /// Begins anew with the next block.
  void forget() noexcept { has_reference_ = false; }

  [[nodiscard]] bool valid() const noexcept { return valid_; }
  [[nodiscard]] double lag_s() const noexcept { return lag_s_; }

 private:
  static constexpr int kReach = 2;  // samples by which the lag may move in a block
  [[nodiscard]] int expected_samples() const noexcept;
  [[nodiscard]] Complex turned(std::size_t k, double lag_s, const Complex& x) const noexcept;
  [[nodiscard]] double hz(std::size_t k) const noexcept {
    return static_cast<double>(k) * rate_hz_ / static_cast<double>(Fourier512::kSize);
  }

  double rate_hz_;
  SpectrumSums::Cross reference_{};
  bool has_reference_{false};
  bool adopts_{false};  // this block becomes the reference
  bool valid_{false};
  int lag_samples_{0};
  double lag_s_{0.0};
  double coherence_{0.0};
  double phase_{0.0};
  double weight_{0.0};
};

}  // namespace dampline
