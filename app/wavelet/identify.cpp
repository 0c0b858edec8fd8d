// SPDX-License-Identifier: MIT
#include "app/wavelet/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/error.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "app/wavelet/fit.hpp"

namespace dampline::app::wavelet {
namespace {

bool has_inertia(const std::vector<std::vector<RunTimeTerm>>& elements) {
  for (const auto& terms : elements)
    for (const RunTimeTerm& term : terms)
      if (term.kind == TermKind::kInertia) return true;
  return false;
}

std::vector<std::vector<RunTimeTerm>> elements_of(const Settings& settings) {
  if (settings.terms.empty())
    throw UsageError{"--terms: found none, expected terms, with commas between, of\n" +
                     vocabulary_text()};
  const auto masses = static_cast<std::size_t>(settings.record.masses);
  if (settings.terms.size() > masses)
    throw UsageError{fmt::format("--terms: found {} sets, expected {} (--masses)",
                                 settings.terms.size(), masses)};
  std::vector<std::vector<RunTimeTerm>> out;
  for (std::size_t e = 0; e < masses; ++e)
    out.push_back(parse_terms(settings.terms[std::min(e, settings.terms.size() - 1)]));
  return out;
}

void check_masses(const Settings& settings, bool inertia, bool accelerations) {
  const std::size_t masses = settings.mass_kg.size();
  if (masses != 0 && masses != static_cast<std::size_t>(settings.record.masses))
    throw UsageError{
        fmt::format("--mass: found {} values, expected {}", masses, settings.record.masses)};
  if (!inertia) return;
  if (accelerations)
    throw UsageError{
        "--terms: found 'a', but accelerations alone do not tell a mass: expected "
        "other terms; --mass states it"};
  if (masses > 0)
    throw UsageError{
        "--mass: found beside the term 'a', which identifies it; expected one of them"};
}

/// The file's own sign of the force: where a mass is driven, it is what drives.
void restore_force(Measured& measured) {
  if (measured.file_force_sign == 1.0) return;
  for (double& f : measured.force_n[0]) f *= measured.file_force_sign;
  std::erase_if(measured.reading.notes, [](const std::string& note) {
    return note.find("its sign was turned") != std::string::npos;
  });
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

bool has_kinks(const Question& question) {
  for (const auto& element : question.terms)
    for (const RunTimeTerm& term : element)
      if (question.gated && (term.kink_at_rest() || term.kink_at_centre())) return true;
  return false;
}

/// Levels whose rows still see most of the motion: coarse rows do not fit between reversals.
int coarsest_between_kinks(const Measured& measured, Question question, int coarsest) {
  constexpr double kMost = 0.75;  // of the level that sees most
  std::vector<double> seen;
  for (question.level = 0; question.level <= coarsest; ++question.level)
    seen.push_back(static_cast<double>(count_rows(measured, question) << question.level));
  const double most = *std::max_element(seen.begin(), seen.end());
  int level = coarsest;
  while (level > 0 && !(seen[static_cast<std::size_t>(level)] >= kMost * most)) --level;
  return level;
}

Wavelet other_wavelet(Wavelet wavelet) {
  return wavelet == Wavelet::kD16 ? Wavelet::kD12
                                  : static_cast<Wavelet>(static_cast<int>(wavelet) + 1);
}

/// How far the terms may be off, as a sum of logarithms: by their deviations; by five times the
/// difference to another wavelet, which shows a step that is too coarse; and by twice the share
/// that is left, as noise of the deflection makes regressors small.
double doubt(const Measured& measured, Question question) {
  constexpr double kTimes = 5.0;
  constexpr double kOfLeft = 2.0;
  const WaveletFit own = fit_terms(measured, question);
  question.wavelet = other_wavelet(question.wavelet);
  const WaveletFit other = fit_terms(measured, question);
  const double left = kOfLeft * 0.01 * mean_of(own.mse_percent);
  double sum = 0.0;
  for (std::size_t i = 0; i < own.terms.size(); ++i) {
    const TermEstimate& t = own.terms[i];
    const double apart = kTimes * (t.value - other.terms[i].value);
    sum += std::log(apart * apart + t.std * t.std + left * left * t.value * t.value);
  }
  return sum;
}

/// Of the levels up to `coarsest` the one with the least doubt: at fine ones the stencils see
/// noise, at coarse ones they lack resolution.
int least_doubted(const Measured& measured, Question question, int coarsest) {
  question.window_rows = 0;
  question.brief = true;
  question.compares = false;
  double least = std::numeric_limits<double>::infinity();
  int best = 0;
  for (question.level = 0; question.level <= coarsest; ++question.level) {
    try {
      const double here = doubt(measured, question);
      if (here < least) best = question.level;
      least = std::min(least, here);
    } catch (const RunError&) {
      continue;  // too few rows there; what remains is judged by the fit itself
    }
  }
  return best;
}

Question question_of(const Settings& settings, std::vector<std::vector<RunTimeTerm>> terms,
                     const Measured& measured) {
  Question out{.terms = std::move(terms),
               .mass_kg = settings.mass_kg,
               .wavelet = settings.wavelet,
               .window_rows = settings.window_rows,
               .gated = settings.gated,
               .compares = settings.compares};
  out.level = settings.level ? *settings.level : level_for(measured, out);
  return out;
}

Parameter parameter_of(const TermEstimate& t, bool two_masses, bool per_mass) {
  std::string name = name_of(t.term);
  if (per_mass) name += "_per_mass";
  if (two_masses) name = fmt::format("element{}_{}", t.element + 1, name);
  Parameter out{name, t.value, t.std, unit_of(t.term, per_mass)};
  out.term = text_of(t.term);
  out.cov = t.cov;
  return out;
}

std::string model_note(const Measured& measured, bool inertia, const Settings& settings) {
  if (measured.from_accelerations && settings.mass_kg.empty())
    return "From accelerations, per unit mass: --mass KG gives forces. x is the deflection against "
           "the base.";
  if (measured.from_accelerations)
    return "From accelerations: x is the deflection against the base.";
  if (inertia) return "The force drives a mass, which is identified too (term a).";
  if (!settings.mass_kg.empty()) return "The force drives a mass that is stated (--mass).";
  return "No inertia: the force is that of the element alone. Where a mass moves, add the term a, "
         "or state it by --mass.";
}

void fill_method(const Measured& measured, const Question& question, const WaveletFit& fit,
                 RunResult& result) {
  result.row_method = RowMethod{
      .wavelet = std::string{kWaveletNames[static_cast<std::size_t>(question.wavelet)]},
      .level = static_cast<std::uint64_t>(question.level),
      .step_s = measured.step_s * static_cast<double>(1U << static_cast<unsigned>(question.level)),
      .window_rows = question.window_rows,
      .gated = fit.gated,
      .mse_percent = fit.mse_percent,
      .held_out_mse_percent = fit.held_out_mse_percent};
  // Of the whole record: what rows away from reversals leave says nothing of the reversals.
  const double nmse = 0.01 * mean_of(fit.gated ? fit.all_rows_mse_percent : fit.mse_percent);
  result.fit = {nmse, std::sqrt(nmse), {}, {}, {}};
  if (!fit.gated) result.fit.held_out_nmse = 0.01 * mean_of(fit.held_out_mse_percent);
  result.counts.emplace_back("rows", fit.rows);
  if (question.window_rows == 0) return;
  result.counts.emplace_back("windows", fit.windows.rows.size());
  result.counts.emplace_back("windows_undetermined", fit.windows_held);
}

/// Another wavelet sees the same terms in the same rows, unless the step is too coarse for the
/// motion or the noise too large: both make the stencils differ.
void compare_wavelets(const Measured& measured, Question question, const WaveletFit& fit,
                      RunResult& result) {
  constexpr double kSame = 3.0;    // deviations
  constexpr double kSmall = 1e-3;  // of the estimate
  const Wavelet own = question.wavelet;
  question.wavelet =
      own == Wavelet::kD16 ? Wavelet::kD12 : static_cast<Wavelet>(static_cast<int>(own) + 1);
  question.compares = false;
  question.brief = true;
  const WaveletFit other = fit_terms(measured, question);
  std::string differing;
  for (std::size_t i = 0; i < fit.terms.size(); ++i) {
    const TermEstimate& a = fit.terms[i];
    const double apart = std::abs(a.value - other.terms[i].value);
    if (!(apart > kSame * std::hypot(a.std, other.terms[i].std)) ||
        !(apart > kSmall * std::abs(a.value)))
      continue;
    differing += fmt::format("{}{} by {:.2g} %", differing.empty() ? "" : ", ", text_of(a.term),
                             100.0 * apart / std::abs(a.value));
  }
  if (differing.empty()) return;
  result.std_is_unproven = true;
  result.warnings.push_back(
      fmt::format("{} and {} differ beyond their deviations: {}. The step is too coarse for this "
                  "motion, or the "
                  "deflection too noisy: a finer or coarser --level, or a higher sampling rate.",
                  kWaveletNames[static_cast<std::size_t>(own)],
                  kWaveletNames[static_cast<std::size_t>(question.wavelet)], differing));
}

void fill_course(WaveletFit& fit, RunResult& result) {
  for (Convergence* course : {&fit.course, &fit.windows})
    for (const Parameter& p : result.parameters) {
      course->names.push_back(p.name);
      course->units.push_back(p.unit);
    }
  result.convergence = std::move(fit.course);
  if (!fit.windows.rows.empty()) result.windows = std::move(fit.windows);
  result.cov = std::move(fit.cov);
  result.term_sets = std::move(fit.sets);
  result.motion = std::move(fit.motion);
  result.force = std::move(fit.force);
}

}  // namespace

int level_for(const Measured& measured, const Question& question) {
  constexpr double kSteps = 12.0;
  constexpr double kStepsOfD6 = 24.0;
  constexpr std::size_t kLevelRowsPerTerm = 40;
  std::size_t terms = 0;
  for (const auto& element : question.terms) terms += element.size();
  const double period = samples_per_period(measured);
  if (period == 0.0) return 0;
  const double steps = question.wavelet == Wavelet::kD6 ? kStepsOfD6 : kSteps;
  int level = std::clamp(static_cast<int>(std::floor(std::log2(period / steps))), 0, kDeepestLevel);
  while (level > 0 && (measured.samples() >> level) < kLevelRowsPerTerm * terms) --level;
  if (has_kinks(question)) level = coarsest_between_kinks(measured, question, level);
  return level == 0 ? 0 : least_doubted(measured, question, level);
}

RunResult identify(const Config& config, const Settings& settings) {
  auto terms = elements_of(settings);
  const bool inertia = has_inertia(terms);
  check_masses(settings, inertia, false);
  Measured measured = read_measured(config, settings.record);
  check_masses(settings, inertia, measured.from_accelerations);
  if (inertia || !settings.mass_kg.empty()) restore_force(measured);
  const Question question = question_of(settings, std::move(terms), measured);
  WaveletFit fit = fit_terms(measured, question);
  RunResult result = std::move(measured.reading);
  result.kind = "rig";
  const bool per_mass = measured.from_accelerations && settings.mass_kg.empty();
  for (const TermEstimate& t : fit.terms) {
    result.parameters.push_back(parameter_of(t, measured.masses > 1, per_mass));
    result.model.push_back(measured.masses == 1
                               ? text_of(t.term)
                               : fmt::format("{} of element {}", text_of(t.term), t.element + 1));
  }
  fill_method(measured, question, fit, result);
  compare_wavelets(measured, question, fit, result);
  fill_course(fit, result);
  result.sample_rate_hz = Estimate{1.0 / measured.step_s, 0.0};
  result.duration_s = measured.duration_s;
  result.notes.insert(result.notes.begin(), measured.notes.begin(), measured.notes.end());
  result.notes.push_back(model_note(measured, inertia, settings));
  judge_trust(nullptr, result);
  return result;
}

}  // namespace dampline::app::wavelet
