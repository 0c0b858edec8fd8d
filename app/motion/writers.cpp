// SPDX-License-Identifier: MIT
#include "app/motion/writers.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "app/error.hpp"
#include "app/run/json.hpp"
#include "app/verbs/output.hpp"

namespace dampline::app {
namespace {

/// NumPy's format 1.0 (numpy.lib.format): magic, length, a Python literal padded with blanks to
/// whole 64 bytes, then the rows as they lie in memory.
std::string npy_header(std::uint64_t rows) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::size_t kBeforeText = 10;
  constexpr std::size_t kAlign = 64;
  std::string text = fmt::format(
      "{{'descr': [('time_s', '<f8'), ('deflection_m', '<f8'), ('velocity_mps', '<f8')], "
      "'fortran_order': False, 'shape': ({},), }}",
      rows);
  while ((kBeforeText + text.size() + 1) % kAlign != 0) text += ' ';
  text += '\n';
  std::string out = "\x93NUMPY";
  out += '\x01';
  out += '\0';
  out += static_cast<char>(text.size() & 0xFFU);
  out += static_cast<char>(text.size() >> 8U);
  return out + text;
}

void append_npy(const MotionRow& row, fmt::memory_buffer& out) {
  const std::array<double, 3> values{row.time_s, row.deflection_m, row.velocity_mps};
  std::array<char, sizeof values> bytes{};
  std::memcpy(bytes.data(), values.data(), sizeof values);
  out.append(bytes.data(), bytes.data() + bytes.size());
}

std::string csv_header(const MotionSummary& summary) {
  std::string out;
  std::istringstream lines{motion_text(summary)};
  for (std::string line; std::getline(lines, line);) out += "# " + line + "\n";
  return out + "time_s,deflection_m,velocity_mps\n";
}

}  // namespace

MotionFormat motion_format(const std::string& file) {
  const std::string suffix = std::filesystem::path{file}.extension().string();
  if (file == "-" || suffix == ".csv") return MotionFormat::kCsv;
  if (suffix == ".npy") return MotionFormat::kNpy;
  throw UsageError{fmt::format("--out: found {}, expected a name that ends in .csv or .npy", file)};
}

void write_motion(MotionSeries& series, const std::string& file, MotionFormat format,
                  bool replace) {
  TextFile out{file, replace};
  const std::string head = format == MotionFormat::kNpy ? npy_header(series.summary().rows)
                                                        : csv_header(series.summary());
  out.buffer().append(head.data(), head.data() + head.size());
  series.each([&](const MotionRow& row) {
    if (format == MotionFormat::kNpy)
      append_npy(row, out.buffer());
    else
      fmt::format_to(std::back_inserter(out.buffer()), "{},{},{}\n", row.time_s, row.deflection_m,
                     row.velocity_mps);
    out.tick();
  });
  out.close();
}

std::string motion_text(const MotionSummary& s) {
  return fmt::format(
      "motion: {} rows at {:.6g} Hz, {} gaps\n"
      "band: velocity from {:.3g} Hz, deflection from {:.3g} Hz, to {:.3g} Hz; what is slower is "
      "drift and taken off\n"
      "latency: {:.3g} s from a sample to its motion in a live run, {:.3g} s of it the wait for "
      "the "
      "guards\n"
      "noise, rms: {:.3g} m of the deflection, {:.3g} m/s of the velocity, by {:.3g} m/s^2 of each "
      "sensor, which is an upper bound\n",
      s.rows, s.sample_rate_hz, s.gaps, s.low_hz, s.deflection_low_hz, s.high_hz, s.latency_s,
      s.judgement_s, s.deflection_noise_m, s.velocity_noise_mps, s.noise_mps2);
}

std::string motion_json(const MotionSummary& s) {
  return json_text({{"rows", s.rows},
                    {"gaps", s.gaps},
                    {"sample_rate_hz", s.sample_rate_hz},
                    {"velocity_low_hz", s.low_hz},
                    {"deflection_low_hz", s.deflection_low_hz},
                    {"high_hz", s.high_hz},
                    {"latency_s", s.latency_s},
                    {"judgement_s", s.judgement_s},
                    {"sensor_noise_mps2", s.noise_mps2},
                    {"velocity_noise_mps", s.velocity_noise_mps},
                    {"deflection_noise_m", s.deflection_noise_m}});
}

}  // namespace dampline::app
