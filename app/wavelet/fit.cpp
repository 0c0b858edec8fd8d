// SPDX-License-Identifier: MIT
#include "app/wavelet/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "app/error.hpp"
#include "dampline/numeric/information.hpp"
#include "published/wavelet/estimates.hpp"
#include "published/wavelet/model_selection.hpp"

namespace dampline::app::wavelet {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kCourseRows = 60.0;
constexpr std::size_t kFolds = 4;
constexpr double kExcerptS = 20.0;
constexpr std::size_t kExcerptRows = 5000;
constexpr std::size_t kRowsPerTerm = 5;

/// The fit of one record, mass by mass, window by window.
template <int Dof>
class Fitter {
  using Model = TermsModel<Dof>;
  using Selection = ModelSelection<Model>;
  using Mask = typename Selection::Mask;
  using Fit = typename Selection::Fit;
  using Row = TermsRow<Dof>;
  using Vector = typename Selection::Vector;

 public:
  Fitter(const Measured& measured, const Question& question)
      : measured_{measured},
        question_{question},
        equations_{measured, question},
        asked_{equations_.asked()} {
    for (const ColumnOf& c : equations_.columns())
      if (c.asked) columns_.push_back(c);
  }

  WaveletFit run() {
    count_rows();
    out_.gated = equations_.gated();
    if (question_.window_rows > 0)
      fit_windows();
    else
      fit_record();
    if (question_.brief) return std::move(out_);
    gather_excerpt();
    if (out_.gated) judge_all_rows();
    if (question_.compares) compare();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw RunError{measured_.name + ": " + what};
  }

  void count_rows() {
    equations_.for_each([&](const Row&, double) { ++out_.rows; });
    const std::size_t least = kRowsPerTerm * columns_.size();
    if (Dof * out_.rows > least) return;
    fail(fmt::format(
        "found {} usable rows in {} samples{}, expected more than {} for {} terms: a "
        "longer record, a finer step (--level) or a shorter wavelet",
        Dof * out_.rows, measured_.samples(),
        equations_.gated() ? " (rows across a reversal are left out: --no-gate takes them)" : "",
        least, columns_.size()));
  }

  [[nodiscard]] std::unique_ptr<Selection> selection() const {
    // Blocks join four times, so that the course begins early; at the end there are 9 to 16.
    constexpr std::size_t kShare = 256;
    return std::make_unique<Selection>(
        static_cast<std::int64_t>((out_.rows + kShare - 1) / kShare));
  }

  [[nodiscard]] Fit checked(const Fit& fit) const {
    if (fit.valid) return fit;
    std::string names;
    for (const ColumnOf& c : columns_)
      names += fmt::format("{}{}", names.empty() ? "" : ", ", text_of(c.term));
    fail(
        fmt::format("{} rows do not determine all of {}: fewer terms, or a record with more motion",
                    out_.rows, names));
  }

  void take_vector(const Vector& theta, const Vector& deviation) {
    for (const ColumnOf& c : columns_) {
      const double value = theta[c.column];
      const double std = deviation[c.column];
      out_.terms.push_back({c.term, c.element, value, std, std / std::abs(value)});
    }
    theta_ = theta;
  }

  [[nodiscard]] Convergence::Row course_row(double time_s, const Vector& theta,
                                            const Vector& deviation) const {
    Convergence::Row row{time_s, {}};
    for (const ColumnOf& c : columns_)
      row.estimates.push_back({theta[c.column], deviation[c.column]});
    return row;
  }

  void fit_record();
  void fit_windows();
  void judge_windows(const std::array<Vector, kFolds + 1>& means);
  void judge_all_rows();
  void gather_excerpt();
  void compare();
  void add_set(const Selection& all, const std::string& change, const Mask& terms, int changed,
               const Fit* whole);
  [[nodiscard]] std::string place_of(const ColumnOf& c) const {
    return Dof == 1 ? text_of(c.term)
                    : fmt::format("{} of element {}", text_of(c.term), c.element + 1);
  }

  const Measured& measured_;
  const Question& question_;
  Equations<Dof> equations_;
  Mask asked_;
  std::vector<ColumnOf> columns_;  // asked for
  Vector theta_ = Vector::Zero();
  WaveletFit out_;
};

template <int Dof>
void Fitter<Dof>::fit_record() {
  const auto all = selection();
  const double every_s = measured_.duration_s / kCourseRows;
  double next_s = every_s;
  equations_.for_each([&](const Row& row, double time_s) {
    all->absorb(row, equations_.mass_kg());
    if (time_s < next_s || question_.brief) return;
    while (next_s <= time_s) next_s += every_s;
    const Fit fit = all->fit(asked_);
    if (!fit.valid) return;
    out_.course.rows.push_back(course_row(time_s, fit.theta, fit.deviation));
    CovRow cov{time_s, {}};
    for (const Estimate& e : out_.course.rows.back().estimates)
      cov.cov.push_back(e.std / std::abs(e.value));
    out_.cov.push_back(std::move(cov));
  });
  const Fit fit = checked(all->fit(asked_));
  take_vector(fit.theta, fit.deviation);
  out_.mse_percent.assign(fit.mse_percent.begin(), fit.mse_percent.end());
  out_.held_out_mse_percent.assign(fit.held_out_mse_percent.begin(),
                                   fit.held_out_mse_percent.end());
}

/// Estimates of windows of equally many rows, as in Ghanem and Romeo (2001).
template <int Dof>
class WindowFits {
 public:
  using Vector = typename ModelSelection<TermsModel<Dof>>::Vector;
  using Information = RunTimeInformation<TermsModel<Dof>::kUnknowns>;
  static constexpr double kLeastPivot = 1e-9;

  WindowFits(const std::vector<ColumnOf>& columns, std::size_t rows)
      : columns_{columns}, rows_per_window_{rows} {}

  /// True when a window became full with this equation; solved() tells whether it has an estimate.
  bool absorb(const typename TermsRow<Dof>::Equation& equation) {
    typename Information::Row row{};
    for (std::size_t i = 0; i < columns_.size(); ++i) row[i] = equation[columns_[i].column];
    row[columns_.size()] = equation[TermsModel<Dof>::kUnknowns];
    information_.absorb(row);
    if (++rows_ < rows_per_window_) return false;
    solved_ = information_.undetermined(kLeastPivot) < 0;
    if (solved_) solve();
    information_ = Information{static_cast<int>(columns_.size())};
    rows_ = 0;
    return true;
  }
  [[nodiscard]] bool solved() const noexcept { return solved_; }
  [[nodiscard]] const Vector& theta() const noexcept { return theta_; }
  [[nodiscard]] const Vector& deviation() const noexcept { return deviation_; }

 private:
  void solve() {
    const auto values = information_.solve();
    const auto n = static_cast<int>(columns_.size());
    const double freedom = static_cast<double>(rows_per_window_) - static_cast<double>(n);
    const double rms = std::abs(information_.at(n, n)) / std::sqrt(std::max(freedom, 1.0));
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      typename Information::Vector unit{};
      unit[i] = 1.0;
      theta_[columns_[i].column] = values[i];
      deviation_[columns_[i].column] = rms * std::sqrt(information_.solve_normal(unit)[i]);
    }
  }

  const std::vector<ColumnOf>& columns_;
  std::size_t rows_per_window_;
  Information information_{static_cast<int>(columns_.size())};
  std::size_t rows_{0};
  bool solved_{false};
  Vector theta_ = Vector::Zero();
  Vector deviation_ = Vector::Zero();
};

template <int Dof>
void Fitter<Dof>::fit_windows() {
  using Scatter = EstimateScatter<Model::kUnknowns>;
  WindowFits<Dof> windows{columns_, question_.window_rows};
  Scatter scatter;
  std::array<Scatter, kFolds> folds;
  std::size_t full = 0;
  equations_.for_each([&](const Row& row, double time_s) {
    for (int d = 0; d < Dof; ++d) {
      if (!windows.absorb(row.equation(d))) continue;
      const std::size_t fold = full++ % kFolds;
      if (!windows.solved()) {
        ++out_.windows_held;
        continue;
      }
      scatter.add(windows.theta());
      for (std::size_t f = 0; f < kFolds; ++f)
        if (f != fold) folds[f].add(windows.theta());
      out_.windows.rows.push_back(course_row(time_s, windows.theta(), windows.deviation()));
      if (scatter.count() < 2) continue;
      const Vector spread = scatter.deviation();
      out_.course.rows.push_back(
          course_row(time_s, scatter.mean(), spread / std::sqrt(double(scatter.count()))));
      CovRow cov{time_s, {}};
      for (const ColumnOf& c : columns_) cov.cov.push_back(scatter.cov()[c.column]);
      out_.cov.push_back(std::move(cov));
    }
  });
  if (scatter.count() < 2)
    fail(
        fmt::format("found {} windows of {} rows that determine all terms, and {} that do not; "
                    "expected 2 at least: a longer window (--windows) or the whole record "
                    "(--recursive)",
                    scatter.count(), question_.window_rows, out_.windows_held));
  take_vector(scatter.mean(), scatter.deviation() / std::sqrt(double(scatter.count())));
  for (TermEstimate& t : out_.terms) t.cov *= std::sqrt(double(scatter.count()));
  std::array<Vector, kFolds + 1> means;
  for (std::size_t f = 0; f < kFolds; ++f)
    means[f] = folds[f].count() > 0 ? folds[f].mean() : scatter.mean();
  means[kFolds] = scatter.mean();
  judge_windows(means);
}

/// Sums of equation 35, mass by mass.
template <int Dof>
class Errors {
 public:
  using Vector = typename ModelSelection<TermsModel<Dof>>::Vector;
  explicit Errors(const PerDof<Dof>& mass_kg) : mass_kg_{mass_kg} {}

  /// What `theta` leaves of equation d, and the acceleration that it is an error of.
  void add(const TermsRow<Dof>& row, std::size_t d, const Vector& theta) {
    const double left =
        row.target_n[d] - row.regressors.row(static_cast<int>(d)).dot(theta.transpose());
    left_[d] += left * left / (mass_kg_[d] * mass_kg_[d]);
    count_[d] += 1.0;
    const double from_old = row.accel_mps2[d] - mean_[d];
    mean_[d] += from_old / count_[d];
    squares_[d] += from_old * (row.accel_mps2[d] - mean_[d]);
  }
  [[nodiscard]] std::vector<double> mse_percent() const {
    std::vector<double> out;
    for (std::size_t d = 0; d < left_.size(); ++d) out.push_back(100.0 * left_[d] / squares_[d]);
    return out;
  }

 private:
  PerDof<Dof> mass_kg_;
  PerDof<Dof> left_{};
  PerDof<Dof> count_{};
  PerDof<Dof> mean_{};
  PerDof<Dof> squares_{};
};

/// Errors of the windows' mean, and of the mean of those windows that a row is not in.
template <int Dof>
void Fitter<Dof>::judge_windows(const std::array<Vector, kFolds + 1>& means) {
  Errors<Dof> own{equations_.mass_kg()};
  Errors<Dof> held_out{equations_.mass_kg()};
  std::size_t equations = 0;
  equations_.for_each([&](const Row& row, double) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(Dof); ++d) {
      own.add(row, d, means[kFolds]);
      held_out.add(row, d, means[(equations++ / question_.window_rows) % kFolds]);
    }
  });
  out_.mse_percent = own.mse_percent();
  out_.held_out_mse_percent = held_out.mse_percent();
}

template <int Dof>
void Fitter<Dof>::judge_all_rows() {
  Question question = question_;
  question.gated = false;
  Errors<Dof> errors{equations_.mass_kg()};
  Equations<Dof>{measured_, question}.for_each([&](const Row& row, double) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(Dof); ++d) errors.add(row, d, theta_);
  });
  out_.all_rows_mse_percent = errors.mse_percent();
}

/// Of mass 1: its motion, and what acts on it against what the model makes of it.
template <int Dof>
void Fitter<Dof>::gather_excerpt() {
  const double step_s = measured_.step_s;
  const auto stride = static_cast<std::size_t>(
      std::max(1.0, std::ceil(kExcerptS / step_s / static_cast<double>(kExcerptRows))));
  std::size_t seen = 0;
  double start_s = kNaN;
  equations_.for_each([&](const Row& row, double time_s) {
    if (std::isnan(start_s)) start_s = time_s;
    if (time_s > start_s + kExcerptS || seen++ % stride != 0) return;
    out_.motion.push_back({time_s, row.deflection_m[0], row.velocity_mps[0]});
    out_.force.push_back({time_s, row.velocity_mps[0], row.target_n[0],
                          row.regressors.row(0).dot(theta_.transpose())});
  });
}

template <int Dof>
void Fitter<Dof>::add_set(const Selection& all, const std::string& change, const Mask& terms,
                          int changed, const Fit* whole) {
  const Fit fit = all.fit(terms);
  TermSet set{change, kNaN, kNaN, kNaN};
  if (fit.valid) {
    set.mse_percent = set.held_out_mse_percent = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(Dof); ++d) {
      set.mse_percent += fit.mse_percent[d] / Dof;
      set.held_out_mse_percent += fit.held_out_mse_percent[d] / Dof;
    }
    if (changed >= 0) set.t = (whole != nullptr ? *whole : fit).t_ratio[changed];
  }
  out_.sets.push_back(set);
}

/// Each term left out, each of the vocabulary added, and what choose() leaves of all of them.
template <int Dof>
void Fitter<Dof>::compare() {
  const auto all = selection();
  equations_.for_each([&](const Row& row, double) { all->absorb(row, equations_.mass_kg()); });
  const Fit whole = checked(all->fit(asked_));
  add_set(*all, "as asked", asked_, -1, nullptr);
  for (const ColumnOf& c : equations_.columns()) {
    Mask terms = asked_;
    terms[static_cast<std::size_t>(c.column)] = !c.asked;
    if (c.asked && columns_.size() < 2) continue;
    add_set(*all, (c.asked ? "without " : "with ") + place_of(c), terms, c.column,
            c.asked ? &whole : nullptr);
  }
  Mask every{};
  for (const ColumnOf& c : equations_.columns()) every[static_cast<std::size_t>(c.column)] = true;
  const Fit chosen = all->choose(every);
  if (!chosen.valid) return;
  std::string names;
  for (const ColumnOf& c : equations_.columns())
    if (chosen.terms[static_cast<std::size_t>(c.column)])
      names += fmt::format("{}{}", names.empty() ? "" : " + ", place_of(c));
  add_set(*all, "chosen of all: " + names, chosen.terms, -1, nullptr);
}

}  // namespace

std::size_t count_rows(const Measured& measured, const Question& question) {
  std::size_t rows = 0;
  const auto count = [&](const auto& equations) {
    equations.for_each([&](const auto&, double) { ++rows; });
  };
  if (measured.masses == 1)
    count(Equations<1>{measured, question});
  else
    count(Equations<2>{measured, question});
  return rows;
}

WaveletFit fit_terms(const Measured& measured, const Question& question) {
  if (measured.masses == 1) return Fitter<1>{measured, question}.run();
  return Fitter<2>{measured, question}.run();
}

}  // namespace dampline::app::wavelet
