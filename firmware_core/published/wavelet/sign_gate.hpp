// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace dampline {

/// When a gate lets a row through.
struct GateConfig {
  double least_speed_mps{0.0};  ///< slower than this counts as at rest
  double least_of_rms{0.02};    ///< so does slower than this share of the running rms speed
};

/// Watches deflections for stretches without reversal or stick: a row is usable when each watched
/// deflection moved one way, faster than the limit, during every step that its stencil touches and
/// one more on each side, so that no kink can lie within. With `WatchSign` its own sign must not
/// change either. The speed of a step is its increment over its length: unlike a derivative from a
/// stencil it is not blurred by a reversal nearby, and needs no samples from beyond the stencil.
///
/// Constant time: one run length per deflection.
template <int Count, bool WatchSign>
class SignGate {
 public:
  static constexpr std::size_t kCount = static_cast<std::size_t>(Count);
  using Values = std::array<double, kCount>;

  SignGate(const GateConfig& config, double step_s) noexcept : config_{config}, step_s_{step_s} {}

  void push(const Values& deflection_m) noexcept {
    if (!has_last_) {
      last_m_ = deflection_m;
      has_last_ = true;
      return;
    }
    ++steps_;
    for (std::size_t i = 0; i < kCount; ++i) update(i, deflection_m[i]);
    last_m_ = deflection_m;
  }

  /// Steps since a watched deflection last reversed, stood still or changed its sign.
  [[nodiscard]] std::size_t clear_steps() const noexcept {
    std::size_t least = run_[0];
    for (const std::size_t run : run_) least = run < least ? run : least;
    return least;
  }

  /// After a gap. The running rms is kept.
  void restart() noexcept {
    has_last_ = false;
    run_.fill(0);
  }

 private:
  void update(std::size_t i, double deflection_m) noexcept {
    const double speed_mps = (deflection_m - last_m_[i]) / step_s_;
    sum_squares_[i] += speed_mps * speed_mps;
    const double rms_mps = std::sqrt(sum_squares_[i] / static_cast<double>(steps_));
    const bool moves = std::abs(speed_mps) > config_.least_speed_mps &&
                       std::abs(speed_mps) > config_.least_of_rms * rms_mps;
    const bool forward = speed_mps > 0.0;
    const bool same_way = forward == forward_[i];
    const bool same_side = !WatchSign || deflection_m * last_m_[i] > 0.0;
    // A reversal: the step itself goes the new way and is the first of the next stretch.
    run_[i] = !(moves && same_side) ? 0 : (same_way ? run_[i] + 1 : 1);
    forward_[i] = forward;
  }

  GateConfig config_;
  double step_s_;
  Values last_m_{};
  Values sum_squares_{};
  std::array<bool, kCount> forward_{};
  std::array<std::size_t, kCount> run_{};
  std::size_t steps_{0};
  bool has_last_{false};
};

/// For smooth models: everything passes.
template <bool WatchSign>
class SignGate<0, WatchSign> {
 public:
  using Values = std::array<double, 0>;
  SignGate(const GateConfig& /*config*/, double /*step_s*/) noexcept {}
  void push(const Values& /*deflection_m*/) noexcept {}
  void restart() noexcept {}
};

}  // namespace dampline
