// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/diagnosis/rig/by_motion.hpp"
#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/library.hpp"
#include "app/diagnosis/rig/surrogate.hpp"
#include "app/diagnosis/rig/trials.hpp"

namespace dampline::app::rig {

/// An effect that was added.
struct Chosen {
  Candidate candidate;
  Step step;
  bool of_base{false};  ///< [model] base has it: it is no step
  double ridge{0.0};
  double other_memory{0.0};  ///< error of the other memory's smallest form over this one's; 0: none
  double skew_s{0.0};        ///< of time_skew, which has no columns
  Mode path;                 ///< of unmodelled_mode where it has no columns
  std::vector<Change> changes;  ///< of time_drift where it has no columns
  std::vector<Candidate> runners_up;
  std::vector<Series> before;  ///< the records, where the step changed them
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

/// The library's columns over the records.
struct Evaluated {
  std::vector<Equations> equations;
  Regression regression;
};

/// A search on its way: what is known and what was chosen. Functions of it rank the candidates,
/// accept one, refine it, and prune what is no longer needed.
struct State {
  State(const Config& config, const std::vector<Series>& given);

  std::vector<Series> records;
  Scale scale;
  Library library;
  std::shared_ptr<const Evaluated> evaluated;
  std::vector<Chosen> chosen;
  std::vector<BankElement> bank;       ///< in use
  std::optional<BestColumn> bouc_wen;  ///< in the place of a bank
  bool base_friction_left{true};       ///< the base's friction stays beside the bank
  bool spring_added{false};
  bool mass_added{false};
  bool base_takes_spring{false};  ///< it was added to the base, not with the first step
  bool base_takes_mass{false};
  bool refine{true};     ///< the final law by its own motion
  bool followed{false};  ///< what was chosen leaves hardly more of the motion than noise
  Screened screened;     ///< what does so
  std::vector<std::string> notes;
  std::vector<JudgedCandidate> rejected;  ///< of the newest round
  std::vector<Candidate> losers;          ///< the same, after the best
  std::string alike;                      ///< effects that the newest round could not tell apart
};

[[nodiscard]] bool filtered(const State& s);
[[nodiscard]] bool has_friction(const State& s);
/// The base's columns, what was added to it, and more; friction in one of its ways.
[[nodiscard]] ColumnSet set_of(const State& s, const ColumnSet& more, std::size_t width);
[[nodiscard]] Judged judge(const State& s, const ColumnSet& more);
[[nodiscard]] ColumnSet chosen_columns(const State& s);
/// How many of the chosen the base has; they are the first.
[[nodiscard]] std::size_t count_of_base(const State& s);
/// Whether a step was taken.
[[nodiscard]] inline bool has_step(const State& s) { return s.chosen.size() > count_of_base(s); }
[[nodiscard]] inline Judged judge_chosen(const State& s) { return judge(s, chosen_columns(s)); }
/// Held out, of the base and what was chosen.
[[nodiscard]] inline double error(const State& s) { return judge_chosen(s).fit.held_out_nmse; }
/// With the spring and the constant that every comparison carries.
[[nodiscard]] ColumnSet beside_both(const State& s, const ColumnSet& more = {});
/// After the library or the records have changed.
void evaluate_columns(State& s);
/// After columns were added to the library, and nothing else has changed.
void evaluate_added(State& s);
void choose(State& s, Candidate candidate, double gain, double t);
[[nodiscard]] std::vector<Regressor> columns_of(const State& s, const ColumnSet& set);
[[nodiscard]] double ridge(const State& s);
[[nodiscard]] bool can_add(const State& s, const Candidate& candidate);
[[nodiscard]] std::vector<std::string> terms(const State& s);
[[nodiscard]] Floor floor_of(const State& s, const ColumnSet& more);
/// The way to write sign v that a fit has of the base's friction.
[[nodiscard]] bool is_friction(const State& s, Eigen::Index column, const Judged& judged);
/// Whether a friction with memory was chosen.
[[nodiscard]] bool remembers(const State& s);
/// What trials start from: the model so far beside a spring and a constant.
[[nodiscard]] TrialBase trial_base(const State& s);

}  // namespace dampline::app::rig
