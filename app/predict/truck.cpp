// SPDX-License-Identifier: MIT
#include "app/predict/truck.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <vector>

#include "app/error.hpp"
#include "app/identify/truck_samples.hpp"
#include "app/record/columns.hpp"
#include "app/record/rate.hpp"
#include "app/record/source_kind.hpp"

namespace dampline::app {
namespace {

constexpr double kSettleS = 5.0;  // after a start at rest, until the motion is the record's
constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

/// Mean over an interval on either side of each sample, as a difference of a velocity gives it, of
/// what is band-limited between samples. The ends as they are.
Eigen::VectorXd smoothed(const Eigen::VectorXd& values) {
  constexpr Eigen::Index kParts = law::Input::kFine;
  const law::Input between{values, 1.0};
  const Eigen::Index last = values.size() - 1;
  Eigen::VectorXd mean{last};  // over each interval, by the trapezoidal rule
  for (Eigen::Index i = 0; i < last; ++i) {
    mean[i] = 0.5 * (values[i] + values[i + 1]);
    for (Eigen::Index k = 1; k < kParts; ++k)
      mean[i] += between.at(i, static_cast<double>(k) / kParts);
    mean[i] /= kParts;
  }
  Eigen::VectorXd out = values;
  for (Eigen::Index i = 1; i < last; ++i) out[i] = 0.5 * (mean[i - 1] + mean[i]);
  return out;
}

/// Deflection and frame acceleration of all samples one behind the other, NaN between stretches;
/// empty where the law runs away.
Eigen::VectorXd moved(const law::Law& law, const TruckSamples& samples,
                      const std::vector<TruckSamples::Stretch>& stretches) {
  const auto count = static_cast<Eigen::Index>(samples.tick.size());
  Eigen::VectorXd out = Eigen::VectorXd::Constant(2 * count, kNowhere);
  const double interval_s = 1.0 / samples.rate_hz;
  for (const TruckSamples::Stretch& s : stretches) {
    const Eigen::Index n = s.to - s.from;
    const Eigen::VectorXd wheels =
        Eigen::Map<const Eigen::VectorXd>(samples.wheelsets_mps2.data() + s.from, n);
    const Eigen::VectorXd push_n = -law.mass_kg * (wheels.array() - wheels.mean());
    const law::Course course =
        law::move(law, law::Input{push_n, interval_s}, {}, TruckSamples::kRefinement);
    if (!course.whole) return {};
    out.segment(s.from, n) = course.deflection_m;
    const Eigen::VectorXd input = smoothed(wheels);
    for (Eigen::Index i = 1; i + 1 < n; ++i)
      out[count + s.from + i] =
          0.5 * ((course.velocity_mps[i + 1] - course.velocity_mps[i - 1]) / (2.0 * interval_s) +
                 input[i]);
  }
  return out;
}

/// The measured frame acceleration where a prediction is to be judged; NaN elsewhere. The mean is
/// the sensor's offset.
Eigen::VectorXd judged(const TruckSamples& samples,
                       const std::vector<TruckSamples::Stretch>& stretches,
                       const Eigen::VectorXd& predicted) {
  const auto count = static_cast<Eigen::Index>(samples.tick.size());
  const Eigen::VectorXd frame = Eigen::Map<const Eigen::VectorXd>(samples.frame_mps2.data(), count);
  Eigen::VectorXd out = Eigen::VectorXd::Constant(count, kNowhere);
  const auto settle = static_cast<Eigen::Index>(kSettleS * samples.rate_hz);
  for (const TruckSamples::Stretch& s : stretches) {
    const Eigen::Index from = s.from + settle;
    const Eigen::Index n = s.to - 1 - from;
    const Eigen::VectorXd seen = smoothed(frame.segment(s.from, s.to - s.from)).segment(settle, n);
    const double offset = seen.mean() - predicted.segment(from, n).mean();
    out.segment(from, n) = seen.array() - offset;
  }
  return out;
}

}  // namespace

Prediction predict_frame(const law::Document& document, const Config& given,
                         const SourceOptions& source) {
  const RecognisedColumns seen = recognise_columns(given, source);
  const SourceKind kind = detect_source(seen.config, source);
  if (kind == SourceKind::kInterface || kind == SourceKind::kRigRows)
    throw UsageError{
        fmt::format("{}: is no truck's record, and the law is a truck's", source.path)};
  const TruckSamples samples =
      read_truck_samples(with_record_rate(seen.config, source, kind), source, kind);
  const std::vector<TruckSamples::Stretch> stretches = samples.stretches();
  if (stretches.empty())
    throw RunError{
        fmt::format("{}: holds no {:.0f} s without a gap", source.path, TruckSamples::kShortestS)};
  const auto count = static_cast<Eigen::Index>(samples.tick.size());
  const auto outcome = [&](const law::Law& law) { return moved(law, samples, stretches); };
  const Eigen::VectorXd values = outcome(document.law);
  if (values.size() == 0)
    throw RunError{fmt::format("{}: the law runs away on these wheelsets", source.path)};
  const Eigen::VectorXd std = deviation_of(document, outcome, values.size());
  Prediction out;
  out.what = "frame motion from wheelsets";
  out.record = source.path;
  out.sample_rate_hz = samples.rate_hz;
  for (const std::string& effect : document.not_in_it)
    out.notes.push_back("Not in the law: " + effect + ".");
  out.notes.push_back(fmt::format(
      "Each stretch without a gap starts at rest; its first {:.0f} s are not judged.", kSettleS));
  Eigen::VectorXd time_s{count};
  for (Eigen::Index i = 0; i < count; ++i)
    time_s[i] = static_cast<double>(samples.tick[static_cast<std::size_t>(i)] - samples.tick[0]) /
                samples.rate_hz;
  out.columns.push_back({"time_s", std::move(time_s)});
  add_quantity("deflection_m", "m", values.head(count), std.head(count), 0.0, {}, 0, out);
  add_quantity("frame_accel_mps2", "m/s^2", values.tail(count), std.tail(count),
               document.residual_mps2, judged(samples, stretches, values.tail(count)), 0, out);
  return out;
}

}  // namespace dampline::app
