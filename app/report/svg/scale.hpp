// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace dampline::app::svg {

struct Tick {
  double value{0.0};
  std::string text;
};

/// From numbers to places on a drawing, with the ticks of the axis. Any numbers make a scale.
class Scale {
 public:
  /// `low` and `high` are what was asked for, else the data's.
  Scale(bool log, std::optional<double> low, std::optional<double> high,
        const std::vector<double>& data);
  void place(double from, double to) {
    from_ = from;
    to_ = to;
  }
  [[nodiscard]] double at(double value) const;
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }
  [[nodiscard]] std::vector<Tick> ticks() const;

 private:
  [[nodiscard]] double share(double value) const;
  bool log_;
  double low_{0.0};
  double high_{1.0};
  double from_{0.0};
  double to_{1.0};
};

}  // namespace dampline::app::svg
