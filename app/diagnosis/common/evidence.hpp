// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

#include "app/diagnosis/common/residual.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// The size of the motion that is looked at.
struct EvidenceScale {
  double deflection_m{0.0};  ///< rms
  double velocity_mps{0.0};  ///< rms
  double noise_m{0.0};       ///< of the deflection
  double rate_hz{0.0};
  double duration_s{0.0};
};

/// Looks at what is left, point by point in the order of time: over deflection, velocity, frequency
/// and time; and keeps an excerpt. Memory does not grow with the record.
class EvidenceMeter {
 public:
  explicit EvidenceMeter(const EvidenceScale& scale);
  void add(const EvidencePoint& point);
  /// The next point does not follow the last one.
  void gap();
  /// Adds residual and loops.
  void fill(Evidence& out) const;
  [[nodiscard]] Signature signature() const;

 private:
  void keep(const EvidencePoint& point);

  EvidenceScale scale_;
  ResidualBins deflection_, velocity_, time_;
  ResidualSpectrum spectrum_;
  ResidualMaps maps_;
  double energy_{0.0};
  std::size_t points_{0};
  std::size_t seen_{0};
  std::size_t stride_;
  double excerpt_s_;
  std::vector<LoopRow> best_, current_;  // excerpts: the liveliest so far, and the one being taken
  double best_energy_{0.0};
  double current_energy_{0.0};
};

}  // namespace dampline::app
