// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "app/wavelet/measured.hpp"
#include "app/wavelet/row_stream.hpp"
#include "published/wavelet/model_selection.hpp"

namespace dampline::app::wavelet {

/// What is asked of a record.
struct Question {
  std::vector<std::vector<RunTimeTerm>> terms;  ///< of each element
  std::vector<double> mass_kg;                  ///< of each mass; empty: not known
  Wavelet wavelet{Wavelet::kD8};
  int level{0};
  std::size_t window_rows{0};  ///< 0: least squares over the whole record
  bool gated{true};            ///< no row reaches across a kink of a term
  bool compares{false};        ///< term sets with one term less and one more
  bool brief{false};           ///< the terms alone: no time course, no excerpt
};

/// A column of the equations: a term of an element.
struct ColumnOf {
  int column{0};
  int element{0};
  RunTimeTerm term;
  bool asked{true};  ///< else only for comparison
};

/// The equations of a record: rows of the wavelet, those across kinks left out. Of accelerations,
/// the polynomial of each block that every column may lack is taken from all columns, and to first
/// order what it makes of terms that are not linear.
template <int Dof>
class Equations {
 public:
  using Row = TermsRow<Dof>;
  using Use = std::function<void(const Row& row, double time_s)>;

  /// Throws UsageError for more terms than there is room for.
  Equations(const Measured& measured, const Question& question);

  /// Calls `use` with each equation in the order of time. Where the mass is known, target_n is
  /// f - m x'' and accel_mps2 the acceleration; else both are the force.
  void for_each(const Use& use) const;

  [[nodiscard]] const std::vector<ColumnOf>& columns() const noexcept { return columns_; }
  /// The terms that were asked for.
  [[nodiscard]] TermMask<TermsModel<Dof>::kUnknowns> asked() const noexcept;
  /// 1 where it is not known.
  [[nodiscard]] const PerDof<Dof>& mass_kg() const noexcept { return config_.mass_kg; }
  [[nodiscard]] bool gated() const noexcept { return gated_; }

 private:
  struct Timed {
    Row row;
    double time_s{0.0};
  };
  void add_columns(const Question& question);
  void add_candidates(const Question& question);
  void watch(const Question& question);
  void finish_row(Row& row) const;
  void project(std::vector<Timed>& rows) const;
  void project_equation(std::vector<Timed>& rows, int d) const;

  const Measured& measured_;
  Wavelet wavelet_;
  int level_;
  bool gated_{false};
  bool mass_known_;
  MotionRowsConfig<Dof> config_{};
  std::vector<ColumnOf> columns_;
  std::vector<RunTimeTerm> sensitivities_;  ///< of the terms asked for
  TermsModel<Dof> model_;
};

}  // namespace dampline::app::wavelet
