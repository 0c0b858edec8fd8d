// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/by_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "app/beside.hpp"
#include "app/diagnosis/truck/document.hpp"
#include "app/diagnosis/truck/explanation.hpp"
#include "app/diagnosis/truck/verdict.hpp"
#include "app/identify/source.hpp"
#include "app/identify/truck_samples.hpp"
#include "app/law/block_fit.hpp"
#include "dampline/motion/drift_free_integral.hpp"

namespace dampline::app {
namespace {

using effect::Effect;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using law::Kind;
using Part = law::Unknown::Part;

constexpr double kDriftHz = 0.05;        // slower accelerations are the sensors'
constexpr double kSettleS = 5.0;         // at either end of a stretch
constexpr double kLongestRideS = 600.0;  // of a record
constexpr double kBlockS = 5.0;
constexpr double kDifference = 1e-3;  // of an unknown, for its slope
constexpr int kMotionRounds = 15;
constexpr int kTries = 8;
constexpr double kLittle = 1e-5;        // of the squares: a step that gains no more is the last
constexpr double kOtherLevel = 0.05;    // between both levels of friction: the law is another one
constexpr double kGain = 0.004;         // the core's integral is an integrator within this
constexpr double kNamedSigmas = 2.0;    // a gain that the equations name is one
constexpr double kUnnamedSigmas = 3.0;  // one is told that they do not name
constexpr std::string_view kFrameGain = "gain_error_frame";
constexpr double kRivalShare = 0.8;   // of the gain: a spring that has it may be the right one
constexpr double kOffsetShare = 0.1;  // of the friction: first steps of the constant force

bool is_elastic(Effect e) {
  return e == Effect::kBumpStop || e == Effect::kCubicStiffness ||
         e == Effect::kQuadraticStiffness || e == Effect::kAsymmetricStiffness;
}

/// The law of what was explained, with a constant force more, which shifts the rest position where
/// friction differs up and down; the two sides of a stop have one stiffness.
law::Document law_to_move(const Config& config, const Explained& explained) {
  law::Document out = document_of(explained, told(explained).final.parameters,
                                  estimator_config(config).moving_mass_kg);
  const auto of = [&](Kind kind) {
    return std::find_if(out.unknowns.begin(), out.unknowns.end(), [&](const law::Unknown& u) {
      return u.part == Part::kCoefficient && out.law.terms[u.terms.front()].column.kind == kind;
    });
  };
  const auto up = of(Kind::kBumpUp);
  const auto down = of(Kind::kBumpDown);
  if (up != out.unknowns.end() && down != out.unknowns.end()) {
    up->terms.push_back(down->terms.front());
    out.unknowns.erase(down);
  }
  out.unknowns.push_back({"c0", Part::kCoefficient, {out.law.terms.size()}});
  out.law.terms.push_back({{Kind::kOne}, 0.0, false});
  return out;
}

/// Less what is slower than `corner_hz`, to the first order, forth and back.
void take_slow(double corner_hz, double rate_hz, VectorXd& values) {
  const double share = 2.0 * std::numbers::pi * corner_hz / rate_hz;
  for (int way = 0; way < 2; ++way) {
    double slow = 0.0;
    for (Index i = 0; i < values.size(); ++i) {
      slow += share * (values[i] - slow);
      values[i] -= slow;
    }
    values.reverseInPlace();
  }
}

/// What a filter of the core makes of a signal, at its own time; 0 where it makes nothing.
template <class Filter>
VectorXd passed(Filter filter, const VectorXd& values) {
  VectorXd out = VectorXd::Zero(values.size());
  double value = 0.0;
  for (Index i = 0; i < values.size(); ++i)
    if (filter.update(values[i], value)) out[i - filter.delay()] = value;
  return out;
}

/// Samples at either end of a stretch that are not compared.
Index settle_of(double rate_hz) { return static_cast<Index>(kSettleS * rate_hz); }

/// A stretch of the record: what moves the law, and the velocity that it is to have.
struct Ride {
  law::Input push;
  VectorXd velocity_mps;  ///< without what is slower than about 1 Hz, and both ends
  VectorXd frame_mps;     ///< twice the frame's, likewise
};

std::vector<Ride> rides_of(const TruckSamples& samples, double law_mass_kg) {
  std::vector<Ride> out;
  for (const TruckSamples::Stretch& s : samples.stretches()) {
    const Index n = s.to - s.from;
    const Index settle = settle_of(samples.rate_hz);
    if (n < 4 * settle) continue;
    const auto at = [&](const std::vector<double>& v) -> VectorXd {
      return Eigen::Map<const VectorXd>(v.data() + s.from, n);
    };
    const VectorXd wheels = at(samples.wheelsets_mps2);
    VectorXd push_n = -law_mass_kg * (wheels.array() - wheels.mean());
    take_slow(kDriftHz, samples.rate_hz, push_n);
    const auto velocity_of = [&](const VectorXd& accel_mps2) -> VectorXd {
      return passed(DriftFreeIntegral{samples.rate_hz}, accel_mps2).segment(settle, n - 2 * settle);
    };
    const VectorXd frame = 2.0 * at(samples.frame_mps2);
    out.push_back({law::Input{push_n, 1.0 / samples.rate_hz}, velocity_of(frame - wheels),
                   velocity_of(frame)});
  }
  return out;
}

/// Fits a law to its rides, and, where its values are one more than its unknowns, by which share
/// the frame's sensor tells too much.
class OwnMotion {
 public:
  OwnMotion(law::Document document, std::vector<Ride> rides, double rate_hz)
      : document_{std::move(document)}, rides_{std::move(rides)}, rate_hz_{rate_hz} {}

  struct Found {
    VectorXd values;
    MatrixXd covariance;
    double nmse_before{0.0};
    VectorXd held_out;  ///< share of the motion's squares, by blocks
  };
  /// Nothing where the law runs away, or the motion does not tell its unknowns apart.
  [[nodiscard]] std::optional<Found> fit(VectorXd values, const VectorXd& scale) const;
  [[nodiscard]] const law::Document& document() const noexcept { return document_; }

 private:
  [[nodiscard]] std::optional<VectorXd> left(const VectorXd& values) const;
  [[nodiscard]] std::optional<MatrixXd> slopes(const VectorXd& values, const VectorXd& scale,
                                               const VectorXd& left) const;
  [[nodiscard]] double motion_squares() const;

  law::Document document_;
  std::vector<Ride> rides_;
  double rate_hz_;
};

/// The law's velocity less the measured one, ride by ride.
std::optional<VectorXd> OwnMotion::left(const VectorXd& values) const {
  const auto unknowns = static_cast<Index>(document_.unknowns.size());
  const law::Law law = document_.with(values.head(unknowns));
  const double too_much = values.size() > unknowns ? values[unknowns] : 0.0;
  Index count = 0;
  for (const Ride& r : rides_) count += r.velocity_mps.size();
  VectorXd out{count};
  Index at = 0;
  for (const Ride& r : rides_) {
    const law::Course course = law::move(law, r.push, {}, TruckSamples::kRefinement);
    if (!course.whole) return std::nullopt;
    const VectorXd fast =
        passed(Baseline{DriftFreeIntegral::decimation(rate_hz_)}, course.velocity_mps);
    const Index n = r.velocity_mps.size();
    out.segment(at, n) =
        fast.segment(settle_of(rate_hz_), n) - r.velocity_mps + too_much * r.frame_mps;
    at += n;
  }
  return out;
}

std::optional<MatrixXd> OwnMotion::slopes(const VectorXd& values, const VectorXd& scale,
                                          const VectorXd& from) const {
  MatrixXd out{from.size(), values.size()};
  std::atomic<bool> stayed{true};
  each_beside(static_cast<std::size_t>(values.size()), [&](std::size_t i) {
    const auto j = static_cast<Index>(i);
    const double step = kDifference * scale[j];
    const auto there = left(values + step * VectorXd::Unit(values.size(), j));
    if (there)
      out.col(j) = (*there - from) / step;
    else
      stayed = false;
  });
  if (!stayed) return std::nullopt;
  return out;
}

double OwnMotion::motion_squares() const {
  double out = 0.0;
  for (const Ride& r : rides_) out += r.velocity_mps.squaredNorm();
  return out;
}

std::optional<OwnMotion::Found> OwnMotion::fit(VectorXd values, const VectorXd& scale) const {
  auto rest = left(values);
  if (!rest) return std::nullopt;
  Found out;
  out.nmse_before = rest->squaredNorm() / motion_squares();
  double damping = 1e-3;
  auto by = slopes(values, scale, *rest);
  for (int round = 0; by && round < kMotionRounds; ++round) {
    const MatrixXd products = by->transpose() * *by;
    const VectorXd gradient = by->transpose() * *rest;
    const double before = rest->squaredNorm();
    bool better = false;
    for (int tries = 0; tries < kTries && !better; ++tries, damping *= 10.0) {
      MatrixXd damped = products;
      damped.diagonal() *= 1.0 + damping;
      const VectorXd there = values - damped.ldlt().solve(gradient);
      auto then = left(there);
      if (!then || !(then->squaredNorm() < before)) continue;
      values = there;
      rest = std::move(then);
      better = true;
      damping *= 0.003;
    }
    if (!better) break;
    by = slopes(values, scale, *rest);
    if (rest->squaredNorm() > (1.0 - kLittle) * before) break;
  }
  if (!by) return std::nullopt;
  std::vector<law::Sums> blocks;
  law::append_blocks(*by, *rest, static_cast<Index>(kBlockS * rate_hz_), blocks);
  const law::BlockFit fit{std::move(blocks)};
  if (!fit.ok()) return std::nullopt;
  out.values = values;
  out.covariance = fit.covariance(static_cast<double>(rest->size() - values.size()));
  out.held_out = fit.held_out_squares() / motion_squares();
  return out;
}

/// What an unknown is of the spring: a parameter of the explanation.
struct Figure {
  std::string_view name{};  ///< empty: it is none
  double times{1.0};        ///< the unknown
  double power{1.0};        ///< of the deflection beside it: an error of scale counts as often
};

Figure figure_of(const law::Document& d, const law::Unknown& u) {
  const Kind kind = d.law.terms[u.terms.front()].column.kind;
  const bool stop = kind == Kind::kBumpUp || kind == Kind::kBumpDown;
  if (stop && u.part == Part::kA) return {"bump_stop_gap"};
  if (stop) return {"bump_stop_stiffness"};
  if (kind == Kind::kDeflection) return {"stiffness"};
  if (kind == Kind::kCube) return {"cubic_stiffness", 1.0, 3.0};
  if (kind == Kind::kSquare) return {"quadratic_stiffness", 1.0, 2.0};
  if (kind == Kind::kMagnitude) return {"asymmetric_stiffness_difference", 2.0};
  return {};
}

void put(std::string_view name, const Estimate& value, effect::Explanation& e) {
  if (name == "stiffness") e.final_stiffness_npm = value;
  for (effect::Step& step : e.steps())
    for (std::size_t p = 0; p < step.parameter_count; ++p)
      if (step.parameter[p].name == name) step.parameter[p].estimate = value;
}

bool can_refine(const Explained& e) {
  return !e.withheld && !e.drifts && !e.other && e.lateness == ChannelLateness{} &&
         any_of_steps(e.explanation,
                      [](const effect::Step& s) { return is_elastic(s.chosen.effect); });
}

/// Where friction slides, its level; how far apart the equations' and the motion's are.
double apart(const law::Document& d, const VectorXd& values) {
  for (std::size_t i = 0; i < d.unknowns.size(); ++i) {
    const law::Term& term = d.law.terms[d.unknowns[i].terms.front()];
    if (term.column.kind == Kind::kSign && d.unknowns[i].part == Part::kCoefficient)
      return std::abs(values[static_cast<Index>(i)] / term.coefficient - 1.0);
  }
  return 0.0;
}

bool names_frame_gain(const effect::Explanation& e) {
  return any_of_steps(e, [](const effect::Step& s) { return s.parameter[0].name == kFrameGain; });
}

/// A record that its law is moved by; nothing where an effect but a gain of the frame is no term
/// of it.
std::optional<OwnMotion> own_motion(const Config& config, const SourceOptions& source,
                                    const Explained& explained) {
  if (!can_refine(explained)) return std::nullopt;
  law::Document document = law_to_move(config, explained);
  const std::size_t beside = names_frame_gain(explained.explanation) ? 1 : 0;
  if (document.not_in_it.size() != beside || !law::FreeRun::can(document.law)) return std::nullopt;
  const TruckSamples samples =
      read_truck_samples(config, source, detect_source(config, source), kLongestRideS);
  std::vector<Ride> rides = rides_of(samples, document.law.mass_kg);
  if (rides.empty()) return std::nullopt;
  return OwnMotion{std::move(document), std::move(rides), samples.rate_hz};
}

/// The equations' figures, and the size of each.
std::pair<VectorXd, VectorXd> start_of(const OwnMotion& motion, const Explained& explained) {
  const VectorXd rows = motion.document().values();
  VectorXd scale = rows.cwiseAbs();
  scale[scale.size() - 1] = kOffsetShare * explained.explanation.final_coulomb_n.value;
  return {rows, scale};
}

std::optional<OwnMotion::Found> fit_with_gain(const OwnMotion& motion, const Explained& explained) {
  const auto [rows, scale] = start_of(motion, explained);
  VectorXd values = VectorXd::Zero(rows.size() + 1);
  VectorXd scales = VectorXd::Ones(rows.size() + 1);
  values.head(rows.size()) = rows;
  scales.head(rows.size()) = scale;
  return motion.fit(values, scales);
}

/// Of fit_with_gain: by which share the frame's sensor tells too much.
Estimate gain_of(const OwnMotion::Found& found) {
  const Index last = found.values.size() - 1;
  const double share = found.values[last];  // of what it tells
  return {share / (1.0 - share), std::hypot(std::sqrt(found.covariance(last, last)), kGain)};
}

bool is_beyond(double sigmas, const Estimate& e) { return std::abs(e.value) > sigmas * e.std; }

}  // namespace

std::optional<Effect> spring_with_rival(const effect::Explanation& e) {
  for (const effect::Step& step : e.steps()) {
    if (!is_elastic(step.chosen.effect)) continue;
    const double gain = step.held_out_nmse_before - step.held_out_nmse_after;
    for (std::size_t r = 0; r < step.runner_up_count; ++r)
      if (is_elastic(step.other[r].effect) &&
          step.held_out_nmse_before - step.runner_up[r].held_out_nmse > kRivalShare * gain)
        return step.chosen.effect;
  }
  return std::nullopt;
}

bool shows_no_gain(const Config& config, const SourceOptions& source, const Explained& explained) {
  if (!names_frame_gain(explained.explanation)) return false;
  const auto motion = own_motion(config, source, explained);
  if (!motion) return false;
  const auto found = fit_with_gain(*motion, explained);
  return found && apart(motion->document(), found->values) < kOtherLevel &&
         !is_beyond(kNamedSigmas, gain_of(*found));
}

VectorXd refine_by_motion(const Config& config, const SourceOptions& source, Explained& out) {
  const auto motion = own_motion(config, source, out);
  if (!motion) return {};
  const law::Document& document = motion->document();
  auto found = fit_with_gain(*motion, out);
  if (!found) return {};
  const double before_nmse = found->nmse_before;
  const Estimate gain = gain_of(*found);
  const bool named = names_frame_gain(out.explanation);
  const bool is_gain = is_beyond(named ? kNamedSigmas : kUnnamedSigmas, gain);
  if (!is_gain) {
    const auto [rows, scale] = start_of(*motion, out);
    found = motion->fit(found->values.head(rows.size()), scale);
  }
  if (!found || !(found->held_out.sum() < before_nmse)) return {};
  const double level = apart(document, found->values);
  if (level > kOtherLevel) return {};
  std::vector<std::pair<std::string_view, Estimate>> refined;
  for (std::size_t i = 0; i < document.unknowns.size(); ++i) {
    const Figure figure = figure_of(document, document.unknowns[i]);
    if (figure.name.empty()) continue;
    const auto j = static_cast<Index>(i);
    const double value = figure.times * found->values[j];
    if (figure.name.starts_with("bump_stop") && !(value > 0.0)) return {};
    const double by_scale = figure.power * std::hypot(level, kGain) * value;
    const double by_motion = figure.times * std::sqrt(found->covariance(j, j));
    refined.emplace_back(figure.name, Estimate{value, std::hypot(by_motion, by_scale)});
  }
  for (const auto& [name, value] : refined) put(name, value, out.explanation);
  if (named)
    put(kFrameGain, gain, out.explanation);
  else if (is_gain)
    out.frame_gain = gain;
  out.notes.push_back(fmt::format(
      "Spring and what bends it are by the frame's own motion on its wheelsets: of its velocity's "
      "square they leave {:.3g}, held out, and the equations' figures {:.3g}.",
      found->held_out.sum(), before_nmse));
  return found->held_out;
}

}  // namespace dampline::app
