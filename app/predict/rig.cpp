// SPDX-License-Identifier: MIT
#include "app/predict/rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "app/diagnosis/rig/law.hpp"
#include "app/diagnosis/rig/series.hpp"
#include "app/error.hpp"
#include "app/law/start.hpp"
#include "app/run/provenance.hpp"
#include "drivers/bytes/spool.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::app {
namespace {

constexpr double kIrregular = 0.33;  // of an interval
constexpr int kDraws = 32;           // of a force that the law lacks

double median_of_steps(const Eigen::VectorXd& time_s) {
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  return rig::median_of(steps);
}

/// Force and time of a record that need hold no more.
rig::Series read_force(const std::string& path, const Config& config, bool skip_bad_lines) {
  drivers::RowFileConfig file;
  file.path = path;
  file.required = {std::string{name(Column::kForce)}, std::string{name(Column::kTime)}};
  for (const Column c : {Column::kForce, Column::kTime})
    if (!config.input.columns[index(c)].empty())
      file.renamed[std::string{name(c)}] = config.input.header(c);
  file.skip_bad_lines = skip_bad_lines;
  const auto reader = drivers::open_rows(file);
  if (!reader) throw RunError{reader.error_text()};
  std::vector<double> force_n;
  std::vector<double> time_s;
  std::array<double, 2> row{};
  auto rows = reader.value()->read(row);
  for (; rows; rows = reader.value()->read(row)) {
    if (rows.value() == 0) continue;
    force_n.push_back(row[0] * config.input.scale[index(Column::kForce)]);
    time_s.push_back(row[1] * config.input.scale[index(Column::kTime)]);
    if (!std::isfinite(force_n.back()) || !std::isfinite(time_s.back()))
      throw RunError{
          fmt::format("{}: row {} holds a value that is no number", path, force_n.size())};
  }
  if (rows.error() != Errc::kEndOfStream) throw RunError{reader.value()->error_text()};
  if (force_n.size() < 2)
    throw RunError{fmt::format("{}: found {} rows, expected at least 2", path, force_n.size())};
  rig::Series out;
  out.record = path;
  out.force_n = rig::vector_of(force_n);
  out.time_s = rig::vector_of(time_s);
  out.interval_s = median_of_steps(out.time_s);
  for (Eigen::Index i = 1; i < out.time_s.size(); ++i) {
    const double step_s = out.time_s[i] - out.time_s[i - 1];
    if (std::abs(step_s - out.interval_s) > kIrregular * out.interval_s)
      throw RunError{
          fmt::format("{}: row {}: found {:.6g} s after the one before, expected {:.6g} "
                      "s: a force that moves a mass has no gaps",
                      path, i + 1, step_s, out.interval_s)};
  }
  const double span_s = out.time_s[out.time_s.size() - 1] - out.time_s[0];
  out.interval_s = span_s / static_cast<double>(out.time_s.size() - 1);
  return out;
}

/// `path`: no pipe, it is read again.
bool holds_deflection(const std::string& path, const Config& config) {
  drivers::RowFileConfig file;
  file.path = path;
  const std::string canonical{name(Column::kDeflection)};
  file.optional = {canonical};
  if (!config.input.columns[index(Column::kDeflection)].empty())
    file.renamed[canonical] = config.input.header(Column::kDeflection);
  const auto reader = drivers::open_rows(file);
  if (!reader) throw RunError{reader.error_text()};
  return reader.value()->has(canonical);
}

void note_what_is_missing(const law::Document& document, Prediction& out) {
  for (const std::string& effect : document.not_in_it)
    out.notes.push_back("Not in the law: " + effect + ".");
}

Prediction begun(const char* what, const rig::Series& series, const law::Document& document) {
  Prediction out;
  out.what = what;
  out.record = series.record;
  out.sample_rate_hz = 1.0 / series.interval_s;
  note_what_is_missing(document, out);
  return out;
}

/// The force of the law with other numbers, row by row.
Eigen::VectorXd force_of(const law::Document& document, const law::Law& law,
                         const rig::Series& series) {
  law::Document there = document;
  there.law = law;
  const rig::Rows rows = rig::rows_of(rig::columns_of(there), series, 1);
  return rows.values.leftCols(rows.values.cols() - 1) * rig::theta_of(law);
}

/// Of the force over the law's numbers: of a coefficient its column, of a place a difference.
Eigen::MatrixXd slopes_of(const law::Document& document, const rig::Rows& rows,
                          const rig::Series& series) {
  using Part = law::Unknown::Part;
  const Eigen::Index mass = document.law.mass_kg > 0.0 ? 1 : 0;
  const Eigen::VectorXd centre = document.values();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows.values.rows(), centre.size());
  for (Eigen::Index k = 0; k < centre.size(); ++k) {
    const law::Unknown& u = document.unknowns[static_cast<std::size_t>(k)];
    const double step = document.std_of(k);
    if (u.part == Part::kMass) {
      out.col(k) = rows.values.col(0);
    } else if (u.part == Part::kCoefficient) {
      for (const std::size_t t : u.terms)
        out.col(k) += rows.values.col(mass + static_cast<Eigen::Index>(t));
    } else if (step > 0.0) {
      const Eigen::VectorXd by = step * Eigen::VectorXd::Unit(centre.size(), k);
      out.col(k) = (force_of(document, document.with(centre + by), series) -
                    force_of(document, document.with(centre - by), series)) /
                   (2.0 * step);
    }
  }
  return out;
}

void check_movable(const law::Document& document) {
  if (document.subject != law::Subject::kDrivenMass)
    throw UsageError{
        "--free-run: the law is a damper's, whose motion is prescribed; expected that of a driven "
        "mass. Without --free-run its force is predicted from the motion"};
  if (!law::FreeRun::can(document.law))
    throw UsageError{
        "--free-run: the law cannot be moved: it holds a term that depends on more than motion and "
        "memory"};
}

std::string own_figures_text(const law::Document& document) {
  std::string out = "By the law's figures for a free run:";
  for (std::size_t i = 0; i < document.unknowns.size(); ++i)
    out +=
        fmt::format("{} {} {}", i == 0 ? "" : ",", document.unknowns[i].name, document.text_of(i));
  return out + ".";
}

/// Deviation of the motion that comes of a force which the law lacks, as dense as in its own record
/// up to the corner that it was seen through: the scatter of some drawn ones.
Eigen::VectorXd walk_of(const law::Document& document, const law::Input& input,
                        const Eigen::VectorXd& force_n, const law::State& start) {
  const double size_n = std::sqrt(document.lacking_n2_hz * document.filter_hz);
  const double keep = std::exp(-4.0 * document.filter_hz * input.interval_s());
  const double fresh_n = size_n * std::sqrt(1.0 - keep * keep);
  const law::Course course = law::move(document.law, input, start);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(2 * input.size());
  std::mt19937_64 random{1};
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd drawn_n = force_n;
    double lack_n = size_n * normal(random);
    for (Eigen::Index i = 0; i < drawn_n.size(); ++i) {
      drawn_n[i] += lack_n;
      lack_n = keep * lack_n + fresh_n * normal(random);
    }
    const law::Course other =
        law::move(document.law, law::Input{drawn_n, input.interval_s()}, start);
    if (!other.whole)
      return Eigen::VectorXd::Constant(squares.size(), std::numeric_limits<double>::infinity());
    squares.head(input.size()) += (other.deflection_m - course.deflection_m).cwiseAbs2();
    squares.tail(input.size()) += (other.velocity_mps - course.velocity_mps).cwiseAbs2();
  }
  return (squares / kDraws).cwiseSqrt();
}

}  // namespace

Prediction predict_force(const law::Document& document, const Config& config,
                         const PredictOptions& options) {
  rig::Series series = rig::read_series(options.input, config, options.skip_bad_lines);
  series.deflection_m.array() += series.zero_m - document.zero_m;
  if (series.force_sign != document.force_sign) series.force_n *= -1.0;
  if (document.filter_hz > 0.0) series.config.corner_hz = document.filter_hz;
  const std::vector<rig::Regressor> columns = rig::columns_of(document);
  const rig::Rows rows = rig::rows_of(columns, series, 1);
  const Eigen::Index count = rows.values.rows();
  if (count < 2) throw RunError{fmt::format("{}: too short to predict", options.input)};
  Prediction out = begun("force from motion", series, document);
  Eigen::VectorXd time_s{count};
  for (Eigen::Index i = 0; i < count; ++i)
    time_s[i] = series.time_s[rows.sample[static_cast<std::size_t>(i)]];
  out.columns.push_back({"time_s", std::move(time_s)});
  if (rig::is_filtered(columns))
    out.notes.push_back(fmt::format(
        "Force and prediction are seen through the test function that gives the acceleration, "
        "with its corner at {:.3g} Hz.",
        series.config.corner_hz));
  const Eigen::VectorXd force_n = force_of(document, document.law, series);
  const Eigen::MatrixXd slopes = slopes_of(document, rows, series);
  const Eigen::VectorXd std =
      (slopes * document.covariance).cwiseProduct(slopes).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
  add_quantity("force_n", "N", document.force_sign * force_n, std, document.residual_n,
               document.force_sign * rows.values.rightCols<1>(), 0, out);
  return out;
}

Prediction predict_motion(const law::Document& explained, const Config& config,
                          const PredictOptions& options) {
  check_movable(explained);
  const law::Document document = explained.for_free_run();
  const auto file = drivers::spooled(options.input);
  if (!file) throw RunError{file.error_text()};
  const std::string& path = file.value();
  const bool measured = holds_deflection(path, config);
  rig::Series series = measured ? rig::read_series(path, config, options.skip_bad_lines)
                                : read_force(path, config, options.skip_bad_lines);
  series.record = options.input;
  if (series.has_gap)
    throw RunError{
        fmt::format("{}: has gaps or values that are no number: a force that moves a "
                    "mass has none",
                    options.input)};
  if (series.force_sign != document.force_sign) series.force_n *= -1.0;
  law::State start{};
  Eigen::VectorXd deflection_m;
  if (measured) {
    deflection_m = series.deflection_m.array() + series.zero_m;
    const Eigen::VectorXd from_zero_m = deflection_m.array() - document.zero_m;
    const bool is_own =
        explained.free_run && explained.free_run->record_sha256 == describe_record(path).sha256;
    start = is_own ? document.initial
                   : law::start_of(document.law, {series.force_n, from_zero_m, series.velocity_mps,
                                                  series.interval_s, series.noise_m});
  }
  const law::Input input{series.force_n, series.interval_s};
  const Eigen::Index count = input.size();
  const auto motion_of = [&](const law::Law& law) -> Eigen::VectorXd {
    const law::Course course = law::move(law, input, start);
    if (!course.whole) return {};
    Eigen::VectorXd out{2 * count};
    out << course.deflection_m.array() + document.zero_m, course.velocity_mps.array();
    return out;
  };
  const Eigen::VectorXd motion = motion_of(document.law);
  if (motion.size() == 0)
    throw RunError{fmt::format("{}: the law runs away under this force", options.input)};
  Prediction out = begun("motion from force", series, document);
  if (explained.free_run) out.notes.push_back(own_figures_text(document));
  if (!measured) out.notes.emplace_back("It starts at rest: the record holds no deflection_m.");
  out.columns.push_back({"time_s", series.time_s});
  Eigen::VectorXd std = deviation_of(document, motion_of, 2 * count);
  if (document.lacking_n2_hz > 0.0)
    std =
        (std.cwiseAbs2() + walk_of(document, input, series.force_n, start).cwiseAbs2()).cwiseSqrt();
  add_quantity("deflection_m", "m", motion.head(count), std.head(count),
               document.lacking_n2_hz > 0.0 ? 0.0 : document.residual_m, deflection_m, 0, out);
  add_quantity("velocity_mps", "m/s", motion.tail(count), std.tail(count), 0.0, {}, 0, out);
  return out;
}

}  // namespace dampline::app
