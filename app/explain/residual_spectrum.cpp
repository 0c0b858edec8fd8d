// SPDX-License-Identifier: MIT
#include "app/explain/residual_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::app {
namespace {

constexpr std::uint64_t kFewestCoherent = 4;
constexpr double kBandRatio = 1.2599210498948732;  // a third of an octave
constexpr double kEdge = 0.1;                      // of the energy on either side of the band

/// Hann's window, its squares summing to 1.
double window(std::size_t n, std::size_t size) {
  const double phase = 2.0 * std::numbers::pi * (static_cast<double>(n) + 0.5);
  return (0.5 - 0.5 * std::cos(phase / static_cast<double>(size))) /
         std::sqrt(0.375 * static_cast<double>(size));
}

}  // namespace

void ResidualSpectrum::add(const EvidencePoint& point) {
  held_[0][fill_] = point.before_n();
  held_[1][fill_] = point.after_n();
  for (std::size_t c = 0; c < kEvidenceChannels; ++c) held_[2 + c][fill_] = point.channel[c];
  if (++fill_ < kSize) return;
  transform();
  for (auto& signal : held_) std::copy(signal.begin() + kSize / 2, signal.end(), signal.begin());
  fill_ = kSize / 2;
}

/// Two real signals by one complex transform.
void ResidualSpectrum::two(std::size_t first, Spectra& out) {
  for (std::size_t n = 0; n < kSize; ++n)
    fourier_.set(n, window(n, kSize) * std::complex<double>{held_[first][n], held_[first + 1][n]});
  fourier_.start();
  fourier_.advance(Fourier512::kButterflies);
  for (std::size_t k = 1; k < kBins; ++k) {
    const std::complex<double> a = fourier_[k];
    const std::complex<double> b = std::conj(fourier_[kSize - k]);
    out[first][k] = 0.5 * (a + b);
    if (first + 1 < kSignals) out[first + 1][k] = std::complex<double>{0.0, -0.5} * (a - b);
  }
}

void ResidualSpectrum::transform() {
  Spectra spectra{};
  for (std::size_t s = 0; s < kSignals; s += 2) two(s, spectra);
  for (std::size_t k = 1; k < kBins; ++k) {
    for (std::size_t s = 0; s < kSignals; ++s) power_[s][k] += std::norm(spectra[s][k]);
    for (std::size_t c = 0; c < kEvidenceChannels; ++c)
      cross_[c][k] += spectra[1][k] * std::conj(spectra[2 + c][k]);
  }
  ++segments_;
}

std::vector<ResidualRow> ResidualSpectrum::rows() const {
  std::vector<ResidualRow> out;
  if (segments_ < kFewestCoherent) return out;
  const auto scale = 2.0 / (static_cast<double>(kSize) * static_cast<double>(segments_));
  for (double low = 0.5 * bin_hz(); low < 0.5 * rate_hz_;) {
    const double high = std::max(low * kBandRatio, low + bin_hz());
    ResidualRow row;
    row.over = "frequency_hz";
    row.place = std::sqrt(low * high);
    row.samples = segments_;
    for (std::size_t k = 1; k < kBins; ++k) {
      const double hz = static_cast<double>(k) * bin_hz();
      if (hz < low || hz >= high) continue;
      row.before_rms_n += scale * power_[0][k];
      row.after_rms_n += scale * power_[1][k];
    }
    row.before_rms_n = std::sqrt(row.before_rms_n);
    row.after_rms_n = std::sqrt(row.after_rms_n);
    out.push_back(row);
    low = high;
  }
  return out;
}

void ResidualSpectrum::describe(Signature& out) const {
  if (segments_ < kFewestCoherent) return;
  double all = 0.0;
  for (const double p : power_[1]) all += p;
  if (!(all > 0.0)) return;
  double sum = 0.0;
  double largest = 0.0;
  for (std::size_t k = 1; k < kBins; ++k) {
    const double hz = static_cast<double>(k) * bin_hz();
    const double p = power_[1][k];
    if (sum < kEdge * all) out.low_hz = hz;
    if (sum < (1.0 - kEdge) * all) out.high_hz = hz;
    sum += p;
    if (p > largest) {
      largest = p;
      out.peak_hz = hz;
    }
    // What chance gives, one part in as many segments as are independent, is taken off.
    const double chance = 1.0 / static_cast<double>(segments_);
    for (std::size_t c = 0; c < kEvidenceChannels; ++c) {
      const double both = p * power_[2 + c][k];
      if (!(both > 0.0)) continue;
      const double coherence = std::norm(cross_[c][k]) / both;
      out.coherence[c] += std::max(coherence - chance, 0.0) / (1.0 - chance) * p / all;
    }
  }
}

}  // namespace dampline::app
