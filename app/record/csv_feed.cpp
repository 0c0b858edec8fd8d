// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/error.hpp"
#include "app/record/columns.hpp"
#include "app/record/feed.hpp"
#include "app/record/rate.hpp"
#include "app/record/rows.hpp"
#include "dampline/motion/decimator.hpp"
#include "dampline/sample/hole_bridge.hpp"

namespace dampline::app {

namespace {

constexpr int kMostFactor = 256;

int checked_factor(double rate_hz) {
  const int factor = decimation(rate_hz);
  if (factor > kMostFactor)
    throw UsageError{fmt::format("[input] sample_rate_hz: found {}, expected at most {}", rate_hz,
                                 400 * kMostFactor)};
  return factor;
}

class CsvFeed final : public SampleFeed {
 public:
  CsvFeed(const InputConfig& input, const std::array<bool, kExtras>& extras,
          const SourceOptions& source)
      : input_{input},
        rows_{input, extras, source},
        decimator_{checked_factor(input.sample_rate_hz)} {
    if (decimator_.factor() > 1) raw_screen_.emplace(raw_screen());
    const double first_hz = rows_.first_rate_hz();
    static_cast<void>(
        make_correction(MeasuredRate{first_hz, 0.0, 0}, input.sample_rate_hz, source.path));
    clock_ = RowClock{first_hz > 0.0 ? first_hz : input.sample_rate_hz};
  }

  Batch read() override {
    batch_.clear();
    samples_.clear();
    const bool more = rows_.read(batch_);
    for (const TruckRows::Row& row : batch_) hand_on(to_sample(row));
    if (!more) {
      bridge_.finish();
      thin();
    }
    return {.samples = samples_, .more = more};
  }
  [[nodiscard]] std::optional<MeasuredRate> rate() const override {
    const MeasuredRate rows = clock_.rate();
    const double factor = decimator_.factor();
    return MeasuredRate{rows.rate_hz / factor, rows.std_hz / factor, rows.samples};
  }
  [[nodiscard]] RecordSignals signals() const override {
    RecordSignals out;
    const auto& range = input_.range_mps2;
    out.screen.find_flat_tops = !std::all_of(range.begin(), range.end(),
                                             [](const auto& limit) { return limit.has_value(); });
    return out;
  }
  [[nodiscard]] std::optional<double> share_read() const override {
    return rows_.reader().share_read();
  }
  [[nodiscard]] std::string explain_emptiness(const FrameSummary& /*unused*/) const override {
    return fmt::format("{} rows, {} malformed lines skipped", rows_.reader().health().rows,
                       rows_.reader().health().malformed);
  }
  void describe(const FrameSummary& /*unused*/, RunResult& result) const override {
    result.origin.recorded = clock_.recorded();
    describe_rows(rows_.reader(), result);
    if (decimator_.factor() > 1)
      result.notes.push_back(
          fmt::format("Sampled at {:.6g} Hz; low-passed and thinned by {} to {:.6g} Hz.",
                      clock_.rate().rate_hz, decimator_.factor(), rate()->rate_hz));
  }

 private:
  /// Flat tops are seen before the low pass rounds them.
  [[nodiscard]] ScreenConfig raw_screen() const {
    ScreenConfig raw = signals().screen;
    raw.sample_rate_hz = input_.sample_rate_hz;
    return raw;
  }
  void hand_on(const Sample& sample) {
    Screened screened{sample};
    if (raw_screen_ && !raw_screen_->push(sample, screened)) return;
    if (screened.verdict == Verdict::kSaturated)
      screened.sample.saturated =
          static_cast<std::uint8_t>(screened.sample.saturated | screened.channels);
    if (decimator_.factor() == 1) {
      samples_.push_back(screened.sample);
      return;
    }
    bridge_.push(screened.sample);
    thin();
  }
  // A hole would spoil all that the low pass makes of it, so it is bridged before.
  void thin() {
    for (Sample whole, out; bridge_.pop(whole);)
      if (decimator_.take(whole, out)) samples_.push_back(out);
  }
  [[nodiscard]] Sample to_sample(const TruckRows::Row& row) {
    const RowClock::Stamp stamp = clock_.next(row[0]);
    Sample sample{stamp.tick, stamp.time_ns, {}, 0};
    for (std::size_t c = 0; c < kChannels; ++c) {
      sample.accel_mps2[c] = row[c + 1];
      if (input_.range_mps2[c] && std::fabs(row[c + 1]) >= *input_.range_mps2[c])
        sample.saturated = static_cast<std::uint8_t>(sample.saturated | (1U << c));
    }
    for (std::size_t e = 0; e < kExtras; ++e)
      sample.extra_mps2[e] = static_cast<float>(row[1 + kChannels + e]);
    return sample;
  }

  InputConfig input_;
  TruckRows rows_;
  std::vector<TruckRows::Row> batch_;
  std::vector<Sample> samples_;
  RowClock clock_{1.0};
  HoleBridge bridge_;
  Decimator<kMostFactor> decimator_;
  std::optional<SampleScreen> raw_screen_;
};

}  // namespace

std::unique_ptr<SampleFeed> open_csv_feed(const Config& config, const SourceOptions& source) {
  return std::make_unique<CsvFeed>(config.input, config.car.extras(), source);
}

}  // namespace dampline::app
