// SPDX-License-Identifier: MIT
#include "app/motion/writers.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <string_view>

#include "app/error.hpp"
#include "app/run/json.hpp"
#include "app/verbs/output.hpp"
#include "drivers/record/column_file.hpp"

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

double number_of(const MotionRow& row, std::size_t column) {
  return column == 0 ? row.time_s : column == 1 ? row.deflection_m : row.velocity_mps;
}

/// Through a file without a name, since the libraries write anywhere in theirs.
void write_columns(MotionSeries& series, MotionFormat format, TextFile& out) {
  struct Closer {
    void operator()(std::FILE* file) const noexcept {
      std::fclose(file);  // NOLINT(*-owning-memory): the pointer's deleter
    }
  };
  const std::unique_ptr<std::FILE, Closer> file{std::tmpfile()};
  if (!file) throw RunError{"there is no room in the temporary folder"};
  drivers::ColumnTable table;
  table.names = {"time_s", "deflection_m", "velocity_mps"};
  table.rows = series.summary().rows;
  table.fill = [&](std::size_t column, std::span<double> values) {
    std::size_t at = 0;
    series.each([&](const MotionRow& row) { values[at++] = number_of(row, column); });
  };
  const std::string path = fmt::format("/proc/self/fd/{}", ::fileno(file.get()));
  const auto written = format == MotionFormat::kMat ? drivers::write_mat(path, table)
                                                    : drivers::write_hdf5(path, table);
  if (!written.ok() && written.failure().code == Errc::kInvalidConfig)
    throw UsageError{fmt::format("--out: {}", written.error_text())};
  if (!written) throw RunError{written.error_text()};
  std::array<char, 65536> part{};
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), file.get())) {
    out.buffer().append(part.data(), part.data() + count);
    out.tick();
  }
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
  const auto has = [&](bool written, const char* package) {
    if (!written)
      throw UsageError{
          fmt::format("--out: found {}, which this program was built without; build it "
                      "with {}, or name a file that ends in .csv or .npy",
                      suffix, package)};
  };
  if (suffix == ".mat") {
    has(drivers::writes_mat(), "libmatio-dev");
    return MotionFormat::kMat;
  }
  if (suffix == ".h5" || suffix == ".hdf5") {
    has(drivers::writes_hdf5(), "libhdf5-dev");
    return MotionFormat::kHdf5;
  }
  throw UsageError{
      fmt::format("--out: found {}, expected a name that ends in .csv, .npy, .mat or .h5", file)};
}

void write_motion(MotionSeries& series, const std::string& file, MotionFormat format,
                  bool replace) {
  TextFile out{file, replace};
  if (format == MotionFormat::kMat || format == MotionFormat::kHdf5) {
    write_columns(series, format, out);
    out.close();
    return;
  }
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
