// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "app/explain/evidence_point.hpp"
#include "app/explain/signature.hpp"
#include "app/run/result.hpp"
#include "dampline/numeric/fourier.hpp"

namespace dampline::app {

/// Spectra of what two models leave, and the coherence of the rest with the channels: segments of
/// 512 points with a Hann window, half overlapping (Welch 1967).
class ResidualSpectrum {
 public:
  explicit ResidualSpectrum(double rate_hz) : rate_hz_{rate_hz} {}
  void add(const EvidencePoint& point);
  /// The next point does not follow the last one.
  void gap() { fill_ = 0; }
  /// The rms in bands of a third of an octave.
  [[nodiscard]] std::vector<ResidualRow> rows() const;
  void describe(Signature& out) const;

 private:
  static constexpr std::size_t kSize = Fourier512::kSize;
  static constexpr std::size_t kBins = kSize / 2;
  /// Before, after, channels.
  static constexpr std::size_t kSignals = 2 + kEvidenceChannels;
  using Spectra = std::array<std::array<std::complex<double>, kBins>, kSignals>;

  void transform();
  void two(std::size_t first, Spectra& out);
  [[nodiscard]] double bin_hz() const { return rate_hz_ / static_cast<double>(kSize); }

  double rate_hz_;
  std::size_t fill_{0};
  std::array<std::array<double, kSize>, kSignals + 1> held_{};
  Fourier512 fourier_;
  std::uint64_t segments_{0};
  std::array<std::array<double, kBins>, kSignals> power_{};  // N^2 or channel units squared per bin
  std::array<std::array<std::complex<double>, kBins>, kEvidenceChannels> cross_{};
};

}  // namespace dampline::app
