// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/diagnosis/rig/rig_bouc_wen.hpp"
#include "app/diagnosis/rig/rig_explanation.hpp"
#include "app/diagnosis/rig/rig_library.hpp"
#include "app/diagnosis/rig/rig_trials.hpp"
#include "app/diagnosis/rig/rig_twin.hpp"

namespace dampline::app {

/// Looks for what a rig's base model lacks: every effect in its smallest form, beside a constant
/// and a spring; the best is added while it helps on what was held out, then each is tried without;
/// a memory of the friction is refined to a bank of stop operators.
class RigSearch {
 public:
  RigSearch(const Config& config, const std::vector<RigSeries>& records);
  [[nodiscard]] RigExplanation run();

 private:
  struct Chosen {
    RigCandidate candidate;
    RigStep step;
    double ridge{0.0};
    double other_memory{0.0};
    double skew_s{0.0};  ///< of time_skew, which has no columns
    RigMode path;        ///< of unmodelled_mode where it has no columns
  };
  struct Judged {
    RigFit fit;
    std::size_t width{0};
  };

  /// The best candidate of an effect.
  struct Ranked {
    const RigCandidate* candidate{nullptr};
    double gain{0.0};
    double t{0.0};
    RigFit fit;
    bool needs_excess{false};  ///< over the floor, however sure it is
  };

  [[nodiscard]] ColumnSet set_of(const ColumnSet& more, std::size_t width) const;
  [[nodiscard]] Judged judge(const ColumnSet& more) const;
  [[nodiscard]] ColumnSet chosen_columns() const;
  [[nodiscard]] std::vector<RigColumn> columns_of(const ColumnSet& set) const;
  [[nodiscard]] const RigColumn& column_of(const Chosen& chosen) const {
    return library_.columns[static_cast<std::size_t>(chosen.candidate.columns.front())];
  }
  [[nodiscard]] double ridge() const;
  [[nodiscard]] bool can_add(const RigCandidate& candidate) const;
  [[nodiscard]] std::vector<std::string> terms() const;
  [[nodiscard]] RigFloor floor_of(const ColumnSet& more) const;
  [[nodiscard]] bool has_driving_friction(const RigFit& fit) const;
  [[nodiscard]] std::vector<Ranked> rank() const;
  [[nodiscard]] bool passes(const Ranked& top, double before_nmse) const;
  [[nodiscard]] RigFit best_with(const RigCandidate& first) const;
  void prefer_beside_another(std::vector<Ranked>& order) const;
  void prefer_to_offset(std::vector<Ranked>& order) const;
  [[nodiscard]] std::string alike(const std::vector<Ranked>& order) const;
  [[nodiscard]] RigTrialBase trial_base() const;
  [[nodiscard]] std::optional<RigTrial> best_trial(double before_nmse) const;
  void prefer_mode(std::optional<RigTrial>& best) const;
  bool take_mass(const std::vector<Ranked>& order, const std::optional<RigTrial>& trial);
  [[nodiscard]] bool is_better(const RigTrial& trial, const std::vector<Ranked>& order) const;
  void take(const RigTrial& trial, double before);
  void take_mode(const RigTrial& trial, Chosen& chosen);
  void describe_drift(Chosen& chosen, const Judged& now, const ColumnSet& set) const;
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
  void count_noise(RigExplanation& out) const;
  [[nodiscard]] bool filtered() const;
  void describe(RigModel& model, const Judged& judged, const ColumnSet& more) const;
  void describe_bouc_wen(Chosen& chosen, const Estimate& first) const;
  void describe_bank(Chosen& chosen, const Judged& now) const;
  void describe_small(Chosen& chosen, const Estimate& first) const;
  void describe_sides(Chosen& chosen, const Judged& now, const ColumnSet& set) const;
  void describe_steps(const Judged& now);

  std::vector<RigSeries> records_;
  RigScale scale_;
  RigLibrary library_;
  std::unique_ptr<RigEvidence> evidence_;
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

}  // namespace dampline::app
