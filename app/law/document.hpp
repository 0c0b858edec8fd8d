// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/law/free_run.hpp"

namespace dampline::app::law {

/// A number of a law that was identified, and where it stands.
struct Unknown {
  enum class Part : std::uint8_t { kMass, kCoefficient, kA, kB };
  std::string name;  ///< "m"; c, a or b and the number of its first term: "c2", "a4"
  Part part{Part::kCoefficient};
  std::vector<std::size_t> terms;  ///< that share it; of a mass none
};

/// What a law is of.
enum class Subject : std::uint8_t {
  kDrivenMass,  ///< m x'' + F = f: a force moves a mass
  kDamper,      ///< F = f: the motion is prescribed, the force answers
  kTruck        ///< m y'' + k y + F = -m (z_1'' + z_2''), m half of the moving mass
};

/// Figures of a law for a free run, where it misses something and those of its equations, which
/// leave least of the force, are not the best for its motion.
struct FreeRunFigures {
  Eigen::VectorXd values;      ///< of the law's unknowns, in their order
  Eigen::MatrixXd covariance;  ///< of the values
  State initial;               ///< found with them, of one record:
  std::string record_sha256{};
  double residual_m{0.0};  ///< rms, of the motion of that record
};

/// A law with all that is needed to move it again: `law.json`, schema dampline.law/1.
struct Document {
  Subject subject{Subject::kDamper};
  Law law;
  std::vector<Unknown> unknowns;
  Eigen::MatrixXd covariance;  ///< of the unknowns, in their order
  State initial;               ///< at the first sample of the record that it was found from
  double zero_m{0.0};          ///< the record's deflection where x is 0
  double force_sign{1.0};      ///< -1: the record's force counts the other way
  double sample_rate_hz{0.0};
  double filter_hz{0.0};  ///< corner of the test function that the force was seen through; 0: none
  /// What the law leaves of that record, rms: of its force, of its motion when the force alone
  /// moves it; of a truck of the frame's acceleration. 0: not worked out.
  double residual_n{0.0};
  double residual_m{0.0};
  double residual_mps2{0.0};
  /// Of the force that moved the mass and that no term has, N^2/Hz, below filter_hz. 0: what is
  /// left is no more than noise, or that was not worked out.
  double lacking_n2_hz{0.0};
  std::optional<FreeRunFigures> free_run;
  std::vector<std::string> not_in_it;  ///< effects that were found and are no term, a sentence each
  std::string record;

  [[nodiscard]] Eigen::VectorXd values() const;
  /// The law with other numbers; what must be above 0 stays there.
  [[nodiscard]] Law with(const Eigen::VectorXd& values) const;
  /// The law by which a free run is best.
  [[nodiscard]] Document for_free_run() const;
  /// The equation of motion with the unknowns' names: "m x'' + c1 x + c2 sign(v) = f".
  [[nodiscard]] std::string equation() const;
  /// Unknown i with its deviation and unit: "93.0 ± 2.9 kg".
  [[nodiscard]] std::string text_of(std::size_t i) const;
  /// Deviation of unknown i.
  [[nodiscard]] double std_of(Eigen::Index i) const;
};

/// The effect that a term stands for, its function of the motion (x, v, u), and the units of its
/// coefficient and places; empty where it has no such place.
struct TermText {
  Kind kind;
  const char* name;  ///< in law.json
  const char* effect;
  const char* function;
  const char* unit;
  const char* unit_a;
  const char* unit_b;
};
[[nodiscard]] const TermText& text_of(Kind kind) noexcept;

[[nodiscard]] std::string to_json(const Document& document);
/// Throws RunError naming `origin` and what is missing, of another kind or beyond bounds.
[[nodiscard]] Document read_document(std::string_view text, const std::string& origin);

}  // namespace dampline::app::law
