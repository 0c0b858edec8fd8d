// SPDX-License-Identifier: MIT
#include "app/law/free_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::app::law {
namespace {

constexpr double kLongestStep = 0.08;  // radians of the fastest oscillation
constexpr double kSeen = 1.5;          // radians of it in a sample: a fourth of a turn
constexpr int kMostSteps = 32;
constexpr Eigen::Index kTaps = 48;  // samples on either side, from which a force between is made
constexpr double kWindow = 20.0;    // Kaiser's beta
constexpr int kMostEvents = 40;     // between two samples
constexpr int kSecants = 30;
constexpr double kWithin = 1e-13;  // of the greatest speed or force about an event
constexpr double kFaded = 40.0;    // exponent beyond which nothing is left

double faded(double x) noexcept { return x < kFaded ? std::exp(-x) : 0.0; }

/// Without its sign; `per_speed`: 1 / b.
double level_of(Kind kind, double per_speed, double x, double v) noexcept {
  const double speeds = std::abs(v) * per_speed;
  switch (kind) {
    case Kind::kFading:
      return faded(speeds);
    case Kind::kFadingSquare:
      return faded(speeds * speeds);
    case Kind::kFadingSlowly:
      return 1.0 / (1.0 + speeds * speeds);
    case Kind::kProgressive:
      return x;
    case Kind::kProgressiveAbsolute:
      return std::abs(x);
    default:
      return 1.0;
  }
}

bool is_inertia(Kind kind) { return kind == Kind::kInertia || kind == Kind::kAcceleration; }

bool remembers(const Term& t) { return !t.sharp && t.column.kind >= Kind::kBoucWen; }

/// Where a column's like stands: the same travel, and of what has a rate the same kind and shape.
std::size_t place_of(const std::vector<Regressor>& memories, const Regressor& c) {
  const auto like = [&](const Regressor& other) {
    if (other.a != c.a || has_rate(other.kind) != has_rate(c.kind)) return false;
    return !has_rate(c.kind) || (other.kind == c.kind && other.b == c.b);
  };
  return static_cast<std::size_t>(std::find_if(memories.begin(), memories.end(), like) -
                                  memories.begin());
}

/// The greatest stiffness of a term within `reach_m`, N/m.
double stiffness_of(const Term& t, double reach_m) {
  const double c = std::abs(t.coefficient);
  switch (t.column.kind) {
    case Kind::kDeflection:
    case Kind::kMagnitude:
    case Kind::kBumpUp:
    case Kind::kBumpDown:
    case Kind::kProgressive:
    case Kind::kProgressiveAbsolute:
      return c;
    case Kind::kSquare:
      return 2.0 * c * reach_m;
    case Kind::kCube:
      return 3.0 * c * reach_m * reach_m;
    case Kind::kBoucWen:
    case Kind::kMaxwell:
      return c;
    default:
      return has_stop(t.column.kind) && !t.sharp ? 4.0 * c / t.column.a : 0.0;
  }
}

/// Of the fastest oscillation or decay, in a sample.
double radians_of(const Law& law, double interval_s) {
  double most = 0.0;
  for (const Term& t : law.terms) {
    most += stiffness_of(t, 0.0) / law.mass_kg;
    if (t.column.kind == Kind::kSign && !t.sharp)
      most += std::pow(std::abs(t.coefficient) / (t.column.a * law.mass_kg), 2);
    if (t.column.kind == Kind::kVelocity) most += std::pow(t.coefficient / law.mass_kg, 2);
    if (t.column.kind == Kind::kMaxwell) most += std::pow(t.column.a, -2);
  }
  return std::sqrt(most) * interval_s;
}

int steps_for(const Law& law, double interval_s) {
  const double steps = std::ceil(radians_of(law, interval_s) / kLongestStep);
  return static_cast<int>(std::clamp(steps, 1.0, static_cast<double>(kMostSteps)));
}

/// What a Kaiser window leaves of a sinc at `x` samples.
double windowed_sinc(double x) {
  const double share = x / kTaps;
  if (std::abs(share) >= 1.0) return 0.0;
  const double window = std::cyl_bessel_i(0.0, kWindow * std::sqrt(1.0 - share * share)) /
                        std::cyl_bessel_i(0.0, kWindow);
  const double angle = std::numbers::pi * x;
  return x == 0.0 ? window : window * std::sin(angle) / angle;
}

/// Times Input::kFine as many samples, band-limited; beyond the ends the force goes on oddly.
Eigen::VectorXd interpolated(const Eigen::VectorXd& f) {
  const Eigen::Index last = f.size() - 1;
  Eigen::VectorXd longer{f.size() + 2 * kTaps};
  for (Eigen::Index i = -kTaps; i <= last + kTaps; ++i) {
    double& there = longer[i + kTaps];
    if (i < 0)
      there = 2.0 * f[0] - f[std::min(-i, last)];
    else
      there = i <= last ? f[i] : 2.0 * f[last] - f[std::max<Eigen::Index>(2 * last - i, 0)];
  }
  Eigen::VectorXd out{Input::kFine * last + 1};
  for (Eigen::Index part = 0; part < Input::kFine; ++part) {
    Eigen::VectorXd weights{2 * kTaps};
    for (Eigen::Index k = 0; k < 2 * kTaps; ++k)
      weights[k] = windowed_sinc(static_cast<double>(part) / Input::kFine -
                                 static_cast<double>(k - kTaps + 1));
    weights /= weights.sum();
    for (Eigen::Index i = 0; i < last; ++i)
      out[Input::kFine * i + part] =
          part == 0 ? f[i] : weights.dot(longer.segment(i + 1, 2 * kTaps));
  }
  out[Input::kFine * last] = f[last];
  return out;
}

}  // namespace

Input::Input(const Eigen::VectorXd& force_n, double interval_s)
    : size_{force_n.size()}, fine_n_{interpolated(force_n)}, interval_s_{interval_s} {
  const Eigen::Index last = fine_n_.size() - 1;
  const auto& f = fine_n_;
  step_n_.resize(f.size());
  for (Eigen::Index i = 0; i <= last; ++i) {
    if (i >= 2 && i + 2 <= last)
      step_n_[i] = (8.0 * (f[i + 1] - f[i - 1]) - (f[i + 2] - f[i - 2])) / 12.0;
    else
      step_n_[i] = f[std::min(i + 1, last)] - f[std::max<Eigen::Index>(i - 1, 0)];
  }
}

double Input::at(Eigen::Index i, double share) const noexcept {
  const double place = kFine * share;
  const auto part = std::min(static_cast<Eigen::Index>(place), kFine - 1);
  const Eigen::Index k = kFine * i + part;
  const double u = place - static_cast<double>(part);
  const double w = 1.0 - u;
  const double rise = fine_n_[k + 1] - fine_n_[k];
  return w * fine_n_[k] + u * fine_n_[k + 1] +
         u * w * (w * (step_n_[k] - rise) - u * (step_n_[k + 1] - rise));
}

std::vector<Regressor> memories_of(const Law& law) {
  std::vector<Regressor> out;
  for (const Term& t : law.terms)
    if (remembers(t) && place_of(out, t.column) == out.size()) out.push_back(t.column);
  return out;
}

bool FreeRun::can(const Law& law) noexcept {
  return law.mass_kg > 0.0 && memories_of(law).size() <= kMostMemories &&
         std::all_of(law.terms.begin(), law.terms.end(), [](const Term& t) {
           return t.column.time == Regressor::Time::kSteady && t.column.kind != Kind::kAttached &&
                  !is_inertia(t.column.kind);
         });
}

bool FreeRun::is_seen(const Law& law, double interval_s) noexcept {
  return radians_of(law, interval_s) < kSeen;
}

FreeRun::FreeRun(const Law& law, const Input& input, int refinement)
    : law_{law},
      input_{input},
      per_mass_{1.0 / law.mass_kg},
      memories_{memories_of(law)},
      steps_{refinement * steps_for(law, input.interval_s())} {
  for (std::size_t i = 0; i < law.terms.size(); ++i) {
    const Term& t = law.terms[i];
    memory_of_.push_back(place_of(memories_, t.column));
    if (t.sharp && t.column.kind == Kind::kSign)
      held_n_ += t.coefficient;
    else if (t.sharp)
      sharp_.push_back({t.column.kind, t.coefficient, 1.0 / t.column.b});
    else if (t.column.kind == Kind::kOne)
      constant_n_ += t.coefficient;
    else if (t.column.kind == Kind::kDeflection)
      spring_npm_ += t.coefficient;
    else if (t.column.kind == Kind::kVelocity)
      damper_nspm_ += t.coefficient;
    else
      smooth_.push_back(i);
    turns_ = turns_ || t.sharp || t.column.kind == Kind::kBoucWen || has_stop(t.column.kind) ||
             t.column.kind == Kind::kSpeed || t.column.kind == Kind::kSpeedSquared;
  }
}

double FreeRun::level(double x, double v) const noexcept {
  double out = held_n_;
  for (const Level& term : sharp_)
    out += term.coefficient * level_of(term.kind, term.per_speed, x, v);
  return out;
}

double FreeRun::smooth_force(double x, double v, const State& state) const noexcept {
  double out = constant_n_ + spring_npm_ * x + damper_nspm_ * v;
  for (const std::size_t i : smooth_) {
    const Term& t = law_.terms[i];
    const std::size_t m = memory_of_[i];
    if (has_rate(t.column.kind))
      out += t.coefficient * state.memory_m[m];
    else if (has_stop(t.column.kind))
      out +=
          t.coefficient * memory_at(t.column, state.memory_m[m] / t.column.a, v, state.slip_m[m]);
    else
      out += t.coefficient * value_at(t.column, x, v);
  }
  return out;
}

double FreeRun::accel(const State& s, double force_n, Mode mode) const noexcept {
  const double friction = static_cast<double>(mode) * level(s.deflection_m, s.velocity_mps);
  return (force_n - smooth_force(s.deflection_m, s.velocity_mps, s) - friction) * per_mass_;
}

FreeRun::Rate FreeRun::rate(const State& s, double force_n, Mode mode) const noexcept {
  Rate out;
  out.x = s.velocity_mps;
  out.v = accel(s, force_n, mode);
  for (std::size_t m = 0; m < memories_.size(); ++m) {
    const Regressor& c = memories_[m];
    const double z = s.memory_m[m];
    if (c.kind == Kind::kMaxwell) out.z[m] = out.x - z / c.a;
    if (c.kind == Kind::kBoucWen)
      out.z[m] = out.x - (std::abs(out.x) * z + c.b * out.x * std::abs(z)) / c.a;
  }
  return out;
}

/// Stops follow the way, and not its rate: exact while the mass does not turn.
void FreeRun::place(const State& from, double dt_s, const Rate& r, State& out) const noexcept {
  out.deflection_m = from.deflection_m + dt_s * r.x;
  out.velocity_mps = from.velocity_mps + dt_s * r.v;
  const double way_m = out.deflection_m - from.deflection_m;
  for (std::size_t m = 0; m < memories_.size(); ++m) {
    if (has_rate(memories_[m].kind)) {
      out.memory_m[m] = from.memory_m[m] + dt_s * r.z[m];
      continue;
    }
    const double a = memories_[m].a;
    out.memory_m[m] = std::clamp(from.memory_m[m] + way_m, -a, a);
    out.slip_m[m] = std::abs(out.memory_m[m]) >= a ? from.slip_m[m] + std::abs(way_m) : 0.0;
  }
}

/// step() of what remembers nothing: two figures in place of all that a state could hold.
State FreeRun::step_without_memory(const State& from, double force_n, double middle_n, double end_n,
                                   double dt_s, Mode mode) const noexcept {
  const auto accel_at = [&](double x, double v, double pull_n) {
    const double friction = static_cast<double>(mode) * level(x, v);
    return (pull_n - smooth_force(x, v, from) - friction) * per_mass_;
  };
  const double x = from.deflection_m;
  const double v = from.velocity_mps;
  const double half_s = 0.5 * dt_s;
  const double a1 = accel_at(x, v, force_n);
  const double v2 = v + half_s * a1;
  const double a2 = accel_at(x + half_s * v, v2, middle_n);
  const double v3 = v + half_s * a2;
  const double a3 = accel_at(x + half_s * v2, v3, middle_n);
  const double v4 = v + dt_s * a3;
  const double a4 = accel_at(x + dt_s * v3, v4, end_n);
  State out;
  out.deflection_m = x + dt_s * ((v + 2.0 * (v2 + v3) + v4) / 6.0);
  out.velocity_mps = v + dt_s * ((a1 + 2.0 * (a2 + a3) + a4) / 6.0);
  return out;
}

/// `share` and `length` in samples; `force_n`: at `share`.
State FreeRun::step(const State& from, double force_n, Eigen::Index i, double share, double length,
                    Mode mode) const noexcept {
  const double dt_s = length * input_.interval_s();
  const double middle_n = input_.at(i, share + 0.5 * length);
  if (memories_.empty())
    return step_without_memory(from, force_n, middle_n, input_.at(i, share + length), dt_s, mode);
  State there = from;
  const Rate a = rate(from, force_n, mode);
  place(from, 0.5 * dt_s, a, there);
  const Rate b = rate(there, middle_n, mode);
  place(from, 0.5 * dt_s, b, there);
  const Rate c = rate(there, middle_n, mode);
  place(from, dt_s, c, there);
  const Rate d = rate(there, input_.at(i, share + length), mode);
  Rate mean;
  mean.x = (a.x + 2.0 * (b.x + c.x) + d.x) / 6.0;
  mean.v = (a.v + 2.0 * (b.v + c.v) + d.v) / 6.0;
  for (std::size_t m = 0; m < memories_.size(); ++m)
    if (has_rate(memories_[m].kind)) mean.z[m] = (a.z[m] + 2.0 * (b.z[m] + c.z[m]) + d.z[m]) / 6.0;
  place(from, dt_s, mean, there);
  return there;
}

FreeRun::Mode FreeRun::mode_of(const State& s, double force_n) const noexcept {
  if (s.velocity_mps != 0.0) return s.velocity_mps > 0.0 ? Mode::kForth : Mode::kBack;
  const double pull_n = force_n - smooth_force(s.deflection_m, 0.0, s);
  if (std::abs(pull_n) <= level(s.deflection_m, 0.0)) return Mode::kStuck;
  return pull_n > 0.0 ? Mode::kForth : Mode::kBack;
}

/// The length after which the velocity is 0; `at`: the state there, at exactly 0.
double FreeRun::until_turned(const State& from, double force_n, Eigen::Index i, double share,
                             double length, Mode mode, State& at) const noexcept {
  double low = 0.0;
  double high = length;
  double v_low = from.velocity_mps;
  double v_high = at.velocity_mps;
  const double enough = kWithin * std::max(std::abs(v_low), std::abs(v_high));
  double out = length;
  int kept = 0;  // the Illinois rule: an end that stays counts half
  for (int k = 0; k < kSecants; ++k) {
    out = v_low == v_high ? high : (low * v_high - high * v_low) / (v_high - v_low);
    at = step(from, force_n, i, share, out, mode);
    if (std::abs(at.velocity_mps) <= enough || high - low < 1e-14) break;
    const bool above = (at.velocity_mps > 0.0) == (v_high > 0.0);
    (above ? high : low) = out;
    (above ? v_high : v_low) = at.velocity_mps;
    if (above)
      v_low *= kept > 0 ? 0.5 : 1.0;
    else
      v_high *= kept < 0 ? 0.5 : 1.0;
    kept = above ? 1 : -1;
  }
  at.velocity_mps = 0.0;
  return out;
}

/// The length for which the friction holds the mass, at most `length`.
double FreeRun::until_free(const State& stuck, Eigen::Index i, double share,
                           double length) const noexcept {
  const double held_n = level(stuck.deflection_m, 0.0);
  const double rest_n = smooth_force(stuck.deflection_m, 0.0, stuck);
  const auto over = [&](double after) {
    return std::abs(input_.at(i, share + after) - rest_n) - held_n;
  };
  constexpr int kLooks = 4;
  double low = 0.0;
  for (int k = 1; k <= kLooks; ++k) {
    double high = length * k / kLooks;
    if (over(high) <= 0.0) {
      low = high;
      continue;
    }
    for (int n = 0; n < kSecants && high - low > 1e-12; ++n) {
      const double middle = 0.5 * (low + high);
      (over(middle) > 0.0 ? high : low) = middle;
    }
    return high;
  }
  return length;
}

void FreeRun::advance(Eigen::Index i, State& state) const noexcept {
  const double whole = 1.0 / steps_;
  for (int n = 0; n < steps_; ++n) {
    double share = n * whole;
    double left = whole;
    for (int events = 0; left > 1e-12 && events < kMostEvents; ++events) {
      const double force_n = input_.at(i, share);
      const Mode mode = mode_of(state, force_n);
      double length = left;
      if (mode == Mode::kStuck) {
        length = until_free(state, i, share, left);
        const double pull_n =
            input_.at(i, share + length) - smooth_force(state.deflection_m, 0.0, state);
        // Past the end of its hold by rounding: the next step must move.
        if (length < left) state.velocity_mps = std::copysign(1e-300, pull_n);
      } else {
        State there = step(state, force_n, i, share, left, mode);
        const bool turned = turns_ && there.velocity_mps * static_cast<double>(mode) < 0.0;
        if (turned && state.velocity_mps != 0.0 && std::abs(state.velocity_mps) > 1e-300)
          length = until_turned(state, force_n, i, share, left, mode, there);
        state = there;
      }
      share += length;
      left -= length;
    }
  }
}

Course move(const Law& law, const Input& input, State state, int refinement) {
  constexpr double kFarthestM = 1e6;
  const FreeRun run{law, input, refinement};
  const Eigen::Index count = input.size();
  Course out{false, Eigen::VectorXd{count}, Eigen::VectorXd{count}};
  for (Eigen::Index i = 0; i < count; ++i) {
    if (i > 0) run.advance(i - 1, state);
    if (!(std::abs(state.deflection_m) < kFarthestM)) {
      out.deflection_m.conservativeResize(i);
      out.velocity_mps.conservativeResize(i);
      return out;
    }
    out.deflection_m[i] = state.deflection_m;
    out.velocity_mps[i] = state.velocity_mps;
  }
  out.whole = true;
  return out;
}

}  // namespace dampline::app::law
