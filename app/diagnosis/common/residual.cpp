// SPDX-License-Identifier: MIT
#include "app/diagnosis/common/residual.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dampline::app {

namespace {

std::string kind_of(const Signature& s) {
  if (s.has_memory())
    return fmt::format("depends on the travel since the reversal ({:.0f} % of it)",
                       100.0 * s.travel_share);
  if (!s.memoryless()) return "no function of deflection and velocity, nor of the last reversal";
  const char* symmetry = s.odd_share > Signature::kMostly         ? "odd"
                         : s.odd_share < 1.0 - Signature::kMostly ? "even"
                                                                  : "neither odd nor even";
  return fmt::format("a function of deflection and velocity, {} ({:.0f} % of it)", symmetry,
                     100.0 * s.surface_share);
}

}  // namespace

std::string describe(const Signature& s) {
  return fmt::format("{:.4g} N rms; {}; {:.3g} to {:.3g} Hz", s.rms_n, kind_of(s), s.low_hz,
                     s.high_hz);
}

namespace {

constexpr std::uint64_t kFewestSamples = 20;

}  // namespace

ResidualBins::ResidualBins(std::string over, double low, double high, std::size_t bins)
    : over_{std::move(over)},
      low_{low},
      width_{(high - low) / static_cast<double>(bins)},
      sums_(bins) {}

void ResidualBins::add(double place, const EvidencePoint& point) {
  const double at = std::floor((place - low_) / width_);
  if (!(at >= 0.0 && at < static_cast<double>(sums_.size()))) return;
  Sums& s = sums_[static_cast<std::size_t>(at)];
  const double before = point.before_n();
  const double after = point.after_n();
  ++s.samples;
  s.before += before;
  s.before_squares += before * before;
  s.after += after;
  s.after_squares += after * after;
}

std::vector<ResidualRow> ResidualBins::rows() const {
  std::vector<ResidualRow> out;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& s = sums_[i];
    if (s.samples < kFewestSamples) continue;
    const auto n = static_cast<double>(s.samples);
    out.push_back({over_, low_ + (static_cast<double>(i) + 0.5) * width_, s.samples, s.before / n,
                   std::sqrt(s.before_squares / n), s.after / n, std::sqrt(s.after_squares / n)});
  }
  return out;
}

namespace {

constexpr double kMapReach = 2.5;      // of the motion's size: cells beyond take what lies outside
constexpr double kFirstTravel = 0.05;  // of the size; each further cell half as long again
constexpr double kTravelRatio = 1.5;
constexpr std::size_t kMostWaiting = 2000;

std::size_t cell_of(double x, std::size_t side) {
  const double u = 0.5 * (std::clamp(x / kMapReach, -1.0, 1.0) + 1.0) * static_cast<double>(side);
  return std::min(static_cast<std::size_t>(u), side - 1);
}

/// Share of the energy that each half's cell means explain of the other half.
template <class Map>
double share_of(const Map& map) {
  double energy = 0.0;
  double left = 0.0;
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t c = 0; c < map[half].size(); ++c) {
      const auto& here = map[half][c];
      const auto& other = map[1 - half][c];
      const double mean = other.count > 0.0 ? other.sum / other.count : 0.0;
      energy += here.squares;
      left += here.squares - 2.0 * mean * here.sum + here.count * mean * mean;
    }
  }
  return energy > 0.0 ? std::max(1.0 - left / energy, 0.0) : 0.0;
}

}  // namespace

std::size_t ResidualMaps::surface_cell(const EvidencePoint& point) const {
  return kSide * cell_of(point.deflection_m / deflection_m_, kSide) +
         cell_of(point.velocity_mps / velocity_mps_, kSide);
}

/// Gives the waiting points to the present direction.
void ResidualMaps::settle() {
  for (const Waiting& w : waiting_) {
    const double travel = std::abs(w.deflection_m - turned_m_) / (kFirstTravel * deflection_m_);
    const double steps = travel > 1.0 ? 1.0 + std::log(travel) / std::log(kTravelRatio) : 0.0;
    const auto cell = std::min(static_cast<std::size_t>(steps), kTravels - 1);
    travel_[w.half][cell + (up_ ? kTravels : 0)].absorb(w.left_n);
  }
  waiting_.clear();
}

void ResidualMaps::add(const EvidencePoint& point) {
  const double y = point.deflection_m;
  if (!moving_) {
    moving_ = true;
    extreme_m_ = turned_m_ = y;
  }
  const auto half = static_cast<std::size_t>(std::fmod(std::floor(point.time_s / half_s_), 2.0));
  surface_[half][surface_cell(point)].absorb(point.after_n());
  waiting_.push_back({y, point.after_n(), half});
  if (up_ ? y > extreme_m_ : y < extreme_m_) {
    extreme_m_ = y;
    settle();
  } else if (std::abs(y - extreme_m_) > turn_m_) {
    turned_m_ = extreme_m_;
    extreme_m_ = y;
    up_ = !up_;
    settle();
  } else if (waiting_.size() >= kMostWaiting) {
    settle();
  }
}

void ResidualMaps::describe(Signature& out) const {
  out.surface_share = share_of(surface_);
  out.travel_share = share_of(travel_);
  double odd = 0.0;
  double even = 0.0;
  for (std::size_t c = 0; c < surface_[0].size(); ++c) {
    const std::size_t m = surface_[0].size() - 1 - c;
    const double n = surface_[0][c].count + surface_[1][c].count;
    const double opposite_n = surface_[0][m].count + surface_[1][m].count;
    if (n == 0.0 || opposite_n == 0.0) continue;
    const double here = (surface_[0][c].sum + surface_[1][c].sum) / n;
    const double opposite = (surface_[0][m].sum + surface_[1][m].sum) / opposite_n;
    odd += n * (here - opposite) * (here - opposite);
    even += n * (here + opposite) * (here + opposite);
  }
  if (odd + even > 0.0) out.odd_share = odd / (odd + even);
}

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
