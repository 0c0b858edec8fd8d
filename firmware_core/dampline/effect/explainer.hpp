// SPDX-License-Identifier: MIT
#pragma once
#include <array>

#include "dampline/effect/conclusion.hpp"
#include "dampline/effect/diagnosis.hpp"
#include "dampline/effect/parameters.hpp"

namespace dampline::effect {

struct ExplainerConfig {
  double moving_mass_kg{37200.0};
  double floor_nmse{0.0};                      ///< of a complete model, from elsewhere; 0: unknown
  bool base_viscous{false};                    ///< c v belongs to the base model
  bool two_late{true};                         ///< of three channels, beside the third
  std::array<bool, kEffects> allowed = all();  ///< candidates, by Effect
  /// An explanation of the same record by wider grids, or with a channel late that is now set
  /// right: its base counts, its first effect and its late channels stay, what is beside them is
  /// judged anew. Null: there is none.
  const Explanation* known{nullptr};

  static constexpr std::array<bool, kEffects> all() noexcept {
    std::array<bool, kEffects> out{};
    out.fill(true);
    return out;
  }
};

/// Judges every candidate on the sums of a Diagnosis: forward steps until nothing passes, then a
/// check backwards that each effect is still needed. About 1.5 MiB of workspace and some hundred
/// small fits: place it yourself and call it as often as an answer is wanted.
class Explainer {
 public:
  Explainer() noexcept : fitter_{evidence_} {}
  Explainer(const Explainer&) = delete;
  Explainer& operator=(const Explainer&) = delete;

  [[nodiscard]] Explanation explain(const Diagnosis& diagnosis,
                                    const ExplainerConfig& config) noexcept {
    return explain(diagnosis.sums(), config);
  }
  /// The same of what was copied out of a Diagnosis that goes on.
  [[nodiscard]] Explanation explain(const Sums& sums, const ExplainerConfig& config) noexcept;
  /// NMSE of another record's rows by models that were fitted elsewhere; 0 when it has too few.
  /// Precondition: the other Diagnosis has the scale of the one that was explained.
  struct Prediction {
    double base_nmse{0.0};
    double final_nmse{0.0};
  };
  [[nodiscard]] Prediction predict(const Diagnosis& other, const Explanation& by) noexcept;

  /// How late channels of a record still are beside a model's other effects, s. `late`: their time
  /// skews. Precondition: the Diagnosis has the grids of the model.
  [[nodiscard]] std::array<Estimate, kChannels> lateness(const Diagnosis& diagnosis,
                                                         const Model& model,
                                                         const Model& late) noexcept;

  struct Surrogates {
    const Diagnosis& base;
    const Diagnosis* other_noise{nullptr};  ///< the same once more: the floor is the mean of both
    /// The base law with what was found of it: the floor is what a model with both leaves of it.
    const Diagnosis* found{nullptr};
    double share{1.0};                            ///< of the record's rows that the surrogates have
    double unexplained_above{kUnexplainedAbove};  ///< of the floor that they give
  };
  /// What a complete model leaves, from the surrogate: a record of the base law simulated on the
  /// same input, with the sensors' noise and resolution, through the same Estimator and a Diagnosis
  /// of the same scale. Sets the floors; where the first effect gains no more than twice what it
  /// gains on the surrogate, which has none, takes all effects back; concludes. False when a
  /// surrogate has too few rows.
  bool apply_floor(const Surrogates& surrogates, std::uint64_t impacts,
                   Explanation& explanation) noexcept;

 private:
  struct Best {
    bool ok{false};
    Candidate candidate;
    double held_out_nmse{0.0};
    double judged{0.0};  // with a handicap for forms that can do more
  };
  using BestOfEffects = std::array<Best, kEffects>;

  /// Errors of base and steps once more in the weights of the final model: those that effects were
  /// chosen by do not compare from one step to the next.
  void restate(Explanation& explanation) noexcept;
  void restate_runners_up(const Model& model, const ModelFit& now, Step& step) noexcept;
  /// Takes back a step that in the final weights gains nothing; false: there is none.
  bool drop_worthless(Explanation& explanation) noexcept;
  /// Fits a model for its parameters, in the weights of now.
  void look_into(const GramStore& store, const Model& model, double mass_kg) noexcept;
  void try_all(const Model& model, const ModelFit& now, BestOfEffects& best) noexcept;
  /// Fits a model, weighs the scales by what it leaves, and gives late and wrongly scaled channels
  /// the friction and spring that the whole model has.
  [[nodiscard]] ModelFit settle(const GramStore& store, Model& model) noexcept;
  bool forward(Explanation& out, const ModelFit& now) noexcept;
  [[nodiscard]] std::size_t plainer(const Model& model, const Best* const* order, std::size_t found,
                                    const ModelFit& now) noexcept;
  [[nodiscard]] Step step_of(const Model& model, const Best* const* order, std::size_t found,
                             std::size_t c, const ModelFit& now) noexcept;
  bool readjust(Explanation& out, ModelFit& now) noexcept;
  void keep(const GramStore& store, const Explanation& known, Explanation& out,
            ModelFit& now) noexcept;
  [[nodiscard]] RunnerUp runner_up_of(const Model& model, const Candidate& candidate,
                                      const ModelFit& now) noexcept;
  void refine(const Model& model, std::size_t i, const ModelFit& final, Step& step) noexcept;
  /// NMSE with the points of a grid on either side of a model's i-th effect, `apart` from it and in
  /// its line, or in the lines before and after; 0: there is none.
  [[nodiscard]] std::array<double, 2> beside(const Model& model, std::size_t i, int apart,
                                             bool in_line) noexcept;
  /// What a model leaves of a surrogate in a record's weights, as a share of the record's own sum
  /// of squares; negative: the surrogate is too short.
  [[nodiscard]] double left_of_surrogate(const Diagnosis& surrogate, const Model& model,
                                         const ScaleWeights& weights, double target) noexcept;
  /// Whether the first effect gains clearly more than on a surrogate without it.
  [[nodiscard]] bool beats_surrogate(const Diagnosis& surrogate, const Explanation& e) noexcept;
  void backward(Explanation& out, ModelFit& now) noexcept;

  Evidence evidence_;
  ModelFitter fitter_;
  CandidateList candidates_;
  Detail detail_;
  std::array<bool, kEffects> allowed_{};
  bool two_late_{true};
  Grids grids_;
};

}  // namespace dampline::effect
