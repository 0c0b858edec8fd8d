// SPDX-License-Identifier: MIT
#include "app/live/floor.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::app {
namespace {

constexpr double kAlike = 0.02;      // of what a law or a sensor's noise may have changed by
constexpr double kFoundAlike = 0.1;  // and of what was found beside it

bool near(double one, double other, double size) noexcept {
  return std::abs(one - other) <= kAlike * size;
}
bool near(double one, double other) noexcept { return near(one, other, std::max(one, other)); }

bool near(const std::array<double, kChannels>& one,
          const std::array<double, kChannels>& other) noexcept {
  return std::equal(one.begin(), one.end(), other.begin(),
                    [](double a, double b) { return near(a, b); });
}

/// Friction that falls with speed is never sure of itself: what it does is in the other numbers.
bool near(const effect::FoundForce& one, const effect::FoundForce& other) noexcept {
  const auto numbers = [](const effect::FoundForce& f) {
    return std::array{f.viscous_up_per_s, f.viscous_down_per_s,
                      f.quadratic_per_m,  f.grows_per_m,
                      f.widens_per_m,     f.square_per_m_s2,
                      f.cube_per_m2_s2,   f.magnitude_per_s2,
                      f.stop_up_per_s2,   f.stop_down_per_s2,
                      f.stop_m,           f.relaxing_per_s2,
                      f.relaxing_s,       f.falls_mps2 > 0.0 ? 1.0 : 0.0};
  };
  const auto a = numbers(one);
  const auto b = numbers(other);
  return std::equal(a.begin(), a.end(), b.begin(), [](double p, double q) {
    return std::abs(p - q) <= kFoundAlike * std::max(std::abs(p), std::abs(q));
  });
}

bool near(const effect::SurrogateConfig& one, const effect::SurrogateConfig& other) noexcept {
  constexpr double kUsualMps = 0.05;  // where a viscous force counts as much as friction
  return near(one.coulomb_mps2, other.coulomb_mps2) &&
         near(one.stiffness_per_s2, other.stiffness_per_s2) &&
         near(one.viscous_per_s, other.viscous_per_s,
              std::max(one.viscous_per_s, one.coulomb_mps2 / kUsualMps)) &&
         one.memory.is_play == other.memory.is_play &&
         near(one.memory.force_mps2, other.memory.force_mps2) &&
         near(one.memory.length_m, other.memory.length_m) && near(one.found, other.found) &&
         near(one.noise_mps2, other.noise_mps2) && near(one.bridged_mps2, other.bridged_mps2);
}

}  // namespace

LiveFloor::LiveFloor(const EstimatorConfig& core)
    : core_{core},
      noise_{core.sample_rate_hz, core.anti_alias},
      most_kept_{static_cast<std::size_t>(kKeptS * core.sample_rate_hz)} {
  kept_.reserve(most_kept_);
}

void LiveFloor::follow() {
  for (Sample sample; ring_.pop(sample);) follow(sample);
}

void LiveFloor::follow(const Sample& sample) {
  noise_.take(sample);
  keep(sample);
  surrogates_->take(sample);
}

std::vector<Sample> LiveFloor::kept() const {
  std::vector<Sample> out{kept_};
  std::rotate(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(oldest_), out.end());
  return out;
}

void LiveFloor::keep(const Sample& sample) {
  if (kept_.size() < most_kept_) return kept_.push_back(sample);
  kept_[oldest_] = sample;
  oldest_ = (oldest_ + 1) % most_kept_;
}

bool LiveFloor::are_alike(const Law& one, const Law& other) noexcept {
  return near(one.declared, other.declared) && near(one.found, other.found);
}

void LiveFloor::begin(const Law& law, const effect::Explanation& explanation) {
  law_ = law;
  any_law_ = true;
  surrogates_->begin(core_, law.declared, explanation);
  for (std::size_t i = 0; i < kept_.size(); ++i)
    surrogates_->take(kept_[(oldest_ + i) % kept_.size()]);
}

bool LiveFloor::hold_against(const effect::GramStore& sums, const GuardedNoise& guarded,
                             effect::Explainer& explainer, Explained& out) {
  const effect::Explanation& e = out.explanation;
  const effect::SurrogateConfig declared =
      surrogate_config(core_, e, noise_of_record(guarded, noise_, core_.screen.step_mps2));
  const Law law{declared, is_physical(declared) ? with_found(declared, e) : declared};
  if (!any_law_ || !are_alike(law, law_)) begin(law, e);
  surrogates_->gather();
  return surrogates_->hold_against(explainer, sums.rows(), out);
}

}  // namespace dampline::app
