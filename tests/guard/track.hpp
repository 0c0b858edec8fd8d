// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "dampline/guard/spectral_guard.hpp"
#include "dampline/motion/butterworth.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {

inline constexpr double kTrackRateHz = 300.0;
inline constexpr int kLater = 24;  // samples by which wheelset 2 is later

inline GuardConfig declared() {
  GuardConfig config;
  config.noise_mps2.fill(0.05);
  return config;
}

/// A track of noise up to 60 Hz that both wheelsets see, and a frame that follows the second one.
class Track {
 public:
  using Values = std::array<double, kChannels>;
  using Change = std::function<void(std::int64_t, Values&)>;

  explicit Track(const GuardConfig& config = declared())
      : guard_{std::make_unique<SpectralGuard>(config)} {
    for (std::size_t c = 0; c < kChannels; ++c) guard_->set_change_scale(c, 0.0);
    guard_->set_difference(1.0);
  }
  double noise{0.02};  ///< of each sensor
  double motion{4.0};  ///< of the track
  Change change{[](std::int64_t, Values&) {}};

  void run(double length_s) {
    for (int i = 0; i < static_cast<int>(length_s * kTrackRateHz); ++i, ++tick_) {
      track_.push_back(motion * filter_.update({random_.normal()})[0]);
      const auto at = [&](std::int64_t n) {
        return n < 0 ? 0.0 : track_[static_cast<std::size_t>(n)];
      };
      const double one = at(tick_);
      const double two = at(tick_ - kLater);
      Values values{0.05 * two, one, two};
      for (double& value : values) value += noise * random_.normal();
      change(tick_, values);
      guard_->push(tick_, values, false);
      guard_->advance(*log_, inputs);
    }
  }
  SpectralGuard& guard() { return *guard_; }
  FaultLog& log() { return *log_; }
  [[nodiscard]] std::span<const Fault> faults() const { return log_->faults(); }
  [[nodiscard]] const Fault* find(FaultKind kind) const {
    for (const Fault& fault : faults())
      if (fault.kind == kind) return &fault;
    return nullptr;
  }
  GuardInputs inputs{};

 private:
  std::unique_ptr<SpectralGuard> guard_;
  std::unique_ptr<FaultLog> log_{std::make_unique<FaultLog>(kTrackRateHz)};
  sim::Random random_{21, sim::Stream::kTrack};
  ButterworthLowPass<1> filter_{60.0, kTrackRateHz};
  std::vector<double> track_;
  std::int64_t tick_{0};
};

/// More noise of one sensor.
inline Track::Change noisy(std::size_t channel, double noise_mps2, double from_s = 0.0,
                           double to_s = 1e9) {
  auto random = std::make_shared<sim::Random>(8, sim::Stream::kSensors);
  return [=](std::int64_t tick, Track::Values& a) {
    const double time_s = static_cast<double>(tick) / kTrackRateHz;
    const double more = noise_mps2 * random->normal();
    if (time_s >= from_s && time_s < to_s) a[channel] += more;
  };
}

inline const Fault* noise_of(Track& track, std::size_t channel, double noise_mps2) {
  track.change = noisy(channel, noise_mps2);
  track.run(120.0);
  return track.find(FaultKind::kExcessNoise);
}

// The noise of one wheelset is what it does not share: it is measured where the track is stronger.
inline constexpr double kStrong = 80.0;

}  // namespace dampline
