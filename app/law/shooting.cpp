// SPDX-License-Identifier: MIT
#include "app/law/shooting.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "app/beside.hpp"
#include "app/law/block_fit.hpp"
#include "app/law/start.hpp"

namespace dampline::app::law {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double kFirstPeriods = 4.0;  // of the motion, in a segment
constexpr Index kFewestSamples = 50;
constexpr double kLonger = 8.0;  // times, from one length of segments to the next
constexpr double kLeastLonger = 1.5;
constexpr double kMuchMore = 4.0;  // times the squares left: longer segments are not followed
constexpr int kRounds = 15;
constexpr int kStateRounds = 6;
constexpr double kArrived = 0.01;    // of a deviation
constexpr double kNearly = 0.3;      // where longer segments follow
constexpr double kLittle = 1e-4;     // of the squares: a step that gains no more is the last
constexpr double kCoarsely = 0.1;    // the same of the states, where the unknowns move them next
constexpr double kTrialGain = 1e-3;  // the same of the unknowns, where forms are compared
constexpr double kFar = 30.0;        // times the motion's range: it ran away
// Of an unknown's scale: where sticking makes the error ragged, wider differences see its course.
constexpr std::array kDifferences{1e-6, 1e-4, 3e-3};
constexpr double kMostMove = 0.5;  // of an unknown that stays above 0
constexpr Index kFewestBlocks = 20;

/// Slopes that are taken: by the states, by the unknowns too, all by differences both ways.
enum class Slopes : std::uint8_t { kOfStates, kAll, kBothWays };

struct Segment {
  std::size_t drive;
  Index begin;
  Index end;  ///< one past the last sample
  State start;
  bool is_first;  ///< of its record: what it remembers is unknown too
};

class Shooting {
 public:
  Shooting(const LawOf& law_of, VectorXd scale, std::vector<bool> positive,
           const std::vector<Drive>& drives)
      : law_of_{law_of}, scale_{std::move(scale)}, positive_{std::move(positive)}, drives_{drives} {
    for (const Drive& d : drives) {
      const double mean = d.deflection_m.mean();
      const double period_s = period_of(d.deflection_m, d.velocity_mps);
      if (std::isfinite(period_s)) period_s_ = std::max(period_s_, period_s);
      range_m_ = std::max(range_m_, d.deflection_m.maxCoeff() - d.deflection_m.minCoeff());
      samples_ += d.deflection_m.size();
      for (Index i = 0; i < d.deflection_m.size(); ++i)
        if (counts(d, i)) variance_m2_ += std::pow(d.deflection_m[i] - mean, 2);
    }
    if (!(period_s_ > 0.0)) period_s_ = 1.0;
  }

  Shot fit(VectorXd unknowns, Reach reach);
  Shot follow(const VectorXd& unknowns, double segment_s);

 private:
  static bool counts(const Drive& d, Index i) { return d.counts.size() == 0 || d.counts[i] > 0.0; }
  [[nodiscard]] double interval_s() const { return drives_.front().input.interval_s(); }

  void cut(Index samples);
  [[nodiscard]] bool run(const FreeRun& law, const Segment& s, State& state, VectorXd& out) const;
  [[nodiscard]] double squares_of(const VectorXd& unknowns, std::vector<Segment>& segments,
                                  const std::vector<Segment>& others = {}) const;
  [[nodiscard]] double state_step(const Segment& s, const std::vector<Regressor>& memories,
                                  Index k) const;
  [[nodiscard]] bool follow_segments(const Law& law, int refinement, std::size_t memories,
                                     Index unknowns, std::vector<Linear>& out);
  [[nodiscard]] bool linearise(const VectorXd& unknowns, int refinement, Slopes kind,
                               std::vector<Linear>& out);
  [[nodiscard]] std::vector<Segment> moved(const std::vector<Linear>& parts,
                                           const VectorXd& by) const;
  bool settle(const VectorXd& unknowns, double little);
  bool descend(VectorXd& unknowns, double enough, double little, double& squares);
  [[nodiscard]] std::vector<Sums> blocks_of(const std::vector<Linear>& parts, Reach reach) const;
  [[nodiscard]] std::optional<LeftDensity> density_of(const std::vector<Linear>& parts) const;
  [[nodiscard]] Shot shot_of(const VectorXd& unknowns, double squares) const;
  Shot judge(const VectorXd& unknowns, double squares, Reach reach);

  const LawOf& law_of_;
  VectorXd scale_;
  std::vector<bool> positive_;
  const std::vector<Drive>& drives_;
  std::vector<Segment> segments_;
  Index length_{0};
  Index samples_{0};
  double difference_{kDifferences[0]};
  double variance_m2_{0.0};  ///< summed
  double range_m_{0.0};
  double period_s_{0.0};
};

/// Segments of so many samples; where there were some, their states stay.
void Shooting::cut(Index samples) {
  const std::vector<Segment> before = std::move(segments_);
  segments_.clear();
  length_ = samples;
  for (std::size_t d = 0; d < drives_.size(); ++d) {
    const Index size = drives_[d].deflection_m.size();
    const Index count = std::max<Index>(1, size / samples);
    for (Index k = 0; k < count; ++k) {
      Segment s{d, k * samples, k + 1 == count ? size : (k + 1) * samples, {}, k == 0};
      const auto same = std::find_if(before.begin(), before.end(), [&](const Segment& other) {
        return other.drive == d && other.begin == s.begin;
      });
      if (same != before.end()) {
        s.start = same->start;
      } else {
        s.start.deflection_m = drives_[d].deflection_m[s.begin];
        s.start.velocity_mps = drives_[d].velocity_mps[s.begin];
      }
      segments_.push_back(s);
    }
  }
}

/// The deflection over a segment from `state`, which ends where the segment does; false where it
/// runs away.
bool Shooting::run(const FreeRun& law, const Segment& s, State& state, VectorXd& out) const {
  out.resize(s.end - s.begin);
  const double farthest_m = kFar * range_m_;
  for (Index i = s.begin; i < s.end; ++i) {
    out[i - s.begin] = state.deflection_m;
    if (!(std::abs(state.deflection_m) < farthest_m)) return false;
    if (i + 1 < drives_[s.drive].input.size()) law.advance(i, state);
  }
  return true;
}

VectorXd left_of(const Drive& d, Index begin, const VectorXd& deflection_m) {
  VectorXd out = deflection_m - d.deflection_m.segment(begin, deflection_m.size());
  if (d.counts.size() > 0)
    out.array() *= (d.counts.segment(begin, deflection_m.size()).array() > 0.0).cast<double>();
  return out;
}

/// What is left in all; hands on what the terms remember. Where there are other starts, each
/// segment takes the one that leaves less: what holds the mass hides its start, and a step there
/// goes astray.
double Shooting::squares_of(const VectorXd& unknowns, std::vector<Segment>& segments,
                            const std::vector<Segment>& others) const {
  const Law law = law_of_(unknowns);
  double out = 0.0;
  State end;
  VectorXd path;
  const auto left = [&](Segment& s, const State& before, State& after) {
    if (!s.is_first) {
      s.start.memory_m = before.memory_m;
      s.start.slip_m = before.slip_m;
    }
    after = s.start;
    const Drive& d = drives_[s.drive];
    return run(FreeRun{law, d.input}, s, after, path) ? left_of(d, s.begin, path).squaredNorm()
                                                      : std::numeric_limits<double>::infinity();
  };
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const State before = end;
    double least = left(segments[i], before, end);
    if (!others.empty()) {
      Segment other = others[i];
      State after;
      if (const double there = left(other, before, after); there < least) {
        least = there;
        segments[i] = other;
        end = after;
      }
    }
    out += least;
    if (!std::isfinite(out)) return out;
  }
  return out;
}

/// A state with its k-th figure moved: deflection, velocity, then what is remembered.
State moved_state(State s, Index k, double by) {
  if (k == 0)
    s.deflection_m += by;
  else if (k == 1)
    s.velocity_mps += by;
  else
    s.memory_m[static_cast<std::size_t>(k - 2)] += by;
  return s;
}

/// By which the k-th figure of a segment's first state is moved.
double Shooting::state_step(const Segment& s, const std::vector<Regressor>& memories,
                            Index k) const {
  if (k == 0) return kDifferences[0] * range_m_;
  if (k == 1) return kDifferences[0] * range_m_ * 2.0 * std::numbers::pi / period_s_;
  const auto m = static_cast<std::size_t>(k - 2);
  const double size = memories[m].kind == Kind::kMaxwell ? range_m_ : memories[m].a;
  return s.start.memory_m[m] > 0.0 ? -kDifferences[0] * size : kDifferences[0] * size;
}

/// What is left of each segment, with room for its slopes; hands on what the terms remember.
bool Shooting::follow_segments(const Law& law, int refinement, std::size_t memories, Index unknowns,
                               std::vector<Linear>& out) {
  out.clear();
  State end;
  VectorXd path;
  for (Segment& s : segments_) {
    const Drive& d = drives_[s.drive];
    if (!s.is_first) {
      s.start.memory_m = end.memory_m;
      s.start.slip_m = end.slip_m;
    }
    end = s.start;
    if (!run(FreeRun{law, d.input, refinement}, s, end, path)) return false;
    const Index figures = 2 + (s.is_first ? static_cast<Index>(memories) : 0);
    out.push_back({left_of(d, s.begin, path), MatrixXd{path.size(), unknowns},
                   MatrixXd{path.size(), figures}});
  }
  return true;
}

/// The slopes are taken beside one another: a run of the law each, which is what all this costs.
bool Shooting::linearise(const VectorXd& unknowns, int refinement, Slopes kind,
                         std::vector<Linear>& out) {
  const Index p = kind == Slopes::kOfStates ? 0 : unknowns.size();
  const Law law = law_of_(unknowns);
  const std::vector<Regressor> memories = memories_of(law);
  if (!follow_segments(law, refinement, memories.size(), p, out)) return false;
  // Of a segment, a column: of the unknowns, then of the state.
  std::vector<std::pair<std::size_t, Index>> slopes;
  for (std::size_t i = 0; i < out.size(); ++i)
    for (Index k = 0; k < p + out[i].by_state.cols(); ++k) slopes.emplace_back(i, k);
  std::atomic<bool> stayed{true};
  each_beside(slopes.size(), [&](std::size_t n) {
    if (!stayed) return;
    const std::size_t segment = slopes[n].first;
    const Index j = slopes[n].second;
    const Segment& s = segments_[segment];
    const Drive& d = drives_[s.drive];
    Linear& l = out[segment];
    const bool of_law = j < p;
    const double step = of_law ? difference_ * scale_[j] : state_step(s, memories, j - p);
    const auto left_at = [&](double by, VectorXd& left) {
      VectorXd there = unknowns;
      if (of_law) there[j] += by;
      const Law law_there = of_law ? law_of_(there) : law;
      State from = of_law ? s.start : moved_state(s.start, j - p, by);
      if (!run(FreeRun{law_there, d.input, refinement}, s, from, left)) return false;
      left = left_of(d, s.begin, left);
      return true;
    };
    VectorXd ahead;
    VectorXd behind = l.left;
    const bool both = kind == Slopes::kBothWays && j < p + 2;
    if (!left_at(step, ahead) || (both && !left_at(-step, behind))) {
      stayed = false;
      return;
    }
    auto column = of_law ? l.by_unknowns.col(j) : l.by_state.col(j - p);
    column = (ahead - behind) / (both ? 2.0 * step : step);
  });
  return stayed;
}

/// The segments with the states that a step of the unknowns asks for.
std::vector<Segment> Shooting::moved(const std::vector<Linear>& parts, const VectorXd& by) const {
  std::vector<Segment> out = segments_;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    VectorXd left = parts[i].left;
    if (by.size() > 0) left += parts[i].by_unknowns * by;
    const VectorXd step = parts[i].by_state.colPivHouseholderQr().solve(-left);
    for (Index k = 0; k < step.size(); ++k) out[i].start = moved_state(out[i].start, k, step[k]);
  }
  return out;
}

/// Fits the states alone, until a step gains `little` of the squares.
bool Shooting::settle(const VectorXd& unknowns, double little) {
  double squares = squares_of(unknowns, segments_);
  std::vector<Linear> parts;
  for (int i = 0; i < kStateRounds; ++i) {
    if (!linearise(unknowns, 1, Slopes::kOfStates, parts)) return false;
    std::vector<Segment> there = moved(parts, {});
    const double then = squares_of(unknowns, there, segments_);
    if (!(then < squares)) break;
    const bool enough = then > (1.0 - little) * squares;
    segments_ = std::move(there);
    squares = then;
    if (enough) break;
  }
  return std::isfinite(squares);
}

/// Levenberg and Marquardt over the unknowns, until a step goes `enough` deviations or gains
/// `little` of the squares; false where no step could be tried.
bool Shooting::descend(VectorXd& unknowns, double enough, double little, double& squares) {
  squares = squares_of(unknowns, segments_);
  double damping = 1e-3;
  std::size_t width = 0;
  std::vector<Linear> parts;
  for (int round = 0; round < kRounds; ++round) {
    if (!linearise(unknowns, 1, Slopes::kAll, parts)) return false;
    const Sums sums = sum_of(parts);
    const VectorXd diagonal = sums.products.diagonal();
    bool better = false;
    bool arrived = false;
    for (int tries = 0; tries < 8 && !better; ++tries, damping *= 10.0) {
      MatrixXd damped = sums.products;
      damped.diagonal() += damping * diagonal;
      const Eigen::LDLT<MatrixXd> factor{damped};
      VectorXd by = -factor.solve(sums.gradient);
      for (Index j = 0; j < by.size(); ++j)
        if (positive_[static_cast<std::size_t>(j)])
          by[j] = std::clamp(by[j], -kMostMove * unknowns[j], kMostMove * unknowns[j]);
      std::vector<Segment> there = moved(parts, by);
      const double then = squares_of(unknowns + by, there, segments_);
      if (!(then < squares)) continue;
      const double variance = sums.squares / static_cast<double>(samples_);
      const MatrixXd inverse = factor.solve(MatrixXd::Identity(by.size(), by.size()));
      arrived = (by.array().abs() < enough * (variance * inverse.diagonal().array().abs()).sqrt() +
                                        1e-9 * scale_.array())
                    .all();
      arrived = arrived || (damping < 0.1 && then > (1.0 - little) * squares);
      unknowns += by;
      segments_ = std::move(there);
      squares = then;
      better = true;
      damping *= 0.03;
    }
    if (arrived) break;
    if (!better && ++width == kDifferences.size()) break;
    if (!better) damping = 1e-3;
    difference_ = kDifferences[width];
    damping = std::clamp(damping, 1e-9, 1.0);
  }
  difference_ = kDifferences[0];
  return true;
}

/// Blocks in time, two periods of the motion long where there are enough of them, or as long as the
/// segments, over which a noisy force's motion stays alike.
std::vector<Sums> Shooting::blocks_of(const std::vector<Linear>& parts, Reach reach) const {
  const Index wanted =
      reach == Reach::kFirstSegments ? length_ : static_cast<Index>(2.0 * period_s_ / interval_s());
  const Index block = std::max<Index>(1, std::min(wanted, samples_ / kFewestBlocks));
  std::vector<Sums> out;
  for (const Linear& l : parts) append_blocks(l.by_unknowns, l.left, block, out);
  return out;
}

std::optional<LeftDensity> Shooting::density_of(const std::vector<Linear>& parts) const {
  LeftOver spectra;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Drive& d = drives_[segments_[k].drive];
    if (segments_[k].is_first) spectra.gap();
    for (Index i = 0; i < parts[k].left.size(); ++i) {
      const Index at = segments_[k].begin + i;
      if (counts(d, at))
        spectra.add(d.deflection_m[at] + parts[k].left[i], parts[k].left[i]);
      else
        spectra.gap();
    }
  }
  return spectra.density();
}

/// Before anything is known of its deviations.
Shot Shooting::shot_of(const VectorXd& unknowns, double squares) const {
  Shot out;
  out.ok = std::isfinite(squares);
  out.unknowns = unknowns;
  out.nmse = out.held_out_nmse = squares / variance_m2_;
  out.residual_m = std::sqrt(squares / static_cast<double>(samples_));
  out.segment_s = static_cast<double>(length_) * interval_s();
  out.segments = segments_.size();
  out.start = segments_.front().start;
  return out;
}

Shot Shooting::judge(const VectorXd& unknowns, double squares, Reach reach) {
  std::vector<Linear> parts;
  // What the unknowns share cancels, and the error of one way would be left in their deviations.
  const bool trial = reach == Reach::kTrial;
  const Slopes slopes = trial ? Slopes::kAll : Slopes::kBothWays;
  if (!std::isfinite(squares) || !linearise(unknowns, 1, slopes, parts)) return {};
  const Index p = unknowns.size();
  std::vector<Linear> clean;
  clean.reserve(parts.size());
  for (const Linear& each : parts) clean.push_back(beside_state(each));
  const BlockFit fit{blocks_of(clean, reach)};
  if (!fit.ok()) return {};
  Shot out = shot_of(unknowns, squares);
  out.covariance = fit.covariance(static_cast<double>(samples_ - p) -
                                  2.0 * static_cast<double>(segments_.size()));
  // Steps twice as fine would go this much farther.
  std::vector<Linear> fine;
  if (!trial && linearise(unknowns, 2, Slopes::kOfStates, fine)) {
    VectorXd gradient = VectorXd::Zero(p);
    for (std::size_t i = 0; i < fine.size(); ++i)
      gradient += clean[i].by_unknowns.transpose() * (fine[i].left - parts[i].left);
    const VectorXd by = fit.solve(gradient);
    out.covariance += by * by.transpose();
  }
  out.held_out_nmse = fit.held_out_squares().sum() / variance_m2_;
  out.density = density_of(parts);
  return out;
}

Shot Shooting::fit(VectorXd unknowns, Reach reach) {
  Index longest = 0;
  for (const Drive& d : drives_) longest = std::max(longest, d.deflection_m.size());
  auto length =
      std::max(kFewestSamples, static_cast<Index>(kFirstPeriods * period_s_ / interval_s()));
  length = std::min(length, longest);
  if (reach != Reach::kWhole) longest = length;
  cut(length);
  if (!settle(unknowns, kCoarsely)) return {};
  const Index first = length;
  double squares = 0.0;
  const bool is_trial = reach == Reach::kTrial;
  const bool is_last = length >= longest && !is_trial;
  const double little = is_trial ? kTrialGain : kLittle;
  if (!descend(unknowns, is_last ? kArrived : kNearly, little, squares)) return {};
  double longer = kLonger;
  while (length < longest && longer > kLeastLonger) {
    const VectorXd before = unknowns;
    const std::vector<Segment> segments = segments_;
    const Index shorter = length;
    length = static_cast<Index>(longer * static_cast<double>(length));
    if (2 * length > longest) length = longest;  // a segment takes the rest with it
    cut(length);
    double then = 0.0;
    if (settle(unknowns, kCoarsely) &&
        descend(unknowns, length < longest ? kNearly : kArrived, kLittle, then) &&
        then < kMuchMore * squares) {
      squares = then;
      continue;
    }
    unknowns = before;
    segments_ = segments;
    length = length_ = shorter;
    longer = std::sqrt(longer);
  }
  Shot out = judge(unknowns, squares, reach);
  out.first_segment_s = static_cast<double>(first) * interval_s();
  return out;
}

Shot Shooting::follow(const VectorXd& unknowns, double segment_s) {
  cut(static_cast<Index>(std::lround(segment_s / interval_s())));
  const Law law = law_of_(unknowns);
  std::vector<Linear> parts;
  if (!settle(unknowns, kLittle) || !follow_segments(law, 1, memories_of(law).size(), 0, parts))
    return {};
  double squares = 0.0;
  for (const Linear& l : parts) squares += l.left.squaredNorm();
  Shot out = shot_of(unknowns, squares);
  out.density = density_of(parts);
  return out;
}

}  // namespace

Shot shoot(const LawOf& law_of, const VectorXd& start, const VectorXd& scale,
           const std::vector<bool>& positive, const std::vector<Drive>& drives, Reach reach) {
  return Shooting{law_of, scale, positive, drives}.fit(start, reach);
}

Shot follow(const LawOf& law_of, const VectorXd& unknowns, const std::vector<Drive>& drives,
            double segment_s) {
  return Shooting{law_of, VectorXd::Ones(unknowns.size()), {}, drives}.follow(unknowns, segment_s);
}

}  // namespace dampline::app::law
