// SPDX-License-Identifier: MIT
#include "app/run/state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstring>
#include <memory>
#include <type_traits>

#include "app/error.hpp"
#include "dampline/estimate/merge.hpp"
#include "drivers/checksum/crc32c.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

constexpr std::string_view kMagic = "DAMPLINE";
constexpr std::uint16_t kVersion = 3;
constexpr std::uint16_t kBareVersion = 1;    // sums alone
constexpr std::uint16_t kAlarmsVersion = 3;  // the first that knows alarms
constexpr std::size_t kHeaderBytes =
    kMagic.size() + 4 * sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t);

constexpr std::array<std::uint32_t, 3> kSizes{static_cast<std::uint32_t>(kScales),
                                              static_cast<std::uint32_t>(kRowColumns),
                                              static_cast<std::uint32_t>(kCurveSegments)};

[[noreturn]] void fail(const std::string& origin, const std::string& what) {
  throw RunError{fmt::format("{}: {}", origin, what)};
}

class Writer {
 public:
  void operator()(std::integral auto value) {
    const auto bits = static_cast<std::make_unsigned_t<decltype(value)>>(value);
    for (std::size_t shift = 0; shift < 8 * sizeof(bits); shift += 8)
      bytes_ += static_cast<char>(static_cast<unsigned char>(bits >> shift));
  }
  void operator()(double value) { (*this)(std::bit_cast<std::uint64_t>(value)); }
  void operator()(float value) { (*this)(std::bit_cast<std::uint32_t>(value)); }
  void operator()(const std::string& value) {
    (*this)(static_cast<std::uint32_t>(value.size()));
    text(value);
  }
  template <class T, std::size_t N>
  void operator()(const std::array<T, N>& values) {
    for (const T& value : values) (*this)(value);
  }
  void text(std::string_view value) { bytes_ += value; }
  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// What is not there reads as nothing, and is remembered.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_{bytes} {}
  [[nodiscard]] bool read_all() const { return whole_ && rest_.empty(); }
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void operator()(T& value) {
    if (!has(sizeof(T))) return;
    std::array<char, sizeof(T)> bytes{};
    rest_.copy(bytes.data(), bytes.size());
    rest_.remove_prefix(bytes.size());
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    value = std::bit_cast<T>(bytes);
  }
  template <class T, std::size_t N>
  void operator()(std::array<T, N>& values) {
    for (T& value : values) (*this)(value);
  }
  void operator()(std::string& value) {
    std::uint32_t bytes = 0;
    (*this)(bytes);
    if (!has(bytes)) return;
    value.assign(rest_.substr(0, bytes));
    rest_.remove_prefix(bytes);
  }
  /// All of a state is such numbers, a quarter of a megabyte of them.
  template <std::size_t N>
  requires(std::endian::native == std::endian::little) void operator()(
      std::array<double, N>& values) {
    if (!has(sizeof(values))) return;
    std::memcpy(values.data(), rest_.data(), sizeof(values));
    rest_.remove_prefix(sizeof(values));
  }

 private:
  [[nodiscard]] bool has(std::size_t bytes) {
    whole_ = whole_ && bytes <= rest_.size();
    return whole_;
  }

  std::string_view rest_;
  bool whole_{true};
};

/// Counts what would be written.
class Measure {
 public:
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void operator()(const T& /*value*/) { bytes_ += sizeof(T); }
  template <class T, std::size_t N>
  void operator()(const std::array<T, N>& values) {
    if constexpr (std::is_arithmetic_v<T>)
      bytes_ += N * sizeof(T);
    else
      for (const T& value : values) (*this)(value);
  }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_{0};
};

// Whoever adds a field must add it below, and raise kVersion: the sizes notice when one was
// forgotten.
constexpr std::size_t kWord = 8;
static_assert(sizeof(Counts) == 12 * kWord && sizeof(VelocityCounts) == 19 * kWord);
static_assert(sizeof(StatisticsHeader) ==
              sizeof(Counts) + sizeof(VelocityCounts) + (6 + kCurveSegments) * kWord);

template <class Archive, class Factors>
void walk_factors(Archive& archive, Factors& factors) {
  for (auto& factor : factors.factor) archive(factor.packed());
  archive(factors.rows);
  archive(factors.blocks);
}

template <class Archive, class Header>
void walk_header(Archive& archive, Header& h) {
  archive(h.basis_hash);
  archive(h.sample_rate_hz);
  archive(h.velocity_corner_hz);
  archive(h.curve_nodes_mps);
  archive(h.entry_count);
  archive(h.blocks_per_entry);
  archive(h.velocity.positive);
  archive(h.velocity.negative);
  archive(h.velocity.moving);
  archive(h.velocity.sticking);
  archive(h.velocity.sum_squares);
  archive(h.noise_mps2);
  archive(h.newest_tick);
}

template <class Archive, class C>
void walk_counts(Archive& archive, C& c) {
  archive(c.samples);
  archive(c.gaps);
  archive(c.lost);
  archive(c.saturated);
  archive(c.stuck);
  archive(c.not_finite);
  archive(c.repeated);
  archive(c.blocks);
  archive(c.blocks_excluded);
  archive(c.blocks_still);
  archive(c.rows);
  archive(c.rows_still);
}

/// One list of the fields serves both directions.
template <class Archive, class Header>
void walk_head(Archive& archive, Header& header) {
  walk_header(archive, header);
  walk_counts(archive, header.counts);
}

template <class Archive, class S>
void walk(Archive& archive, S& statistics) {
  walk_head(archive, statistics.header);
  walk_factors(archive, statistics.total);
  const std::size_t entries = std::min<std::size_t>(statistics.header.entry_count, kEntries);
  for (std::size_t i = 0; i < entries; ++i) walk_factors(archive, statistics.entries[i]);
}

/// In single precision. 24 bits of a factor's element keep level and stiffness to some 1e-6 of
/// their values: `LightState` in tests/fleet holds it.
void write_light(Writer& out, const ScaleFactors& factors) {
  for (const RowFactor& factor : factors.factor)
    for (const double x : factor.packed()) out(static_cast<float>(x));
  out(factors.rows);
  out(factors.blocks);
}
void read_light(Reader& in, ScaleFactors& factors) {
  for (RowFactor& factor : factors.factor)
    for (double& x : factor.packed()) {
      float single = 0.0F;
      in(single);
      x = single;
    }
  in(factors.rows);
  in(factors.blocks);
}

void walk_estimate(auto& archive, auto& estimate) {
  archive(estimate.value);
  archive(estimate.std);
}

template <class Archive, class About>
void walk_about(Archive& archive, About& a) {
  archive(a.segment.vehicle);
  archive(a.segment.truck);
  archive(a.segment.start_ns);
  archive(a.segment.record);
  archive(a.sequence);
  archive(a.segments);
  archive(a.end_ns);
  archive(a.load);
  archive(a.moving_mass_kg);
  walk_estimate(archive, a.rate_hz);
  walk_estimate(archive, a.coulomb_n);
  walk_estimate(archive, a.stiffness_npm);
}

/// With what is no plain number, and what came later.
void write_about(Writer& out, const StateAbout& about) {
  walk_about(out, about);
  out(static_cast<std::uint32_t>(about.viscous ? 1 : 0));
  out(static_cast<std::uint32_t>(about.trust));
  out(about.alarms);
}
StateAbout read_about(Reader& in, std::uint16_t version, const std::string& origin) {
  StateAbout about;
  std::uint32_t viscous = 0;
  std::uint32_t trust = 0;
  walk_about(in, about);
  in(viscous);
  in(trust);
  if (version >= kAlarmsVersion) in(about.alarms);
  if (!in.read_all() || viscous > 1 || trust > static_cast<std::uint32_t>(Trust::kNotIdentified) ||
      about.segments == 0)
    fail(origin, "does not say what it is of as states of this version do");
  about.viscous = viscous == 1;
  about.trust = static_cast<Trust>(trust);
  return about;
}

std::uint32_t checksum(std::string_view bytes) {
  return drivers::crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

struct Frame {
  std::uint16_t version{0};
  StateKind kind{StateKind::kFull};
  std::string_view payload;
};

/// Size, version and checksum.
Frame check_frame(std::string_view bytes, const std::string& origin) {
  if (bytes.substr(0, kMagic.size()) != kMagic.substr(0, bytes.size()) || bytes.empty())
    fail(origin, "is no dampline state");
  if (bytes.size() < kHeaderBytes)
    fail(origin, fmt::format("is cut off after {} bytes", bytes.size()));
  Reader reader{bytes.substr(kMagic.size(), kHeaderBytes - kMagic.size())};
  Frame frame;
  std::uint16_t kind = 0;
  std::array<std::uint32_t, 3> sizes{};
  std::uint64_t hash = 0;
  std::uint64_t payload = 0;
  reader(frame.version);
  reader(kind);
  reader(sizes);
  reader(hash);
  reader(payload);
  if (frame.version < kBareVersion || frame.version > kVersion)
    fail(origin, fmt::format("is a state of version {}; this program reads versions {} to {}",
                             frame.version, kBareVersion, kVersion));
  if (kind > static_cast<std::uint16_t>(frame.version == kBareVersion ? StateKind::kFull
                                                                      : StateKind::kLight))
    fail(origin, fmt::format("is a state of kind {}, which this program does not know", kind));
  frame.kind = static_cast<StateKind>(kind);
  const std::size_t rest = bytes.size() - kHeaderBytes;
  if (rest < sizeof(std::uint32_t) || payload != rest - sizeof(std::uint32_t))
    fail(origin, fmt::format("is cut off or has bytes too many: {} after the header, expected {}",
                             rest, payload + sizeof(std::uint32_t)));
  const std::string_view covered = bytes.substr(0, bytes.size() - sizeof(std::uint32_t));
  std::uint32_t stated = 0;
  Reader{bytes.substr(covered.size())}(stated);
  if (checksum(covered) != stated) fail(origin, "is damaged: its checksum does not fit");
  if (sizes != kSizes) fail(origin, "was made with another number of scales, columns or segments");
  frame.payload = covered.substr(kHeaderBytes);
  return frame;
}

/// Bytes of the sums at the beginning of the payload.
std::size_t sums_bytes(const Frame& frame, const std::string& origin) {
  Measure head;
  StatisticsHeader header;
  walk_head(head, header);
  Reader reader{frame.payload};
  walk_head(reader, header);
  Measure factors;
  const auto whole = std::make_unique<ScaleFactors>();
  walk_factors(factors, *whole);
  const std::size_t doubles = kScales * RowFactor::kSize * sizeof(double);
  const std::size_t needed =
      head.bytes() + (frame.kind == StateKind::kLight
                          ? factors.bytes() - doubles / 2
                          : (std::size_t{header.entry_count} + 1) * factors.bytes());
  const bool entries =
      frame.kind == StateKind::kLight ? header.entry_count == 0 : header.entry_count <= kEntries;
  const bool fits = frame.version == kBareVersion ? frame.payload.size() == needed
                                                  : frame.payload.size() >= needed;
  if (!entries || !fits) fail(origin, "has a payload of another length than its entries need");
  return needed;
}

void read_sums(Reader& reader, StateKind kind, Statistics& out) {
  const std::size_t before = std::min<std::size_t>(out.header.entry_count, kEntries);
  if (kind == StateKind::kFull) {
    walk(reader, out);
  } else {
    walk_head(reader, out.header);
    read_light(reader, out.total);
    out.header.entry_count = 1;
    out.header.blocks_per_entry = std::bit_ceil(std::max(out.total.blocks, 1U));
    out.entries[0] = out.total;
  }
  for (std::size_t i = out.header.entry_count; i < before; ++i) out.entries[i].clear();
}

}  // namespace

std::string encode_state(const Statistics& statistics, const StateAbout& about, StateKind kind) {
  Writer payload;
  if (kind == StateKind::kFull) {
    walk(payload, statistics);
  } else {
    StatisticsHeader header = statistics.header;
    header.entry_count = 0;
    walk_head(payload, header);
    write_light(payload, statistics.total);
  }
  write_about(payload, about);
  Writer out;
  out.text(kMagic);
  out(kVersion);
  out(static_cast<std::uint16_t>(kind));
  out(kSizes);
  out(statistics.header.basis_hash);
  out(static_cast<std::uint64_t>(payload.bytes().size()));
  out.text(payload.bytes());
  out(checksum(out.bytes()));
  return std::move(out.bytes());
}

StateAbout decode_state(std::string_view bytes, const std::string& origin, Statistics& out) {
  const Frame frame = check_frame(bytes, origin);
  const std::size_t sums = sums_bytes(frame, origin);
  StateAbout about;
  if (frame.version != kBareVersion) {
    Reader tail{frame.payload.substr(sums)};
    about = read_about(tail, frame.version, origin);
  }
  Reader reader{frame.payload};
  read_sums(reader, frame.kind, out);
  return about;
}

bool is_light_state(std::string_view bytes) {
  std::uint16_t kind = 0;
  Reader{bytes.substr(std::min(bytes.size(), kMagic.size() + sizeof(kVersion)))}(kind);
  return kind == static_cast<std::uint16_t>(StateKind::kLight);
}

std::string other_basis(const StatisticsHeader& first, const StatisticsHeader& other) {
  if (first.basis_hash == other.basis_hash) return "";
  if (first.sample_rate_hz != other.sample_rate_hz)
    return fmt::format("its nominal sample rate is {:.6g} Hz, expected {:.6g} Hz",
                       other.sample_rate_hz, first.sample_rate_hz);
  if (first.velocity_corner_hz != other.velocity_corner_hz)
    return fmt::format(
        "its velocity's drift filter has its corner at {} Hz, expected {} Hz; [model] "
        "velocity_corner_hz states it",
        other.velocity_corner_hz, first.velocity_corner_hz);
  if (first.curve_nodes_mps != other.curve_nodes_mps)
    return "its curve has other nodes ([model] curve_nodes_mps)";
  return "its anti-aliasing filter, windows or further masses differ ([input.anti_alias], [car])";
}

void merge_state(Statistics& into, const Statistics& from, const std::string& origin) {
  if (!merge(into, from).ok())
    fail(origin, "has another basis and cannot be added: " + other_basis(into.header, from.header));
}

StateAbout load_state(const std::filesystem::path& file, Statistics& out) {
  const auto bytes = drivers::read_whole(file.string());
  if (!bytes) throw RunError{bytes.error_text()};
  return decode_state(bytes.value(), file.string(), out);
}

}  // namespace dampline::app
