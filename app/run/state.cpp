// SPDX-License-Identifier: MIT
#include "app/run/state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstring>
#include <fstream>
#include <iterator>
#include <type_traits>

#include "app/error.hpp"
#include "dampline/estimate/merge.hpp"
#include "drivers/checksum/crc32c.hpp"

namespace dampline::app {
namespace {

constexpr std::string_view kMagic = "DAMPLINE";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes =
    kMagic.size() + 4 * sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t);

constexpr std::array<std::uint32_t, 3> kSizes{static_cast<std::uint32_t>(kScales),
                                              static_cast<std::uint32_t>(kRowColumns),
                                              static_cast<std::uint32_t>(kCurveSegments)};

class Writer {
 public:
  void operator()(std::integral auto value) {
    const auto bits = static_cast<std::make_unsigned_t<decltype(value)>>(value);
    for (std::size_t shift = 0; shift < 8 * sizeof(bits); shift += 8)
      bytes_ += static_cast<char>(static_cast<unsigned char>(bits >> shift));
  }
  void operator()(double value) { (*this)(std::bit_cast<std::uint64_t>(value)); }
  template <class T, std::size_t N>
  void operator()(const std::array<T, N>& values) {
    for (const T& value : values) (*this)(value);
  }
  void text(std::string_view value) { bytes_ += value; }
  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// Precondition of every read: the bytes are there. check_frame() and decode_state() know how many.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_{bytes} {}
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void operator()(T& value) {
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
  /// All of a state is such numbers, a megabyte of them.
  template <std::size_t N>
  requires(std::endian::native == std::endian::little) void operator()(
      std::array<double, N>& values) {
    std::memcpy(values.data(), rest_.data(), sizeof(values));
    rest_.remove_prefix(sizeof(values));
  }

 private:
  std::string_view rest_;
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

std::uint32_t checksum(std::string_view bytes) {
  return drivers::crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

[[noreturn]] void fail(const std::string& origin, const std::string& what) {
  throw RunError{fmt::format("{}: {}", origin, what)};
}

/// Size, version and checksum; returns the payload.
std::string_view check_frame(std::string_view bytes, const std::string& origin) {
  if (bytes.substr(0, kMagic.size()) != kMagic.substr(0, bytes.size()) || bytes.empty())
    fail(origin, "is no dampline state");
  if (bytes.size() < kHeaderBytes)
    fail(origin, fmt::format("is cut off after {} bytes", bytes.size()));
  Reader reader{bytes.substr(kMagic.size(), kHeaderBytes - kMagic.size())};
  std::uint32_t version = 0;
  std::array<std::uint32_t, 3> sizes{};
  std::uint64_t hash = 0;
  std::uint64_t payload = 0;
  reader(version);
  reader(sizes);
  reader(hash);
  reader(payload);
  if (version != kVersion)
    fail(origin,
         fmt::format("is a state of version {}; this program reads version {}", version, kVersion));
  const std::size_t rest = bytes.size() - kHeaderBytes;
  if (rest < sizeof(std::uint32_t) || payload != rest - sizeof(std::uint32_t))
    fail(origin, fmt::format("is cut off or has bytes too many: {} after the header, expected {}",
                             rest, payload + sizeof(std::uint32_t)));
  const std::string_view covered = bytes.substr(0, bytes.size() - sizeof(std::uint32_t));
  std::uint32_t stated = 0;
  Reader{bytes.substr(covered.size())}(stated);
  if (checksum(covered) != stated) fail(origin, "is damaged: its checksum does not fit");
  if (sizes != kSizes) fail(origin, "was made with another number of scales, columns or segments");
  return covered.substr(kHeaderBytes);
}

}  // namespace

std::string encode_state(const Statistics& statistics) {
  Writer payload;
  walk(payload, statistics);
  Writer out;
  out.text(kMagic);
  out(kVersion);
  out(kSizes);
  out(statistics.header.basis_hash);
  out(static_cast<std::uint64_t>(payload.bytes().size()));
  out.text(payload.bytes());
  out(checksum(out.bytes()));
  return std::move(out.bytes());
}

void decode_state(std::string_view bytes, const std::string& origin, Statistics& out) {
  const std::string_view payload = check_frame(bytes, origin);
  Measure head;
  StatisticsHeader header;
  walk_head(head, header);
  if (payload.size() >= head.bytes()) {
    Reader first{payload};
    walk_head(first, header);
  }
  Measure factors;
  walk_factors(factors, out.total);
  const std::size_t needed = head.bytes() + (std::size_t{header.entry_count} + 1) * factors.bytes();
  if (header.entry_count > kEntries || payload.size() != needed)
    fail(origin, "has a payload of another length than its entries need");
  const std::size_t before = std::min<std::size_t>(out.header.entry_count, kEntries);
  for (std::size_t i = header.entry_count; i < before; ++i) out.entries[i].clear();
  Reader reader{payload};
  walk(reader, out);
}

void merge_state(Statistics& into, const Statistics& from, const std::string& origin) {
  if (!merge(into, from).ok())
    fail(origin,
         fmt::format("has another basis ({:016x}, expected {:016x}) and cannot be added: the "
                     "sample rate, the curve's nodes or the velocity corner differ",
                     from.header.basis_hash, into.header.basis_hash));
}

void load_state(const std::filesystem::path& file, Statistics& out) {
  std::ifstream stream{file, std::ios::binary};
  const std::string bytes{std::istreambuf_iterator<char>{stream}, {}};
  if (!stream.is_open() || stream.bad()) fail(file.string(), "cannot be read");
  decode_state(bytes, file.string(), out);
}

}  // namespace dampline::app
