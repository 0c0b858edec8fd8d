// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/strokes.hpp"

#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {
namespace {

constexpr Eigen::Index kPeakSamples = 5;
constexpr double kTrembling = 0.1;    // of the longest stroke: a reversal's noise
constexpr double kLikeStroke = 0.15;  // of the length
constexpr std::size_t kFewestStrokes = 6;
constexpr double kLikeShare = 0.6;  // of all strokes: otherwise the motion repeats nothing

struct Stroke {
  int side{0};
  double length_m{0.0};
  double share{0.0};  ///< the force's peak over the model's, less 1
};

Eigen::VectorXd force_of(const Model& model, const Series& record) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(record.size());
  for (std::size_t c = 0; c < model.columns.size(); ++c)
    out += model.fit.theta[static_cast<Eigen::Index>(c)] * evaluate(model.columns[c], record);
  return out;
}

/// The largest mean of a few samples.
double peak_of(const Eigen::VectorXd& force_n, int side, Eigen::Index begin, Eigen::Index end) {
  double out = 0.0;
  for (Eigen::Index i = begin; i + kPeakSamples <= end; ++i)
    out = std::max(out, side * force_n.segment(i, kPeakSamples).mean());
  return out;
}

Stroke stroke_of(const Series& record, const Eigen::VectorXd& force, Eigen::Index begin,
                 Eigen::Index end) {
  Stroke out;
  out.side = record.velocity_mps[begin] > 0.0 ? 1 : -1;
  out.length_m = std::abs(record.deflection_m[end - 1] - record.deflection_m[begin]);
  const double made_n = peak_of(force, out.side, begin, end);
  if (made_n > 0.0) out.share = peak_of(record.force_n, out.side, begin, end) / made_n - 1.0;
  return out;
}

std::vector<Stroke> strokes_of(const Series& record, const Model& model, int side) {
  const Eigen::VectorXd force = force_of(model, record);
  std::vector<Stroke> out;
  Eigen::Index begin = 0;
  for (Eigen::Index i = 1; i <= record.size(); ++i) {
    const bool goes_on =
        i < record.size() && record.velocity_mps[i] * record.velocity_mps[begin] > 0.0;
    if (goes_on) continue;
    const bool whole = begin > 0 && i < record.size() && record.why_left_out(begin) == 0.0 &&
                       record.why_left_out(i - 1) == 0.0;
    const Stroke stroke = stroke_of(record, force, begin, i);
    if (whole && stroke.side == side) out.push_back(stroke);
    begin = i;
  }
  return out;
}

/// Those of the usual length; none where there is no usual one.
std::vector<Stroke> like_ones(std::vector<Stroke> strokes) {
  double longest_m = 0.0;
  for (const Stroke& s : strokes) longest_m = std::max(longest_m, s.length_m);
  std::erase_if(strokes, [&](const Stroke& s) { return s.length_m < kTrembling * longest_m; });
  std::vector<double> lengths;
  lengths.reserve(strokes.size());
  for (const Stroke& s : strokes) lengths.push_back(s.length_m);
  if (lengths.size() < kFewestStrokes) return {};
  std::sort(lengths.begin(), lengths.end());
  const double usual_m = lengths[lengths.size() * 2 / 3];
  const std::size_t all = strokes.size();
  std::erase_if(strokes, [&](const Stroke& s) {
    return std::abs(s.length_m - usual_m) > kLikeStroke * usual_m;
  });
  const double share = static_cast<double>(strokes.size()) / static_cast<double>(all);
  if (share < kLikeShare) strokes.clear();
  return strokes;
}

StrokeChange change_of(const std::vector<Stroke>& strokes, int side) {
  StrokeChange out;
  out.side = side;
  out.strokes = strokes.size();
  const auto n = static_cast<double>(strokes.size());
  double mean = 0.0;
  for (const Stroke& s : strokes) mean += s.share / n;
  double squares = 0.0;
  double steps = 0.0;
  double low = strokes.front().share;
  double high = low;
  std::vector<double> step;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    squares += (strokes[i].share - mean) * (strokes[i].share - mean);
    low = std::min(low, strokes[i].share);
    high = std::max(high, strokes[i].share);
    if (i == 0) continue;
    step.push_back(std::abs(strokes[i].share - strokes[i - 1].share));
    steps += 0.5 * step.back() * step.back();
  }
  out.spread = std::sqrt(squares / (n - 1.0));
  out.scatter = squares > 0.0 ? steps / squares : 1.0;
  out.range = {(high - low) / (1.0 + mean), 1.4826 * median_of(step)};
  return out;
}

}  // namespace

std::optional<StrokeChange> change_of_strokes(const std::vector<Series>& records,
                                              const Model& model) {
  std::optional<StrokeChange> out;
  for (const int side : {1, -1}) {
    std::vector<Stroke> strokes;
    for (const Series& record : records)
      for (const Stroke& s : like_ones(strokes_of(record, model, side))) strokes.push_back(s);
    if (records.size() > 1 || strokes.size() < kFewestStrokes - 1) continue;
    const StrokeChange change = change_of(strokes, side);
    if (change.spread < kStrokesDiffer || change.scatter > kInOrder) continue;
    if (!out || change.spread > out->spread) out = change;
  }
  return out;
}

}  // namespace dampline::app::rig
