// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/diagnosis/common/residual.hpp"
#include "app/run/result.hpp"
#include "app/run/trust.hpp"

namespace dampline::app {

/// An effect that was tried and not chosen.
struct JudgedCandidate {
  std::string effect;
  double held_out_nmse{0.0};
  double gain{0.0};     ///< share of the held-out error that it takes away
  double block_t{0.0};  ///< mean over deviation of the mean of the blocks' improvements
};

/// One effect that was added.
struct Step {
  std::string effect;
  std::string of{"force_n"};       ///< whose error is meant
  std::vector<std::string> terms;  ///< of the model with it
  double held_out_before{0.0};     ///< nmse
  double held_out_after{0.0};
  double gain{0.0};     ///< of a rig beside a constant and a spring, which every comparison carries
  double block_t{0.0};  ///< as of a candidate; 0: the step was judged otherwise
  std::vector<Parameter> parameters;
  std::vector<JudgedCandidate> runners_up;
};

/// A model of the force and what it leaves, held out.
struct ModelFound {
  std::vector<std::string> terms;
  double held_out_nmse{0.0};
  std::vector<Parameter> parameters;
  std::vector<std::pair<std::string, double>> records;  ///< nmse of each; of a rig
};

/// Errors on a record that was never fitted. The force of a rig sets nothing but the slip at the
/// start, from the first second.
struct Validated {
  std::string record;
  double rrse_before{0.0};
  double rrse_after{0.0};
  std::optional<double> start_m{};
  bool has_reference{false};
  double reference_rrse{0.0};  ///< over the samples that the reference has
  double same_rows_rrse{0.0};  ///< of the final model over the same samples
};

/// What a law leaves of the deflection when the force alone moves the mass.
struct FreeRunError {
  std::size_t segments{0};  ///< 0: it was not tried
  double segment_s{0.0};
  double nmse_of_equations{0.0};  ///< by the equations' coefficients
  double nmse_of_motion{0.0};     ///< held out, by those that fit the motion
  double residual_m{0.0};         ///< rms, of the motion's
  double noise_m{0.0};            ///< of the deflection, rms
  /// Density of what is left where the motion is, over that beside it; 1: noise. Absent: unknown.
  std::optional<double> density_ratio{};
  /// The same where the law itself moves under a force as noisy as the measured one. Absent:
  /// unknown, or not asked.
  std::optional<double> density_ratio_of_noise{};
  bool followed{false};     ///< no more than noise is left
  bool agree{false};        ///< both within their deviations
  bool by_motion{false};    ///< the law has the motion's
  bool has_figures{false};  ///< it has not, but a free run takes them
};

/// What a diagnosis found, of a truck or a rig: explanation.json, terminal and page are made of it.
struct Explanation {
  std::string verdict;  ///< "complete", "explained", "partly_explained", "unexplained"
  Explaining known;
  ModelFound base;
  ModelFound final;
  std::vector<Step> steps;
  std::vector<JudgedCandidate> rejected;               ///< the best of the round that added nothing
  double floor_nmse{0.0};                              ///< what a complete model leaves; 0: unknown
  std::string floor_by{"sensors and rounding alone"};  ///< what leaves it
  double left_over_floor{0.0};                         ///< what is left, over that; 0: unknown
  bool law_incomplete{false};      ///< more is left than the first step's law would leave
  bool unknown{false};             ///< something real is left that has no name
  std::string alike;               ///< effects that explain alike: none is named; or empty
  std::string held_out{"blocks"};  ///< or "records"
  double filter_hz{0.0};           ///< corner of the filter before every error; 0: none
  std::string force;               ///< what force is meant
  FreeRunError free_run;           ///< of a driven mass
  std::vector<Validated> validation;
  std::vector<FaultFinding> faults;
  std::vector<std::string> notes;  ///< how the records were read, a sentence each
  Signature signature;             ///< rms 0: the record was read only once
  std::array<const char*, kEvidenceChannels> channels{};
  Trust trust{Trust::kNotIdentified};
  std::vector<std::string> trust_reasons;
};

struct ModelConfig;
/// Whether [model] candidates names it, or all.
[[nodiscard]] bool is_wanted(const ModelConfig& model, std::string_view effect);

/// Puts the final law in the place of what identify says of the record; where effects were added,
/// the law before goes to its `base`. Errors become one chain: base, steps, final. Judges both.
void put_final(Explanation& explanation, RunResult& result);

/// As explanation.json holds it: valid JSON, a trailing newline.
[[nodiscard]] std::string to_json(const Explanation& explanation);

/// For a terminal: verdict, errors from base to final, each step with its parameters.
[[nodiscard]] std::string summarize(const Explanation& explanation);

}  // namespace dampline::app
