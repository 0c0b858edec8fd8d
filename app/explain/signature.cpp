// SPDX-License-Identifier: MIT
#include "app/explain/signature.hpp"

#include <fmt/format.h>

namespace dampline::app {
namespace {

std::string kind_of(const Signature& s) {
  if (s.has_memory())
    return fmt::format("depends on the travel since the reversal ({:.0f} % of it)",
                       100.0 * s.travel_share);
  if (!s.memoryless()) return "no function of deflection and velocity, nor of the last reversal";
  const char* symmetry = s.odd_share > Signature::kMostly         ? "odd"
                         : s.odd_share < 1.0 - Signature::kMostly ? "even"
                                                                  : "neither odd nor even";
  return fmt::format("a function of deflection and velocity, {} ({:.0f} % of it)", symmetry,
                     100.0 * s.surface_share);
}

}  // namespace

std::string describe(const Signature& s) {
  return fmt::format("{:.4g} N rms; {}; {:.3g} to {:.3g} Hz", s.rms_n, kind_of(s), s.low_hz,
                     s.high_hz);
}

}  // namespace dampline::app
