// SPDX-License-Identifier: MIT
#include "app/motion/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>

#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/identify/truck_run.hpp"
#include "app/record/rate.hpp"
#include "dampline/estimate/statistics.hpp"

namespace dampline::app {
namespace {

/// A row as it waits, in the core's own time.
struct Waiting {
  std::int64_t tick;
  double deflection_m;
  double velocity_mps;
};

constexpr double kDeflectionLowHz = 0.7;  // Baseline::Corner::k0p7Hz, which the deflection keeps
constexpr double kHighOfRate = 0.27;      // ShortIntegral: within 0.4 % up to there

[[noreturn]] void fail_waiting() {
  throw RunError{
      fmt::format("the rows cannot wait in the temporary folder: {}", std::strerror(errno))};
}

/// 1 - 1 / (1 + (f / corner)^8): what Baseline leaves.
double left_by_baseline(double hz, double corner_hz) {
  return 1.0 - 1.0 / (1.0 + std::pow(hz / corner_hz, 8.0));
}

}  // namespace

MotionNoise motion_noise(double noise_mps2, double rate_hz, double velocity_low_hz,
                         double deflection_low_hz) {
  // y'' = 2 z_b'' - z_1'' - z_2'' has 4 + 1 + 1 times the variance of one sensor, spread evenly
  // from 0 to half the rate; an integral divides by 2 pi f.
  constexpr int kSteps = 20000;
  constexpr double kTwoPi = 6.283185307179586;
  const double end_hz = 0.5 * rate_hz;
  const double density = 6.0 * noise_mps2 * noise_mps2 / end_hz;
  const double step_hz = end_hz / kSteps;
  MotionNoise sum;
  for (int i = 0; i < kSteps; ++i) {
    const double hz = (i + 0.5) * step_hz;
    const double velocity = left_by_baseline(hz, velocity_low_hz) / (kTwoPi * hz);
    const double deflection = velocity * left_by_baseline(hz, deflection_low_hz) / (kTwoPi * hz);
    sum.velocity_mps += density * velocity * velocity * step_hz;
    sum.deflection_m += density * deflection * deflection * step_hz;
  }
  return {std::sqrt(sum.velocity_mps), std::sqrt(sum.deflection_m)};
}

MotionSeries::MotionSeries(const Config& config, const SourceOptions& source, SourceKind kind,
                           bool show_progress) {
  static_cast<void>(estimator_config(config));  // wrong settings before a wrong source
  const auto feed = open_feed(config, source, kind);
  file_.reset(std::tmpfile());  // NOLINT(*-owning-memory): it is owned from here on
  if (!file_) fail_waiting();
  TruckRun<kIdentifyParts> run{config, feed->signals()};
  std::int64_t last_tick = 0;
  run.watch([&](const Sample& /*unused*/, const UpdateResult& result) {
    if (!result.has_motion) return;
    const Waiting row{result.motion.tick, result.motion.deflection_m, result.motion.velocity_mps};
    if (std::fwrite(&row, sizeof row, 1, file_.get()) != 1) fail_waiting();
    if (summary_.rows++ > 0 && row.tick != last_tick + 1) ++summary_.gaps;
    last_tick = row.tick;
  });
  pump(*feed, source, show_progress, run);
  run.close();
  if (summary_.rows == 0)
    throw RunError{fmt::format("{}: gives no motion: {} samples, expected some 8 s without a gap",
                               source.path, run.samples())};
  const double nominal_hz = truck_rate_hz(config.input);
  const RateCorrection correction = make_correction(rate_of(*feed, run), nominal_hz, source.path);
  first_tick_ = run.first_tick();
  summary_.sample_rate_hz = nominal_hz * correction.ratio;
  tick_s_ = 1.0 / summary_.sample_rate_hz;
  deflection_factor_ = correction.deflection();
  velocity_factor_ = correction.velocity();
  const auto statistics = std::make_unique<Statistics>();
  run.core().statistics(*statistics);
  summary_.low_hz = statistics->header.velocity_corner_hz * correction.ratio;
  summary_.deflection_low_hz = kDeflectionLowHz * correction.ratio;
  summary_.high_hz = kHighOfRate * summary_.sample_rate_hz;
  summary_.judgement_s = config.guards.wait_s;
  summary_.latency_s = run.core().estimator().motion_latency_s() + summary_.judgement_s;
  summary_.noise_mps2 = statistics->header.noise_mps2;
  const MotionNoise noise = motion_noise(summary_.noise_mps2, summary_.sample_rate_hz,
                                         summary_.low_hz, summary_.deflection_low_hz);
  summary_.velocity_noise_mps = noise.velocity_mps;
  summary_.deflection_noise_m = noise.deflection_m;
}

void MotionSeries::each(const std::function<void(const MotionRow&)>& row) {
  constexpr std::size_t kBatch = 1024;
  if (std::fflush(file_.get()) != 0 || std::fseek(file_.get(), 0, SEEK_SET) != 0) fail_waiting();
  std::array<Waiting, kBatch> rows;  // NOLINT(*-member-init): read at once
  for (std::uint64_t left = summary_.rows; left > 0;) {
    const std::size_t wanted = std::min<std::uint64_t>(left, kBatch);
    if (std::fread(rows.data(), sizeof(Waiting), wanted, file_.get()) != wanted) fail_waiting();
    for (std::size_t i = 0; i < wanted; ++i)
      row({static_cast<double>(rows[i].tick - first_tick_) * tick_s_,
           deflection_factor_ * rows[i].deflection_m, velocity_factor_ * rows[i].velocity_mps});
    left -= wanted;
  }
}

}  // namespace dampline::app
