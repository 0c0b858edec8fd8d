// SPDX-License-Identifier: MIT
#include "app/law/regressor.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::app::law {
namespace {

constexpr double kBreakawayM = 0.010;
constexpr double kEdgeFrom = 0.9;

double hat(double u, double node) {
  const double width = 2.0 / (Regressor::kHats - 1);
  const double centre = -1.0 + width * node;
  return std::max(0.0, 1.0 - std::abs(u - centre) / width);
}

/// tanh, of which the library's is slow near 0 where it keeps digits that no force has.
double softened_sign(double u) {
  constexpr double kOne = 19.1;  // beyond it tanh is 1 in double precision
  if (std::abs(u) > kOne) return std::copysign(1.0, u);
  return std::copysign(1.0 - 2.0 / (std::exp(2.0 * std::abs(u)) + 1.0), u);
}

}  // namespace

double value_at(const Regressor& c, double x, double v) noexcept {
  switch (c.kind) {
    case Kind::kInertia:
    case Kind::kDeflection:
      return x;
    case Kind::kSquare:
      return x * x;
    case Kind::kCube:
      return x * x * x;
    case Kind::kMagnitude:
      return std::abs(x);
    case Kind::kBumpUp:
      return std::max(x - c.a, 0.0);
    case Kind::kBumpDown:
      return std::min(x + c.a, 0.0);
    case Kind::kVelocity:
      return v;
    case Kind::kSpeed:
      return std::abs(v);
    case Kind::kSpeedSquared:
      return v * std::abs(v);
    case Kind::kSquareVelocity:
      return x * x * v;
    case Kind::kSign:
      return softened_sign(v / c.a);
    case Kind::kFading:
      return softened_sign(v / c.a) * std::exp(-std::abs(v) / c.b);
    case Kind::kFadingSquare:
      return softened_sign(v / c.a) * std::exp(-v * v / (c.b * c.b));
    case Kind::kFadingSlowly:
      return softened_sign(v / c.a) / (1.0 + v * v / (c.b * c.b));
    case Kind::kProgressive:
      return softened_sign(v / c.a) * x;
    case Kind::kProgressiveAbsolute:
      return softened_sign(v / c.a) * std::abs(x);
    default:
      return 1.0;
  }
}

double memory_at(const Regressor& c, double u, double v, double slip_m) noexcept {
  switch (c.kind) {
    case Kind::kStop:
      return u;
    case Kind::kGapUp:
      return std::pow(std::max(u, 0.0), 4);
    case Kind::kGapDown:
      return -std::pow(std::max(-u, 0.0), 4);
    case Kind::kEdge:
      return std::copysign(std::max(0.0, (std::abs(u) - kEdgeFrom) / (1.0 - kEdgeFrom)), u);
    case Kind::kHat:
      return hat(u, c.b);
    case Kind::kFall:
      return std::abs(v) * std::clamp(2.0 * c.b * u - 1.0, 0.0, 1.0);
    default:
      return c.b * u >= 1.0 ? std::abs(v) * std::exp(-slip_m / kBreakawayM) : 0.0;
  }
}

}  // namespace dampline::app::law
