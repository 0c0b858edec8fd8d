// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/library.hpp"
#include "app/diagnosis/rig/surrogate.hpp"
#include "app/diagnosis/rig/trials.hpp"

namespace dampline::app::rig {

/// Looks for what a rig's base model lacks: every effect in its smallest form, beside a constant
/// and a spring; the best is added while it helps on what was held out, then each is tried without;
/// a memory of the friction is refined to a bank of stop operators.
class Search {
 public:
  Search(const Config& config, const std::vector<Series>& records);
  [[nodiscard]] Explanation run();

 private:
  struct Chosen {
    Candidate candidate;
    Step step;
    double ridge{0.0};
    double other_memory{0.0};
    double skew_s{0.0};  ///< of time_skew, which has no columns
    Mode path;           ///< of unmodelled_mode where it has no columns
  };
  /// The best fit of all ways to write sign v.
  struct Judged {
    Fit fit;
    std::size_t width{0};  ///< the way that is best
    ColumnSet set;         ///< of the fit
    /// The coefficient of a column.
    [[nodiscard]] Estimate of(Eigen::Index column) const {
      return fit.estimate(place_of(set, column));
    }
  };

  /// The best candidate of an effect.
  struct Ranked {
    const Candidate* candidate{nullptr};
    double gain{0.0};
    double t{0.0};
    Fit fit;
    bool needs_excess{false};  ///< over the floor, however sure it is
  };

  [[nodiscard]] ColumnSet set_of(const ColumnSet& more, std::size_t width) const;
  [[nodiscard]] Judged judge(const ColumnSet& more) const;
  [[nodiscard]] ColumnSet chosen_columns() const;
  [[nodiscard]] Judged judge_chosen() const { return judge(chosen_columns()); }
  /// Held out, of the base and what was chosen.
  [[nodiscard]] double error() const { return judge_chosen().fit.held_out_nmse; }
  /// With the spring and the constant that every comparison carries.
  [[nodiscard]] ColumnSet beside_both(const ColumnSet& more = {}) const {
    return joined(joined(chosen_columns(), {library_.spring, library_.offset}), more);
  }
  /// After the library or the records have changed.
  void evaluate_columns() { evidence_ = std::make_unique<Regression>(library_.columns, records_); }
  void choose(Candidate candidate, double before_nmse, double gain, double t);
  void finish_step();
  [[nodiscard]] std::vector<Regressor> columns_of(const ColumnSet& set) const;
  [[nodiscard]] double ridge() const;
  [[nodiscard]] bool can_add(const Candidate& candidate) const;
  [[nodiscard]] std::vector<std::string> terms() const;
  [[nodiscard]] Floor floor_of(const ColumnSet& more) const;
  [[nodiscard]] bool is_friction(Eigen::Index column, const Judged& judged) const;
  [[nodiscard]] static bool has_other_sign(const Candidate& candidate, const Judged& judged);
  [[nodiscard]] bool has_driving_friction(const Fit& fit) const;
  [[nodiscard]] std::vector<Ranked> rank() const;
  [[nodiscard]] bool passes(const Ranked& top, double before_nmse) const;
  [[nodiscard]] Fit best_with(const Candidate& first) const;
  void prefer_beside_another(std::vector<Ranked>& order) const;
  void prefer_to_offset(std::vector<Ranked>& order) const;
  [[nodiscard]] std::string alike(const std::vector<Ranked>& order) const;
  [[nodiscard]] TrialBase trial_base() const;
  [[nodiscard]] std::optional<Trial> best_trial(double before_nmse) const;
  void prefer_mode(std::optional<Trial>& best) const;
  bool take_mass(const std::vector<Ranked>& order, const std::optional<Trial>& trial);
  [[nodiscard]] bool is_better(const Trial& trial, const std::vector<Ranked>& order) const;
  void take(const Trial& trial, double before);
  [[nodiscard]] std::vector<Parameter> parameters_of(const Trial& trial) const;
  void describe_drift(Chosen& chosen, const Judged& now) const;
  void leave_impacts_out();
  bool forward();
  [[nodiscard]] static double other_memory_of(const std::vector<Ranked>& order);
  void rename_memory(Chosen& memory) const;
  void backward();
  void refine(Chosen& memory);
  void try_bouc_wen(Chosen& memory);
  void take_dominant_spring();
  void try_linear(bool& added);
  void try_mass();
  void widen();
  void refine_width();
  void count_noise(Explanation& out) const;
  [[nodiscard]] bool filtered() const;
  void describe(Model& model, const Judged& judged) const;
  void describe_bouc_wen(Chosen& chosen, const Estimate& first) const;
  void describe_bank(Chosen& chosen, const Judged& now) const;
  void describe_small(Chosen& chosen, const Estimate& first) const;
  void describe_sides(Chosen& chosen, const Judged& now) const;
  void describe_steps(const Judged& now);

  std::vector<Series> records_;
  Scale scale_;
  Library library_;
  std::unique_ptr<Regression> evidence_;
  std::vector<Chosen> chosen_;
  std::vector<BankElement> bank_;    ///< in use
  std::optional<BoucWen> bouc_wen_;  ///< in the place of a bank
  bool base_friction_left_{true};    ///< the base's friction stays beside the bank
  bool spring_added_{false};
  bool mass_added_{false};
  std::vector<std::string> notes_;
  std::vector<JudgedCandidate> rejected_;  ///< of the newest round
  std::string alike_;                      ///< effects that the newest round could not tell apart
};

}  // namespace dampline::app::rig
