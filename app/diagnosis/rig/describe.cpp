// SPDX-License-Identifier: MIT
// What was found, in parameters with units.
#include "app/diagnosis/rig/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "app/diagnosis/rig/bank.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {
namespace {

using Of = Place::Of;

/// What the first coefficient of an effect in its smallest form is.
struct First {
  std::string_view effect;
  const char* name;
  const char* unit;
  double times{1.0};
};
constexpr std::array kFirst{
    First{"quadratic_damping", "quadratic_damping", "N s^2/m^2"},
    First{"progressive_damping", "progressive_damping", "N s/m^3"},
    First{"coulomb", "coulomb", "N"},
    First{"offset_force", "offset", "N"},
    First{"stribeck", "stribeck_force", "N"},
    First{"cubic_stiffness", "cubic_stiffness", "N/m^3"},
    First{"quadratic_stiffness", "quadratic_stiffness", "N/m^2"},
    First{"asymmetric_stiffness", "asymmetric_stiffness_difference", "N/m", 2.0},
    First{"bump_stop", "bump_stop_stiffness", "N/m"},
    First{"viscoelastic", "viscoelastic_stiffness", "N/m"},
    First{"presliding_hysteresis", "presliding_hysteresis_force", "N"},
    First{"backlash", "backlash_force", "N"},
    First{"unmodelled_mode", "unmodelled_mode_mass", "kg"},
    First{"progressive_friction", "progressive_friction_slope", "N/m"}};

/// Figures of one model: each a value and its slope over all that was fitted together.
class Figures {
 public:
  Figures(const Joint& joint, std::vector<std::string>& notes) : joint_{joint}, notes_{notes} {}

  [[nodiscard]] Eigen::VectorXd slope(Eigen::Index at, double times = 1.0) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(joint_.size());
    if (at >= 0 && at < out.size()) out[at] = times;
    return out;
  }

  /// Its deviation, no less than half of what the halves of the record differ by where that is
  /// certain.
  Parameter take(const std::string& name, double value, const char* unit,
                 const Eigen::VectorXd& slope) {
    Parameter out{name, value, std::sqrt(std::max(slope.dot(joint_.covariance * slope), 0.0)),
                  unit};
    const double apart = 0.5 * std::abs(slope.dot(joint_.half_difference));
    if (apart > kHalvesApart * out.std && out.std > 0.0) {
      notes_.push_back(fmt::format(
          "{} is not the same in both halves of the record, by {:.1f} deviations: its deviation "
          "was widened to hold both.",
          name, apart / out.std));
      out.std = apart;
    }
    taken_.emplace_back(name, slope);
    return out;
  }

  /// Puts to each parameter the other that it is most correlated with.
  void put_twins(std::vector<Parameter>& parameters) const {
    for (Parameter& p : parameters) {
      const auto& slope = std::find_if(taken_.begin(), taken_.end(),
                                       [&](const auto& t) { return t.first == p.name; });
      if (slope == taken_.end()) continue;
      for (const auto& [other, their] : taken_) {
        const double value = correlation(slope->second, their);
        if (other == p.name || std::abs(value) <= std::abs(p.correlation)) continue;
        p.twin = other;
        p.correlation = value;
      }
    }
  }

 private:
  [[nodiscard]] double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    const auto& c = joint_.covariance;
    const double size = std::sqrt(a.dot(c * a) * b.dot(c * b));
    return size > 0.0 ? a.dot(c * b) / size : 0.0;
  }

  const Joint& joint_;
  std::vector<std::string>& notes_;
  std::vector<std::pair<std::string, Eigen::VectorXd>> taken_;
};

const char* name_of(const Regressor& column, bool is_friction) {
  switch (column.kind) {
    case Kind::kInertia:
    case Kind::kAcceleration:
      return "moving_mass";
    case Kind::kDeflection:
      return "stiffness";
    case Kind::kVelocity:
      return "viscous";
    case Kind::kOne:
      return "offset";
    default:
      return is_friction ? "coulomb" : nullptr;
  }
}

const char* unit_of(std::string_view name) {
  if (name == "moving_mass") return "kg";
  if (name == "stiffness") return "N/m";
  return name == "viscous" ? "N s/m" : "N";
}

/// One model on its way to its parameters.
struct Writing {
  const State& s;
  const Joint& joint;
  Model& model;
  Figures figures;

  [[nodiscard]] double theta(std::size_t i) const {
    return model.fit.theta[static_cast<Eigen::Index>(i)];
  }
  Parameter coefficient(const std::string& name, std::size_t i, const char* unit,
                        double times = 1.0) {
    return figures.take(name, times * theta(i), unit,
                        figures.slope(static_cast<Eigen::Index>(i), times));
  }
  Parameter place(const std::string& name, Eigen::Index at, double value, const char* unit,
                  double times = 1.0) {
    return figures.take(name, times * value, unit, figures.slope(at, times));
  }
};

void write_base(Writing& w) {
  for (std::size_t i = 0; i < w.joint.coefficients; ++i) {
    const Regressor& column = w.model.columns[i];
    const bool friction = static_cast<int>(i) == w.model.friction;
    if (column.time != Regressor::Time::kSteady) continue;
    if (const char* name = name_of(column, friction)) {
      w.model.coefficients.emplace_back(w.model.parameters.size(), static_cast<Eigen::Index>(i));
      w.model.parameters.push_back(w.coefficient(name, i, unit_of(name)));
    }
    if (friction && is_smooth(column, w.s.scale))
      w.model.parameters.push_back(
          w.place("law_width", w.joint.of_column(i, Of::kA), column.a, "m/s"));
  }
}

/// The parameters of an effect in its smallest form, from its first coefficient.
void write_small(Writing& w, std::size_t at, Step& step) {
  const auto* const what = std::find_if(kFirst.begin(), kFirst.end(),
                                        [&](const First& f) { return f.effect == step.effect; });
  if (what == kFirst.end())
    step.parameters.push_back(w.coefficient(step.effect, at, "N s/m"));
  else
    step.parameters.push_back(w.coefficient(what->name, at, what->unit, what->times));
  const Regressor& column = w.model.columns[at];
  if (step.effect == "stribeck")
    step.parameters.push_back(
        w.place("stribeck_speed", w.joint.of_column(at, Of::kB), column.b, "m/s"));
  if (step.effect == "bump_stop")
    step.parameters.push_back(
        w.place("bump_stop_gap", w.joint.of_column(at, Of::kA), column.a, "m"));
  if (is_memory(step.effect))
    step.parameters.push_back(
        w.place(step.effect + "_travel", w.joint.of_column(at, Of::kA), column.a, "m", 2.0));
  if (column.kind == Kind::kMaxwell)
    step.parameters.push_back(
        w.place("viscoelastic_time", w.joint.of_column(at, Of::kA), column.a, "s"));
  if (column.kind != Kind::kAttached) return;
  step.parameters.push_back(
      w.place("unmodelled_mode_frequency", w.joint.of_column(at, Of::kA), column.a, "Hz"));
  step.parameters.push_back(
      w.place("unmodelled_mode_damping", w.joint.of_column(at, Of::kB), column.b, ""));
}

void write_sides(Writing& w, Step& step) {
  const auto at = [&](Kind kind) {
    return static_cast<std::size_t>(
        std::find_if(w.model.columns.begin(), w.model.columns.end(),
                     [&](const Regressor& c) { return c.kind == kind; }) -
        w.model.columns.begin());
  };
  const std::size_t odd = at(Kind::kVelocity);
  const std::size_t even = at(Kind::kSpeed);
  for (const double side : {1.0, -1.0})
    step.parameters.push_back(
        w.figures.take(side > 0.0 ? "viscous_positive" : "viscous_negative",
                       w.theta(odd) + side * w.theta(even), "N s/m",
                       w.figures.slope(static_cast<Eigen::Index>(odd)) +
                           w.figures.slope(static_cast<Eigen::Index>(even), side)));
}

/// The change over the record, of the mean or of the value before it.
void write_drift(Writing& w, std::size_t at, Step& step) {
  const Regressor& drifting = w.model.columns[at];
  Parameter& out = step.parameters.front();
  if (drifting.kind == Kind::kOne) {
    out = w.coefficient(out.name, at, "N");
    return;
  }
  for (std::size_t i = 0; i < w.joint.coefficients; ++i) {
    const Regressor& steady = w.model.columns[i];
    if (steady.time != Regressor::Time::kSteady || steady.kind != drifting.kind ||
        steady.a != drifting.a)
      continue;
    const double of = w.theta(i);
    const double change = w.theta(at);
    if (of == 0.0) return;
    out = w.figures.take(
        out.name, 100.0 * change / of, "%",
        w.figures.slope(static_cast<Eigen::Index>(at), 100.0 / of) +
            w.figures.slope(static_cast<Eigen::Index>(i), -100.0 * change / (of * of)));
    return;
  }
}

/// The change of a friction with memory: of one step or slope, or the range of several.
void write_change(Writing& w, Step& step) {
  Eigen::Index low = -1;
  Eigen::Index high = -1;
  double level = 0.0;
  double least = 0.0;
  double most = 0.0;
  for (Eigen::Index k = 0; k < w.joint.changes.size(); ++k) {
    level += w.joint.changes[k];
    if (level < least) std::tie(least, low) = std::pair{level, k};
    if (level > most) std::tie(most, high) = std::pair{level, k};
  }
  Eigen::VectorXd slope = w.figures.slope(-1);
  for (Eigen::Index k = 0; k < w.joint.changes.size(); ++k)
    slope +=
        w.figures.slope(w.joint.of_change(static_cast<std::size_t>(k)),
                        100.0 * (static_cast<double>(k <= high) - static_cast<double>(k <= low)));
  const double size = w.joint.changes.size() == 1 ? w.joint.changes[0] : most - least;
  if (w.joint.changes.size() == 1) slope = w.figures.slope(w.joint.of_change(0), 100.0);
  step.parameters.front() = w.figures.take(step.parameters.front().name, 100.0 * size, "%", slope);
}

void write_bouc_wen(Writing& w, std::size_t at, Step& step) {
  const Regressor& law = w.model.columns[at];
  const Eigen::Index travel = w.joint.of_column(at, Of::kA);
  const Eigen::Index shape = w.joint.of_column(at, Of::kB);
  const double stiffness = w.theta(at);
  const double slips = 1.0 + law.b;
  const double slip_m = bouc_wen_slip_m(law.a, law.b);
  const double shape_std = shape < 0 ? 0.0 : std::sqrt(w.joint.covariance(shape, shape));
  auto& out = step.parameters;
  if (slips > 2.0 * shape_std && slip_m > 0.0)
    out.push_back(w.figures.take("presliding_hysteresis_force", stiffness * slip_m, "N",
                                 w.figures.slope(static_cast<Eigen::Index>(at), slip_m) +
                                     w.figures.slope(travel, stiffness / slips) +
                                     w.figures.slope(shape, -stiffness * slip_m / slips)));
  out.push_back(w.coefficient("presliding_hysteresis_stiffness", at, "N/m"));
  out.push_back(w.place("presliding_hysteresis_travel", travel, law.a, "m"));
  out.push_back(w.place("presliding_hysteresis_shape", shape, law.b, ""));
}

/// The deviation of each figure by the jackknife over the folds.
void write_bank(Writing& w, Step& step) {
  constexpr double kTravelPlace = 0.07;  // a step of 1.15, evenly spread
  const double longest_m = longest_of(w.s.bank);
  const std::vector<Regressor> columns{
      w.model.columns.begin(),
      w.model.columns.begin() + static_cast<std::ptrdiff_t>(w.joint.coefficients)};
  const BankFigures all = read_bank(columns, w.model.fit.theta, longest_m);
  std::vector<BankFigures> left;
  for (const Eigen::VectorXd& theta : w.model.fit.left_out)
    left.push_back(read_bank(columns, theta, longest_m));
  const auto add = [&](const std::string& name, double BankFigures::*value, const char* unit) {
    std::vector<double> values;
    values.reserve(left.size());
    for (const BankFigures& r : left) values.push_back(r.*value);
    step.parameters.push_back({name, all.*value, jackknife_std(values), unit});
  };
  const std::string& effect = step.effect;
  add(effect + "_force_positive", &BankFigures::level_up_n, "N");
  add(effect + "_force_negative", &BankFigures::level_down_n, "N");
  add(effect == "backlash" ? "backlash_gap" : effect + "_free_play", &BankFigures::free_play_m,
      "m");
  step.parameters.back().std =
      std::hypot(step.parameters.back().std, all.step_m / std::sqrt(6.0));  // both ends rounded
  add(effect + "_contact_stiffness", &BankFigures::stiffness_npm, "N/m");
  int number = 0;
  for (const BankElement& e : w.s.bank)
    step.parameters.push_back({effect + "_travel_" + std::to_string(++number), 2.0 * e.travel_m,
                               kTravelPlace * 2.0 * e.travel_m, "m"});
}

/// Lateness and modes before the sensor: figures of the records.
bool write_of_records(Writing& w, Step& step) {
  if (step.effect == "time_skew") {
    step.parameters = {
        w.place("time_skew", w.joint.of_records(Of::kSkew), w.model.skew_s, "ms", 1e3)};
    return true;
  }
  if (step.effect != "unmodelled_mode" || !(w.model.path.hz > 0.0)) return false;
  step.parameters = {w.place("unmodelled_mode_frequency", w.joint.of_records(Of::kFrequency),
                             w.model.path.hz, "Hz"),
                     w.place("unmodelled_mode_damping", w.joint.of_records(Of::kDamping),
                             w.model.path.damping, "")};
  return true;
}

void write_step(Writing& w, const ColumnSet& columns, Chosen& c) {
  if (c.step.effect == "impulsive_input" || write_of_records(w, c.step)) return;
  if (!c.changes.empty()) return write_change(w, c.step);
  if (c.candidate.columns.empty()) return;
  const auto at = static_cast<std::size_t>(place_of(columns, c.candidate.columns.front()));
  if (c.step.effect == "time_drift") return write_drift(w, at, c.step);
  c.step.parameters.clear();
  if (w.model.columns[at].kind == Kind::kBoucWen) return write_bouc_wen(w, at, c.step);
  if (c.ridge > 0.0) return write_bank(w, c.step);
  if (c.step.effect == "asymmetric_viscous") return write_sides(w, c.step);
  write_small(w, at, c.step);
}

}  // namespace

void describe(const State& s, const Joint& joint, Model& model, std::vector<Chosen>& steps,
              const ColumnSet& columns, std::vector<std::string>& notes) {
  if (!joint.ok) return;
  Writing w{s, joint, model, Figures{joint, notes}};
  write_base(w);
  for (Chosen& c : steps) write_step(w, columns, c);
  for (const Chosen& c : steps)
    for (const Parameter& p : c.step.parameters) {
      const auto same = [&](const Parameter& other) { return other.name == p.name; };
      if (std::none_of(model.parameters.begin(), model.parameters.end(), same))
        model.parameters.push_back(p);
    }
  w.figures.put_twins(model.parameters);
  for (Chosen& c : steps) w.figures.put_twins(c.step.parameters);
}

}  // namespace dampline::app::rig
