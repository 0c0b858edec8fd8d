// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/record/feed.hpp"
#include "app/run/result.hpp"
#include "drivers/csv/reader.hpp"

namespace dampline::app::wavelet {

/// What the columns of several masses, or of a base and what stands on it, are for.
enum class Role : std::uint8_t { kTime, kDeflection, kForce, kBaseAccel, kResponseAccel };

/// A column that was recognised: canonical ("deflection2_m"), or by words, number and unit
/// ("x2 [mm]", "base acc (g)").
struct MassColumn {
  Role role{Role::kTime};
  int mass{0};  ///< 0 and 1; of time and base 0
  std::string header;
  double factor{1.0};  ///< to s, m, N, m/s^2
};

/// Whether the header has a base's and a response's acceleration.
[[nodiscard]] bool has_base_and_response(const std::string& path);

/// The columns of `masses` masses: deflections and at least one force, or else accelerations of the
/// base and of each mass. Throws RunError listing what is missing and what is there.
[[nodiscard]] std::vector<MassColumn> find_mass_columns(const std::string& path, int masses);

/// A row of such a file in SI units; what is missing is NaN, a force without a column 0.
struct MassLine {
  std::uint64_t line{0};
  double time_s{std::numeric_limits<double>::quiet_NaN()};
  std::array<double, 2> first{};   ///< deflections, or responses
  std::array<double, 2> second{};  ///< forces, or the base in both
};

struct MassLines {
  bool accelerations{false};
  std::vector<MassLine> lines;
  std::vector<std::string> notes;  ///< what was understood
};

/// Reads the file whole. Throws RunError with file and line. Counts and notes go into `reading`.
[[nodiscard]] MassLines read_mass_lines(const SourceOptions& source, int masses,
                                        RunResult& reading);

}  // namespace dampline::app::wavelet
