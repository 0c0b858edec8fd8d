// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/explain/evidence_point.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// Mean and rms of what two models leave, over bins of one quantity.
class ResidualBins {
 public:
  /// Equal bins from `low` to `high`; what lies outside is not counted.
  ResidualBins(std::string over, double low, double high, std::size_t bins);
  void add(double place, const EvidencePoint& point);
  /// Bins with enough samples.
  [[nodiscard]] std::vector<ResidualRow> rows() const;

 private:
  struct Sums {
    std::uint64_t samples{0};
    double before{0.0};
    double before_squares{0.0};
    double after{0.0};
    double after_squares{0.0};
  };
  std::string over_;
  double low_;
  double width_;
  std::vector<Sums> sums_;
};

}  // namespace dampline::app
