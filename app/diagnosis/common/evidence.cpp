// SPDX-License-Identifier: MIT
#include "app/diagnosis/common/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::app {

namespace {

constexpr double kBinReach = 3.0;  // of the rms
constexpr std::size_t kPlaces = 31;
constexpr std::size_t kTimeBins = 60;
constexpr std::size_t kExcerpt = 2000;    // rows
constexpr double kExcerptS = 12.0;        // at most
constexpr double kExcerptPeriods = 15.0;  // of the motion
constexpr double kHalvesS = 2.0;          // stretches that go to either half in turn
constexpr double kFewestHalves = 40.0;

double excerpt_s(const EvidenceScale& scale) {
  const double period_s = 2.0 * std::numbers::pi * scale.deflection_m / scale.velocity_mps;
  return std::min({kExcerptS, kExcerptPeriods * period_s, scale.duration_s});
}

std::size_t excerpt_stride(const EvidenceScale& scale) {
  const double rows = excerpt_s(scale) * scale.rate_hz;
  return std::max<std::size_t>(1, static_cast<std::size_t>(rows / kExcerpt));
}

}  // namespace

EvidenceMeter::EvidenceMeter(const EvidenceScale& s)
    : scale_{s},
      deflection_{"deflection_m", -kBinReach * s.deflection_m, kBinReach * s.deflection_m, kPlaces},
      velocity_{"velocity_mps", -kBinReach * s.velocity_mps, kBinReach * s.velocity_mps, kPlaces},
      time_{"time_s", 0.0, s.duration_s, kTimeBins},
      spectrum_{s.rate_hz},
      maps_{s.deflection_m, s.velocity_mps, s.noise_m,
            std::min(kHalvesS, s.duration_s / kFewestHalves)},
      stride_{excerpt_stride(s)},
      excerpt_s_{excerpt_s(s)} {}

void EvidenceMeter::add(const EvidencePoint& point) {
  deflection_.add(point.deflection_m, point);
  velocity_.add(point.velocity_mps, point);
  time_.add(point.time_s, point);
  spectrum_.add(point);
  maps_.add(point);
  energy_ += point.after_n() * point.after_n();
  ++points_;
  keep(point);
}

/// Stretches of the excerpt's length, one after the other; the one with the most motion stays.
void EvidenceMeter::keep(const EvidencePoint& p) {
  if (seen_++ % stride_ != 0) return;
  current_.push_back(static_cast<const LoopRow&>(p));
  current_energy_ += p.deflection_m * p.deflection_m;
  const bool full =
      current_.size() == kExcerpt || current_.back().time_s - current_.front().time_s > excerpt_s_;
  if (!full) return;
  if (current_energy_ > best_energy_) {
    best_.swap(current_);
    best_energy_ = current_energy_;
  }
  current_.clear();
  current_energy_ = 0.0;
}

void EvidenceMeter::gap() {
  spectrum_.gap();
  maps_.gap();
  current_.clear();
  current_energy_ = 0.0;
}

void EvidenceMeter::fill(Evidence& out) const {
  const auto append = [&out](const std::vector<ResidualRow>& rows) {
    out.residual.insert(out.residual.end(), rows.begin(), rows.end());
  };
  append(deflection_.rows());
  append(velocity_.rows());
  append(spectrum_.rows());
  append(time_.rows());
  out.loops = best_.empty() ? current_ : best_;
}

Signature EvidenceMeter::signature() const {
  Signature out;
  if (points_ == 0) return out;
  out.rms_n = std::sqrt(energy_ / static_cast<double>(points_));
  spectrum_.describe(out);
  maps_.describe(out);
  const std::vector<ResidualRow> times = time_.rows();
  if (times.empty()) return out;
  std::vector<double> rms;
  rms.reserve(times.size());
  for (const ResidualRow& r : times) rms.push_back(r.after_rms_n);
  const auto worst = std::max_element(rms.begin(), rms.end());
  out.worst_time_s = times[static_cast<std::size_t>(worst - rms.begin())].place;
  const double largest = *worst;
  const auto middle = rms.begin() + static_cast<std::ptrdiff_t>(rms.size() / 2);
  std::nth_element(rms.begin(), middle, rms.end());
  if (*middle > 0.0) out.worst_share = largest * largest / (*middle * *middle);
  return out;
}

}  // namespace dampline::app
