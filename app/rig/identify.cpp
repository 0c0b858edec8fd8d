// SPDX-License-Identifier: MIT
#include "app/rig/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "app/error.hpp"
#include "app/identify/collected.hpp"
#include "app/rig/record.hpp"
#include "app/rig/result.hpp"
#include "dampline/rig/survey.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kPasses = 3.0;
constexpr std::uint64_t kRowsPerProgress = 4096;

/// One record on its way through the three passes.
class Job {
 public:
  Job(const Record& record, const Config& config, const Progress& progress)
      : record_{record}, model_{config.model}, progress_{progress} {
    findings_.terms = terms_of(model_);
    // Of a base of other effects alone: counts and curve need a term; explain puts its law there.
    core::Terms& terms = findings_.terms;
    if (!searched_base(model_).empty() && term_names(terms).empty())
      terms.coulomb = core::Branches::kCommon;
  }

  RunResult run() {
    interval_s_ = measure_interval_s(record_);
    survey();
    identify();
    return replay();
  }

 private:
  template <class Take>
  Clock pass(double number, Take take) {
    source_ = record_.open();
    Clock clock{record_.name, interval_s_};
    Line line;
    while (source_->next(line)) {
      take(clock.sample(line), *source_);
      if (progress_ && rows_ > 0 && clock.rows() % kRowsPerProgress == 0)
        progress_((number + static_cast<double>(clock.rows()) / static_cast<double>(rows_)) /
                  kPasses);
    }
    clock.check_uniform();
    return clock;
  }

  void survey();
  void identify();
  void choose_branches();
  [[noreturn]] void fail(const std::string& what) const {
    throw RunError{record_.name + ": " + what};
  }
  RunResult replay();
  void note(const core::Sample& sample, core::Status status);

  const Record& record_;
  const ModelConfig& model_;
  const Progress& progress_;
  Findings findings_;
  double interval_s_{0.0};
  std::uint64_t rows_{0};
  std::int64_t last_tick_{-1};
  std::unique_ptr<core::Identifier> identifier_;
  ExcludedList excluded_;
  std::unique_ptr<Source> source_;  ///< of the newest pass
};

void Job::survey() {
  std::unique_ptr<core::Survey> survey;
  const Clock clock = pass(0.0, [&](const core::Sample& sample, const Source& source) {
    if (!survey) survey = std::make_unique<core::Survey>(1.0 / interval_s_, source.has_velocity());
    survey->update(sample);
    findings_.ticks = sample.tick + 1;
  });
  rows_ = clock.rows();
  const auto suggested = survey->suggest(findings_.terms, model_.rig_corner_hz.value_or(0.0));
  if (!suggested && suggested.error() == Errc::kNotReady)
    fail("deflection_m: found no motion, expected a record of a rig that moves");
  if (!suggested)
    fail(
        fmt::format("[model] rig_corner_hz: found {:g} Hz at a sample rate of {:.6g} Hz, expected "
                    "{:.3g} to {:.3g} Hz",
                    model_.rig_corner_hz.value_or(0.0), 1.0 / interval_s_, 1e-3 / interval_s_,
                    1.0 / (6.5 * interval_s_)));
  findings_.config = suggested.value();
  findings_.config.sample_rate_hz = 1.0 / clock.mean_interval_s();
  if (model_.curve_nodes_mps.size() == kCurveSegments)
    std::copy(model_.curve_nodes_mps.begin(), model_.curve_nodes_mps.end(),
              findings_.config.curve_nodes_mps.begin());
  if (!check(findings_.config)) fail("[model] curve_nodes_mps: expected ascending speeds above 0");
}

void Job::note(const core::Sample& sample, core::Status status) {
  const double rate_hz = findings_.config.sample_rate_hz;
  const auto seconds = [&](std::int64_t tick) { return static_cast<double>(tick) / rate_hz; };
  if (sample.tick > last_tick_ + 1)
    excluded_.add(seconds(last_tick_ + 1), seconds(sample.tick), "gap in the record");
  if (status == core::Status::kNotFinite)
    excluded_.add(seconds(sample.tick), seconds(sample.tick + 1), "a value that is no number");
  last_tick_ = std::max(last_tick_, sample.tick);
}

void Job::identify() {
  identifier_ = std::make_unique<core::Identifier>(findings_.config);
  pass(1.0, [&](const core::Sample& sample, const Source&) {
    note(sample, identifier_->update(sample));
  });
  choose_branches();
  findings_.snapshot = identifier_->snapshot(findings_.terms);
  findings_.latency_samples = identifier_->latency_samples();
  const core::Counts& counts = identifier_->counts();
  if (!findings_.snapshot.valid)
    fail(fmt::format(
        "found {} usable equations in {} samples ({} gaps, {} samples that are no number, {} "
        "equations "
        "at standstill), too few to determine the model; expected a longer or livelier record",
        counts.rows, counts.samples, counts.gaps, counts.not_finite, counts.rows_still));
  if (findings_.terms.stiffness) return;
  core::Terms terms = findings_.terms;
  terms.stiffness = true;
  findings_.with_spring = identifier_->snapshot(terms);
}

/// Levels of both directions where they differ and no constant force is there to tell them apart.
void Job::choose_branches() {
  constexpr double kWorthATerm = 0.99;  // of the held-out error
  if (findings_.terms.coulomb != core::Branches::kCommon || findings_.terms.offset) return;
  core::Terms split = findings_.terms;
  split.coulomb = core::Branches::kSeparate;
  const core::Solution one = identifier_->solution(findings_.terms);
  const core::Solution two = identifier_->solution(split);
  if (!one.valid || !two.valid) return;
  if (two.held_out_nmse < kWorthATerm * one.held_out_nmse) findings_.terms = split;
}

RunResult Job::replay() {
  const core::Config& config = findings_.config;
  History history{findings_.terms, findings_.snapshot, findings_.ticks, config.sample_rate_hz};
  Excerpt excerpt{config.still_mps, config.sample_rate_hz};
  const auto again = std::make_unique<core::Identifier>(config);
  const auto predictor = std::make_unique<core::Predictor>(
      config, identifier_->solution(findings_.terms), identifier_->block_samples());
  core::Prediction prediction;
  const Clock clock = pass(2.0, [&](const core::Sample& sample, const Source&) {
    again->update(sample);
    history.take(sample.tick, *again);
    if (!predictor->update(sample, prediction)) return;
    if (std::abs(prediction.velocity_mps) < config.still_mps) ++findings_.still_samples;
    excerpt.take(prediction);
  });
  findings_.errors = predictor->errors();
  RunResult result = result_of(findings_);
  result.origin.recorded = clock.recorded();
  result.convergence = history.convergence();
  excerpt.move_to(result);
  result.excluded = excluded_.list();
  result.excluded_more = excluded_.more();
  source_->report(result);
  result.faults = record_.faults;
  return result;
}

}  // namespace

RunResult identify(const Record& record, const Config& config, const Progress& progress) {
  return Job{record, config, progress}.run();
}

}  // namespace dampline::app::rig
