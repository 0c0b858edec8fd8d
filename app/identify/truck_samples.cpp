// SPDX-License-Identifier: MIT
#include "app/identify/truck_samples.hpp"

#include <fmt/format.h>

#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/identify/truck_run.hpp"
#include "app/record/rate.hpp"

namespace dampline::app {

std::vector<TruckSamples::Stretch> TruckSamples::stretches() const {
  std::vector<Stretch> out;
  const auto shortest = static_cast<Eigen::Index>(kShortestS * rate_hz);
  Eigen::Index from = 0;
  const auto count = static_cast<Eigen::Index>(tick.size());
  for (Eigen::Index i = 1; i <= count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (i < count && tick[at] == tick[at - 1] + 1) continue;
    if (i - from >= shortest) out.push_back({from, i});
    from = i;
  }
  return out;
}

TruckSamples read_truck_samples(const Config& config, const SourceOptions& source, SourceKind kind,
                                double most_s) {
  static_cast<void>(estimator_config(config));
  const auto feed = open_feed(config, source, kind);
  TruckRun<kIdentifyParts> run{config, feed->signals()};
  const double nominal_hz = truck_rate_hz(config.input);
  TruckSamples out;
  run.watch([&](const Sample& sample, const UpdateResult& /*unused*/) {
    if (sample.spoilt || static_cast<double>(out.tick.size()) >= most_s * nominal_hz) return;
    out.tick.push_back(sample.tick);
    out.frame_mps2.push_back(sample.accel_mps2[0]);
    out.wheelsets_mps2.push_back(sample.accel_mps2[1] + sample.accel_mps2[2]);
  });
  pump(*feed, source, false, run);
  run.close();
  if (out.tick.size() < 2)
    throw RunError{
        fmt::format("{}: found {} samples, expected some seconds", source.path, out.tick.size())};
  out.rate_hz = nominal_hz * make_correction(rate_of(*feed, run), nominal_hz, source.path).ratio;
  return out;
}

}  // namespace dampline::app
