// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace dampline::app {
namespace {

using effect::Effect;
using law::Kind;
using Part = law::Unknown::Part;

/// A sign that sticks: the width of its column does not count.
constexpr double kWidthMps = 1e-4;

/// A law made term by term of parameters with their deviations.
class Writing {
 public:
  explicit Writing(const std::vector<Parameter>& parameters) : parameters_{parameters} {}

  [[nodiscard]] Estimate get(std::string_view name) const { return estimate_of(parameters_, name); }
  std::size_t add(const law::Regressor& column, const Estimate& coefficient, bool sharp = false) {
    const std::size_t term = out_.law.terms.size();
    out_.law.terms.push_back({column, coefficient.value, sharp});
    unknown('c', Part::kCoefficient, {term}, coefficient.std);
    return term;
  }
  void unknown(char letter, Part part, const std::vector<std::size_t>& terms, double std) {
    out_.unknowns.push_back({fmt::format("{}{}", letter, terms.front() + 1), part, terms});
    std_.push_back(std);
  }
  law::Document finish() {
    out_.covariance =
        Eigen::Map<const Eigen::VectorXd>(std_.data(), static_cast<Eigen::Index>(std_.size()))
            .cwiseAbs2()
            .asDiagonal();
    return std::move(out_);
  }
  law::Document& document() { return out_; }

 private:
  const std::vector<Parameter>& parameters_;
  law::Document out_;
  std::vector<double> std_;
};

Estimate times(double factor, const Estimate& e) {
  return {factor * e.value, std::abs(factor) * e.std};
}
/// Of two independent numbers.
Estimate product(const Estimate& a, const Estimate& b) {
  return {a.value * b.value, std::hypot(a.value * b.std, b.value * a.std)};
}
Estimate quotient(const Estimate& a, const Estimate& b) {
  const double value = a.value / b.value;
  return {value, std::hypot(a.std / b.value, value * b.std / b.value)};
}

void add_asymmetric_viscous(Writing& w) {
  const Estimate up = w.get("viscous_positive");
  const Estimate down = w.get("viscous_negative");
  const double std = 0.5 * std::hypot(up.std, down.std);
  w.add({Kind::kVelocity}, {0.5 * (up.value + down.value), std});
  w.add({Kind::kSpeed}, {0.5 * (up.value - down.value), std});
}

void add_bump_stop(Writing& w, std::uint8_t form) {
  const Estimate stiffness = w.get("bump_stop_stiffness");
  const Estimate gap = w.get("bump_stop_gap");
  std::vector<std::size_t> terms;
  if (form != effect::kOneSidedDown) terms.push_back(w.add({Kind::kBumpUp, gap.value}, stiffness));
  if (form != effect::kOneSidedUp) terms.push_back(w.add({Kind::kBumpDown, gap.value}, stiffness));
  w.unknown('a', Part::kA, terms, gap.std);
}

/// Says whether the effect is a term. `plain`: the friction of the base.
bool add_effect(Writing& w, const effect::Candidate& c, const Estimate& plain) {
  switch (c.effect) {
    case Effect::kViscous:
      w.add({Kind::kVelocity}, w.get("viscous"));
      return true;
    case Effect::kAsymmetricViscous:
      add_asymmetric_viscous(w);
      return true;
    case Effect::kQuadraticDamping:
      w.add({Kind::kSpeedSquared}, w.get("quadratic_damping"));
      return true;
    case Effect::kProgressiveFriction:
      w.add({c.form == effect::kAbsoluteForm ? Kind::kProgressiveAbsolute : Kind::kProgressive,
             kWidthMps},
            quotient(plain, w.get("progressive_friction_length")), true);
      return true;
    case Effect::kStribeck: {
      const Estimate speed = w.get("stribeck_speed");
      const std::size_t term = w.add({Kind::kFading, kWidthMps, speed.value},
                                     product(plain, w.get("stribeck_share")), true);
      w.unknown('b', Part::kB, {term}, speed.std);
      return true;
    }
    case Effect::kPreslidingHysteresis: {
      const Estimate way = w.get("presliding_hysteresis_distance");
      const std::size_t term = w.add({Kind::kBoucWen, way.value},
                                     times(1.0 / way.value, w.get("presliding_hysteresis_force")));
      w.unknown('a', Part::kA, {term}, way.std);
      return true;
    }
    case Effect::kViscoelastic: {
      const Estimate time = w.get("viscoelastic_time");
      const std::size_t term = w.add({Kind::kMaxwell, time.value}, w.get("viscoelastic_stiffness"));
      w.unknown('a', Part::kA, {term}, time.std);
      return true;
    }
    case Effect::kCubicStiffness:
      w.add({Kind::kCube}, w.get("cubic_stiffness"));
      return true;
    case Effect::kQuadraticStiffness:
      w.add({Kind::kSquare}, w.get("quadratic_stiffness"));
      return true;
    case Effect::kAsymmetricStiffness:
      w.add({Kind::kMagnitude}, times(0.5, w.get("asymmetric_stiffness_difference")));
      return true;
    case Effect::kBumpStop:
      add_bump_stop(w, c.form);
      return true;
    default:
      return false;
  }
}

}  // namespace

law::Document document_of(const Explained& explained, const std::vector<Parameter>& parameters,
                          double moving_mass_kg) {
  const effect::Explanation& e = explained.explanation;
  Writing w{parameters};
  Estimate plain = w.get("coulomb");
  plain.value -= w.get("presliding_hysteresis_force").value;
  w.add({Kind::kDeflection}, w.get("stiffness"));
  w.add({Kind::kSign, kWidthMps}, plain, true);
  if (e.base_count > 0) w.add({Kind::kVelocity}, w.get("viscous"));
  for (std::size_t i = 0; i < e.step_count; ++i) {
    const effect::Candidate& c = e.model.effect[e.base_count + i];
    if (!add_effect(w, c, plain))
      w.document().not_in_it.push_back(
          fmt::format("{}: found, and no function of the law", effect::name_of(c.effect)));
  }
  if (explained.other)
    w.document().not_in_it.emplace_back("other_truck: it pushes through the body");
  if (explained.drifts)
    w.document().not_in_it.emplace_back("time_drift: a parameter changed over the record");
  law::Document out = w.finish();
  out.subject = law::Subject::kTruck;
  out.law.mass_kg = 0.5 * moving_mass_kg;
  out.sample_rate_hz =
      explained.identified.sample_rate_hz ? explained.identified.sample_rate_hz->value : 0.0;
  out.residual_n = explained.signature.rms_n;
  out.residual_mps2 = explained.signature.rms_n / moving_mass_kg;
  return out;
}

}  // namespace dampline::app
