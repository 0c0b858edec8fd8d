// SPDX-License-Identifier: MIT
#include "app/report/svg/scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace dampline::app::svg {
namespace {

constexpr double kMost = 1e300;    // widths stay finite
constexpr double kLeast = 1e-300;  // of a logarithmic axis
constexpr double kFar = 1e4;       // off any drawing
constexpr int kMostTicks = 16;

/// 1, 2 or 5 times a power of ten: four to eight on an axis.
double tick_step(double width) {
  const double rough = width / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double digit = rough / power;
  return power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
}

std::string power_of_ten(int exponent) {
  constexpr std::array kDigits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = exponent < 0 ? "10⁻" : "10";
  for (const char digit : fmt::format("{}", std::abs(exponent)))
    out += kDigits.at(static_cast<std::size_t>(digit - '0'));
  return out;
}

}  // namespace

Scale::Scale(bool log, std::optional<double> low, std::optional<double> high,
             const std::vector<double>& data)
    : log_{log} {
  bool any = false;
  for (const double raw : data) {
    if (!std::isfinite(raw) || (log_ && raw <= 0.0)) continue;
    const double value = std::clamp(raw, -kMost, kMost);
    low_ = any ? std::min(low_, value) : value;
    high_ = any ? std::max(high_, value) : value;
    any = true;
  }
  if (low && std::isfinite(*low)) low_ = std::clamp(*low, -kMost, kMost);
  if (high && std::isfinite(*high)) high_ = std::clamp(*high, -kMost, kMost);
  if (log_) {
    low_ = std::max(low_, kLeast);
    high_ = std::max(high_, 1.001 * low_);
  }
  const double least = 1e-9 * std::max(std::fabs(low_), std::fabs(high_)) + kLeast;
  if (high_ - low_ >= least) return;
  const double half = std::max(0.05 * std::fabs(low_), 1e-6);
  low_ -= half;
  high_ += half;
}

double Scale::share(double value) const {
  if (log_) return std::log(std::max(value, kLeast) / low_) / std::log(high_ / low_);
  return (value - low_) / (high_ - low_);
}

double Scale::at(double value) const {
  return std::clamp(from_ + (to_ - from_) * share(value), -kFar, kFar);
}

std::vector<Tick> Scale::ticks() const {
  std::vector<Tick> out;
  if (log_) {
    const int first = static_cast<int>(std::ceil(std::log10(low_) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
    const int step = 1 + (last - first) / 8;
    for (int k = first; k <= last; k += step) out.push_back({std::pow(10.0, k), power_of_ten(k)});
    return out;
  }
  const double step = tick_step(high_ - low_);
  const double first = std::ceil(low_ / step - 1e-9);
  for (int i = 0; i < kMostTicks && (first + i) * step <= high_ + 1e-9 * step; ++i)
    out.push_back({(first + i) * step, fmt::format("{:.6g}", (first + i) * step + 0.0)});
  return out;
}

}  // namespace dampline::app::svg
