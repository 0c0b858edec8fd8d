// SPDX-License-Identifier: MIT
#include "dampline/effect/parameters.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "dampline/effect/laws.hpp"

namespace dampline::effect {
namespace {

constexpr double kFarthest = 1.5;  // steps of a grid that a derivative reaches
/// Where the force of a gap that is taken up has risen to a half, of the law's whole gap: the ramp
/// itself is nobody's.
constexpr double kHalfForce = 1.0 - 0.5 * kEngagedOver;

constexpr double kEndShare = 0.25;  // of how far an end yields: what the gap's end is out by

/// What the scatter of the entries does not show, of the value: errors that the motion's own error
/// and the shape of a law near its kinks leave alike in every record. Of friction, spring, the
/// law's size, and its length, speed or frequency. A pitch's law is one of short steps, and a lower
/// frequency with more slip leaves alike.
struct LawErrors {
  double coulomb, stiffness, size, place;
};
constexpr LawErrors kPlainErrors{0.0025, 0.003, 0.0, 0.0};
constexpr LawErrors kViscousErrors{0.012, 0.0, 0.05, 0.0};
constexpr LawErrors kQuadraticErrors{0.005, 0.0, 0.015, 0.0};
constexpr LawErrors kViscoelasticErrors{0.009, 0.004, 0.07, 0.09};
constexpr LawErrors kStribeckErrors{0.025, 0.0, 0.35, 0.35};
constexpr LawErrors kProgressiveErrors{0.0, 0.0, 0.03, 0.0};
constexpr LawErrors kPreslidingErrors{0.002, 0.005, 0.008, 0.006};
constexpr LawErrors kBacklashErrors{0.02, 0.006, 0.025, 0.012};
constexpr LawErrors kStopErrors{0.002, 0.005, 0.17, 0.045};
constexpr LawErrors kBentErrors{0.0, 0.007, 0.05, 0.0};
constexpr LawErrors kKinkedErrors{0.0, 0.03, 0.15, 0.0};
constexpr LawErrors kPitchErrors{0.012, 0.01, 0.0, 0.04};
constexpr LawErrors kFlexibleErrors{0.002, 0.003, 0.012, 0.001};
constexpr LawErrors kLateErrors{0.0, 0.0, 0.02, 0.0};

LawErrors errors_of(const Candidate& c) noexcept {
  switch (c.effect) {
    case Effect::kViscous:
    case Effect::kAsymmetricViscous:
      return kViscousErrors;
    case Effect::kQuadraticDamping:
      return kQuadraticErrors;
    case Effect::kViscoelastic:
      return kViscoelasticErrors;
    case Effect::kStribeck:
      return kStribeckErrors;
    case Effect::kProgressiveFriction:
      return kProgressiveErrors;
    case Effect::kPreslidingHysteresis:
      return kPreslidingErrors;
    case Effect::kBacklash:
      return kBacklashErrors;
    case Effect::kBumpStop:
      return kStopErrors;
    case Effect::kCubicStiffness:
    case Effect::kQuadraticStiffness:
      return kBentErrors;
    case Effect::kAsymmetricStiffness:
      return kKinkedErrors;
    case Effect::kUnmodelledMode:
      return c.form == kPitchForm ? kPitchErrors : kFlexibleErrors;
    case Effect::kTimeSkew:
      return kLateErrors;
    default:
      return {};
  }
}

/// Of friction and spring beside every effect of a model.
LawErrors errors_beside(const Model& model) noexcept {
  LawErrors out = kPlainErrors;
  for (std::size_t i = 0; i < model.count; ++i) {
    const LawErrors one = errors_of(model.effect[i]);
    out.coulomb = std::hypot(out.coulomb, one.coulomb);
    out.stiffness = std::hypot(out.stiffness, one.stiffness);
  }
  return out;
}

/// Friction holds a truck beside its middle for seconds at a time, and the deflection lacks what is
/// so slow: this share of its power for each time that friction is the spring's rms force. A law
/// that bends over the deflection shows the missing part in friction or spring.
constexpr double kHeldShare = 0.04;
constexpr double kMostHeld = 0.3;  // of friction or spring
constexpr double kOfSpring = 0.2;  // of that share, where friction follows the deflection

/// What friction and spring come out too high by, of themselves; as much may be left of it.
struct HeldErrors {
  double coulomb{0.0}, stiffness{0.0};
};
Estimate without(double held, const Estimate& e) noexcept {
  return {(1.0 - held) * e.value, std::hypot(e.std, held * e.value)};
}

/// `friction`, `stiffness`: of one unit of mass.
HeldErrors held_errors(const Detail& d, double friction, double stiffness) noexcept {
  const double y_m = d.deflection_rms_m;
  if (!(y_m > 0.0 && friction > 0.0 && stiffness > 0.0)) return {};
  const double lost = kHeldShare * friction / (stiffness * y_m);
  HeldErrors out;
  for (std::size_t i = 0; i < d.model.count; ++i) {
    const Candidate& c = d.model.effect[i];
    const int term = ModelFit::first_of(d.model, i);
    if (c.effect == Effect::kProgressiveFriction && c.form == kAbsoluteForm) {
      out.coulomb = lost * y_m * d.fit.theta[term] / friction;
      out.stiffness = -kOfSpring * lost;
    }
    if (c.effect == Effect::kCubicStiffness)
      out.stiffness = 3.0 * lost * y_m * y_m * d.fit.theta[term] / stiffness;
  }
  out.coulomb = std::clamp(out.coulomb, -kMostHeld, kMostHeld);
  out.stiffness = std::clamp(out.stiffness, -kMostHeld, kMostHeld);
  return out;
}

/// One effect of a model, and where its unknowns begin.
struct Part {
  const ModelFit& fit;
  const Candidate& candidate;
  const Grids& grids;
  int term{0};
  Uncertain own{};  // what multiplies every coefficient

  [[nodiscard]] LawErrors errors() const noexcept { return errors_of(candidate); }
  [[nodiscard]] Uncertain coefficient(int i = 0) const noexcept {
    return Uncertain::of(fit, term + i);
  }
  [[nodiscard]] std::size_t laws() const noexcept { return candidate.count - candidate.slopes; }
  /// All coefficients of a pair, or the only one.
  [[nodiscard]] Uncertain sum() const noexcept {
    return laws() > 1 ? coefficient(0) + coefficient(1) : coefficient(0);
  }
  /// Steps from its point of the grid, along derivative `i`.
  [[nodiscard]] Uncertain moved(std::size_t i) const noexcept {
    Uncertain out;
    if (is_pair(candidate)) {
      out = coefficient(1) / sum();
    } else if (i < candidate.slopes) {
      out = coefficient(1 + static_cast<int>(i)) / coefficient(0);
      out.value = std::clamp(out.value, -kFarthest, kFarthest);
    }
    return out;
  }
};

/// `moved` steps from a value, by its logarithm.
Uncertain by_steps(double value, double step, const Uncertain& moved) noexcept {
  value *= std::exp(step * moved.value);
  return {value, value * step * moved.slope};
}
/// The same from point i of lines of so many points; `at` gives a point's value.
template <class At>
Uncertain in_line(const At& at, std::size_t i, std::size_t line, const Uncertain& moved) noexcept {
  const std::size_t first = i / line * line;
  const std::size_t below = moved.value >= 0.0 || i == first ? i : i - 1;
  const std::size_t low = std::min(below, first + line - 2);
  return by_steps(at(i), std::log(at(low + 1) / at(low)), moved);
}
/// The same from point i of a grid.
template <std::size_t N>
Uncertain on_grid(const std::array<double, N>& grid, std::size_t i, const Uncertain& moved,
                  double unit) noexcept {
  return in_line([&](std::size_t each) { return unit * grid[each]; }, i, N, moved);
}

/// What multiplies every coefficient. With a mass on the frame that is the frame's own share of all
/// moving mass; a frame's sensor that shows too much stretches all forces.
Uncertain own_share(const Model& model, const ModelFit& fit) noexcept {
  Uncertain left{1.0};
  Uncertain stretch{1.0};
  for (std::size_t i = 0; i < model.count; ++i) {
    const Candidate& c = model.effect[i];
    const int term = ModelFit::first_of(model, i);
    if (c.effect == Effect::kUnmodelledMode && c.form == kFlexibleForm) {
      for (int r = 0; r < static_cast<int>(c.count - c.slopes); ++r)
        left = left - Uncertain::of(fit, term + r);
    }
    if (c.effect == Effect::kGainError && c.form == kFrameForm)
      stretch = stretch - Uncertain::of(fit, term);
  }
  return stretch / left;
}

/// Friction that a history replaced still counts: the level is what multiplies +-1 in steady
/// sliding.
Uncertain level(const Model& model, const ModelFit& fit) noexcept {
  Uncertain out = Uncertain::of(fit, ModelFit::kCoulomb);
  for (std::size_t i = 0; i < model.count; ++i) {
    const Candidate& c = model.effect[i];
    const int term = ModelFit::first_of(model, i);
    const bool sliding =
        has_memory(c.effect) || (c.effect == Effect::kUnmodelledMode && c.form == kPitchForm);
    for (int r = 0; sliding && r < static_cast<int>(c.count - c.slopes); ++r)
      out = out + Uncertain::of(fit, term + r);
  }
  return own_share(model, fit) * out;
}

/// What friction without a history is below zero beside a play: none drives. Ends that yield look
/// so.
double driving(const Model& model, const ModelFit& fit) noexcept {
  const auto is_play = [](const Candidate& c) { return c.effect == Effect::kBacklash; };
  return model.count_of(is_play) > 0 ? std::max(-fit.theta[ModelFit::kCoulomb], 0.0) : 0.0;
}

Uncertain spring(const Model& model, const ModelFit& fit) noexcept {
  return own_share(model, fit) * Uncertain::of(fit, ModelFit::kStiffness);
}

/// The parameters of a law as they are gathered, for what they have to do with each other.
class List {
 public:
  List(const ModelFit& fit, double factor) noexcept : fit_{fit}, factor_{factor} {}

  /// `law_std`: of the value, what the scatter of the entries does not show.
  Estimate add(const char* name, const Uncertain& quantity, double law_std = 0.0) noexcept {
    item_[count_++] = {name, quantity};
    return {quantity.value, std::hypot(factor_ * quantity.std(fit_), law_std * quantity.value)};
  }
  void put(Step& step, const char* name, const Uncertain& quantity, const char* unit,
           double law_std) noexcept {
    const Estimate estimate = add(name, quantity, law_std);
    step.parameter[step.parameter_count++] = {name, estimate, unit};
  }
  /// Gives each parameter the one that it is most correlated with.
  void relate(EffectParameter& parameter) const noexcept {
    const Item* own = find(parameter.name);
    if (own == nullptr) return;
    for (std::size_t i = 0; i < count_; ++i) {
      const Item& other = item_[i];
      if (&other == own) continue;
      const double product = own->quantity.std(fit_) * other.quantity.std(fit_);
      if (!(product > 0.0)) continue;
      const double correlation = own->quantity.covariance(other.quantity, fit_) / product;
      if (std::abs(correlation) <= std::abs(parameter.correlation)) continue;
      parameter.correlation = correlation;
      parameter.twin = other.name;
    }
  }

 private:
  struct Item {
    const char* name{""};
    Uncertain quantity;
  };
  [[nodiscard]] const Item* find(const char* name) const noexcept {
    for (std::size_t i = 0; i < count_; ++i)
      if (item_[i].name == name) return &item_[i];
    return nullptr;
  }

  const ModelFit& fit_;
  double factor_;
  std::size_t count_{0};
  std::array<Item, 3 + Explanation::kMostSteps * Step::kMostParameters> item_{};
};

void describe_damping(const Part& p, double mass_kg, List& list, Step& step) noexcept {
  const Uncertain first = mass_kg * (p.own * p.coefficient());
  switch (p.candidate.effect) {
    case Effect::kViscous:
      return list.put(step, "viscous", first, "N s/m", p.errors().size);
    case Effect::kQuadraticDamping:
      return list.put(step, "quadratic_damping", first, "N s^2/m^2", p.errors().size);
    case Effect::kAsymmetricViscous: {
      const Uncertain odd = mass_kg * (p.own * p.coefficient(1));
      const auto put = [&](const char* name, const Uncertain& side) {
        list.put(step, name, side, "N s/m", p.errors().size * odd.value / side.value);
      };
      put("viscous_positive", odd + first);
      return put("viscous_negative", odd - first);
    }
    case Effect::kViscoelastic:
      list.put(step, "viscoelastic_stiffness", mass_kg * (p.own * p.sum()), "N/m", p.errors().size);
      return list.put(step, "viscoelastic_time",
                      on_grid(p.grids.relaxation_s, p.candidate.variant, p.moved(0), 1.0), "s",
                      p.errors().place);
    default:
      return;
  }
}

/// An end that yields gives the gap itself no sharp end.
void describe_gap(const Part& p, List& list, Step& step) noexcept {
  const auto& play = p.grids.play;
  const std::size_t v = p.candidate.variant;
  const auto gap_m = [&](std::size_t i) { return kHalfForce * p.grids.scale_m * play[i].gap; };
  const std::size_t line = std::min(line_of(Effect::kBacklash, false, p.grids), kBacklashGaps);
  const double ratio = std::log(play.back().width_mps / play.front().width_mps);
  const double width_mps = by_steps(play[v].width_mps, ratio, p.moved(1)).value;
  const double yields_m = end_yields_m(width_mps, (p.own * p.sum()).value);
  list.put(step, "backlash_gap", in_line(gap_m, v, line, p.moved(0)), "m",
           std::hypot(p.errors().place, kEndShare * yields_m / gap_m(v)));
}

void describe_friction(const Part& p, double mass_kg, List& list, Step& step) noexcept {
  const Uncertain friction = Uncertain::of(p.fit, ModelFit::kCoulomb);
  const Uncertain force = mass_kg * (p.own * p.sum());
  const std::size_t v = p.candidate.variant;
  const Uncertain moved = p.moved(0);
  const double unit_m = p.grids.scale_m;
  switch (p.candidate.effect) {
    case Effect::kProgressiveFriction:  // F (1 + y / length)
      return list.put(step, "progressive_friction_length", friction / p.coefficient(), "m",
                      p.errors().size);
    case Effect::kStribeck:
      list.put(step, "stribeck_share", p.coefficient() / friction, "", p.errors().size);
      return list.put(step, "stribeck_speed", on_grid(p.grids.stribeck_mps, v, moved, 1.0), "m/s",
                      p.errors().place);
    case Effect::kPreslidingHysteresis:
      list.put(step, "presliding_hysteresis_force", force, "N", p.errors().size);
      return list.put(step, "presliding_hysteresis_distance",
                      on_grid(p.grids.dahl_distance, v, moved, unit_m), "m", p.errors().place);
    case Effect::kBacklash:
      list.put(step, "backlash_force", force, "N", p.errors().size);
      return describe_gap(p, list, step);
    default:
      return;
  }
}

void describe_stiffness(const Part& p, double mass_kg, List& list, Step& step) noexcept {
  const Uncertain first = mass_kg * (p.own * p.coefficient());
  switch (p.candidate.effect) {
    case Effect::kCubicStiffness:
      return list.put(step, "cubic_stiffness", first, "N/m^3", p.errors().size);
    case Effect::kQuadraticStiffness:
      return list.put(step, "quadratic_stiffness", first, "N/m^2", p.errors().size);
    case Effect::kAsymmetricStiffness:
      // k y + theta |y|: k + theta for y > 0, k - theta for y < 0
      return list.put(step, "asymmetric_stiffness_difference", 2.0 * first, "N/m", p.errors().size);
    case Effect::kBumpStop:
      list.put(step, "bump_stop_stiffness", first, "N/m", p.errors().size);
      return list.put(step, "bump_stop_gap",
                      on_grid(p.grids.bump_gap, p.candidate.variant, p.moved(0), p.grids.scale_m),
                      "m", p.errors().place);
    default:
      return;
  }
}

void describe_mode(const Part& p, double mass_kg, List& list, Step& step) noexcept {
  const std::size_t v = p.candidate.variant;
  if (p.candidate.form == kPitchForm) {
    const auto hz = [&](std::size_t i) { return p.grids.pitch[i].frequency_hz; };
    list.put(step, "unmodelled_mode_frequency", in_line(hz, v, kPitchFrequencies, p.moved(0)), "Hz",
             p.errors().place);
    return list.put(step, "unmodelled_mode_force", mass_kg * (p.own * p.coefficient()), "N",
                    p.errors().coulomb);
  }
  // t = (k X_k + F X_F - m B) / (1 - m): the coefficient is -m / (1 - m), m of all mass.
  const Uncertain ratio = -1.0 * p.sum();
  const auto hz = [&](std::size_t i) { return p.grids.flexible[i].frequency_hz; };
  const std::size_t line = line_of(p.candidate.effect, false, p.grids);
  list.put(step, "unmodelled_mode_frequency", in_line(hz, v, line, p.moved(0)), "Hz",
           p.errors().place);
  list.put(step, "unmodelled_mode_mass", mass_kg * (ratio / (Uncertain{1.0} + ratio)), "kg",
           p.errors().size);
}

void describe_rest(const Part& p, double mass_kg, List& list, Step& step) noexcept {
  constexpr std::array<const char*, 3> kSkew{"time_skew_frame", "time_skew_wheelset1",
                                             "time_skew_wheelset2"};
  constexpr std::array<const char*, 3> kGain{"gain_error_frame", "gain_error_wheelset1",
                                             "gain_error_wheelset2"};
  const Uncertain e = p.coefficient();
  switch (p.candidate.effect) {
    case Effect::kTimeSkew:
      return list.put(step, kSkew[p.candidate.form], e, "s", p.errors().size);
    case Effect::kGainError:
      // Of the frame z_b'' = (1 - e) times what is measured, which is 1 + gain times it.
      return list.put(step, kGain[p.candidate.form],
                      p.candidate.form == kFrameForm ? e / (Uncertain{1.0} - e) : e, "",
                      p.errors().size);
    case Effect::kUnmodelledMode:
      return describe_mode(p, mass_kg, list, step);
    default:
      return;
  }
}

BaseParameters base_in(const Detail& d, List& list) noexcept {
  const Uncertain all = d.mass_kg * spring(d.model, d.fit);
  const Uncertain slow = d.mass_kg * spring(d.model, d.slow);
  LawErrors errors = errors_beside(d.model);
  list.add("stiffness", all);
  list.add("law_width", Uncertain::of(d.fit, ModelFit::kWidthChange));
  const double driving_n = d.mass_kg * driving(d.model, d.fit);
  const Uncertain friction = Uncertain{driving_n} + d.mass_kg * level(d.model, d.fit);
  errors.coulomb = std::hypot(errors.coulomb, driving_n / friction.value);
  // Of the friction, what has a width of v = 0; memory has none.
  const double jumps = d.mass_kg * d.fit.theta[ModelFit::kCoulomb] / friction.value;
  const double width_mps = d.fit.width_mps * std::sqrt(std::clamp(jumps, 0.0, 1.0));
  const HeldErrors held = held_errors(d, friction.value / d.mass_kg, slow.value / d.mass_kg);
  const Estimate coulomb = list.add("coulomb", friction, errors.coulomb);
  const Estimate stiffness{slow.value,
                           std::hypot(d.factor * slow.std(d.slow), errors.stiffness * slow.value)};
  return {d.velocity.coulomb(without(held.coulomb, coulomb), width_mps),
          d.velocity.stiffness(without(held.stiffness, stiffness), width_mps)};
}

}  // namespace

BaseParameters base_parameters(const Detail& detail) noexcept {
  List list{detail.fit, detail.factor};
  return base_in(detail, list);
}

void describe(const Detail& d, Explanation& out) noexcept {
  List list{d.fit, d.factor};
  const BaseParameters base = base_in(d, list);
  out.final_coulomb_n = base.coulomb_n;
  out.final_stiffness_npm = base.stiffness_npm;
  const Uncertain own = own_share(d.model, d.fit);
  for (std::size_t i = 0; i < d.model.count; ++i) {
    const Part part{d.fit, d.model.effect[i], out.grids, ModelFit::first_of(d.model, i), own};
    if (i < out.base_count || part.candidate.count == 0) continue;
    Step& step = out.step[i - out.base_count];
    step.parameter_count = 0;
    describe_damping(part, d.mass_kg, list, step);
    describe_friction(part, d.mass_kg, list, step);
    describe_stiffness(part, d.mass_kg, list, step);
    describe_rest(part, d.mass_kg, list, step);
    step.place = part.candidate.variant + part.moved(0).value;
    step.line_offset = part.moved(1).value;
  }
  for (Step& step : out.steps())
    for (std::size_t p = 0; p < step.parameter_count; ++p) list.relate(step.parameter[p]);
}

}  // namespace dampline::effect
