// SPDX-License-Identifier: MIT
#include "drivers/npy/header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>

#include "drivers/bytes/little_endian.hpp"

namespace dampline::drivers {
namespace {

constexpr std::string_view kMark = "\x93NUMPY";
constexpr std::size_t kMostFields = 1024;

/// The value behind a key of the header's dictionary.
std::string_view value_of(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) return {};
  std::string_view rest = text.substr(at + key.size());
  while (!rest.empty() && (rest.front() == ':' || rest.front() == ' ')) rest.remove_prefix(1);
  return rest;
}

/// "'...'" at the front of `text`, which it is taken off; nothing: there is none.
std::optional<std::string_view> take_quoted(std::string_view& text) {
  const std::size_t begin = text.find('\'');
  if (begin == std::string_view::npos) return std::nullopt;
  const std::size_t end = text.find('\'', begin + 1);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view out = text.substr(begin + 1, end - begin - 1);
  text.remove_prefix(end + 1);
  return out;
}

std::optional<double> unit_of_time(std::string_view unit) {
  if (unit == "[ns]") return 1e-9;
  if (unit == "[us]") return 1e-6;
  if (unit == "[ms]") return 1e-3;
  if (unit == "[s]") return 1.0;
  return std::nullopt;
}

/// "<f8", "|i1", "<M8[ns]", ...
std::optional<NpyType> read_type(std::string_view text) {
  NpyType out;
  if (text.size() < 3) return std::nullopt;
  out.big_endian = text[0] == '>';
  const char kind = text[1];
  std::size_t bytes = 0;
  const auto number = std::from_chars(text.data() + 2, text.data() + text.size(), bytes);
  if (number.ec != std::errc{}) return std::nullopt;
  const std::string_view rest = text.substr(static_cast<std::size_t>(number.ptr - text.data()));
  out.bytes = bytes;
  const bool whole = bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8;
  if (kind == 'M' && bytes == 8) {
    const auto unit = unit_of_time(rest);
    out.kind = NpyType::Kind::kTime;
    out.unit_s = unit.value_or(0.0);
    return unit ? std::optional{out} : std::nullopt;
  }
  if (!rest.empty() || !whole) return std::nullopt;
  if (kind == 'f' && bytes >= 4) return out;
  out.kind = kind == 'i' ? NpyType::Kind::kSigned : NpyType::Kind::kUnsigned;
  if (kind == 'i' || kind == 'u' || (kind == 'b' && bytes == 1)) return out;
  return std::nullopt;
}

/// "[('time_s', '<f8'), ('force_n', '<f4')]", or one type in quotes.
bool read_fields(std::string_view text, NpyHeader& out) {
  if (text.starts_with('\'')) {
    const auto word = take_quoted(text);
    const auto type = word ? read_type(*word) : std::nullopt;
    if (!type) return false;
    out.fields.push_back({{}, 0, *type});
    out.item_bytes = type->bytes;
    return true;
  }
  const std::size_t end = text.find(']');
  if (!text.starts_with('[') || end == std::string_view::npos) return false;
  // A unit of time in brackets ends nothing: "<M8[ns]".
  std::size_t close = text.find(")]");
  close = std::min(close, text.find("),]"));
  if (close == std::string_view::npos) return false;
  text = text.substr(0, close);
  while (const auto name = take_quoted(text)) {
    const std::string own{*name};
    const auto word = take_quoted(text);
    const auto type = word ? read_type(*word) : std::nullopt;
    if (!type || out.fields.size() == kMostFields) return false;
    out.fields.push_back({own, out.item_bytes, *type});
    out.item_bytes += type->bytes;
  }
  return !out.fields.empty();
}

/// "(1000, 3), ..."
bool read_shape(std::string_view text, NpyHeader& out) {
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) return false;
  text = text.substr(1, end - 1);
  while (!text.empty()) {
    if (text.front() == ' ' || text.front() == ',') {
      text.remove_prefix(1);
      continue;
    }
    std::uint64_t size = 0;
    const auto number = std::from_chars(text.data(), text.data() + text.size(), size);
    if (number.ec != std::errc{} || out.shape.size() == 2) return false;
    out.shape.push_back(size);
    text.remove_prefix(static_cast<std::size_t>(number.ptr - text.data()));
  }
  return true;
}

template <class T>
double as_double(const char* at, bool swap) noexcept {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), at, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return static_cast<double>(little<T>(bytes.data()));
}

template <class One, class Two, class Four, class Eight>
double whole(const char* at, std::size_t bytes, bool swap) noexcept {
  if (bytes == 1) return as_double<One>(at, swap);
  if (bytes == 2) return as_double<Two>(at, swap);
  return bytes == 4 ? as_double<Four>(at, swap) : as_double<Eight>(at, swap);
}

}  // namespace

double NpyType::read(const char* at) const noexcept {
  switch (kind) {
    case Kind::kFloat:
      return bytes == 4 ? as_double<float>(at, big_endian) : as_double<double>(at, big_endian);
    case Kind::kUnsigned:
      return whole<std::uint8_t, std::uint16_t, std::uint32_t, std::uint64_t>(at, bytes,
                                                                              big_endian);
    case Kind::kSigned:
      return whole<std::int8_t, std::int16_t, std::int32_t, std::int64_t>(at, bytes, big_endian);
    case Kind::kTime:
      break;
  }
  const double count = as_double<std::int64_t>(at, big_endian);
  constexpr auto kNotATime = static_cast<double>(std::numeric_limits<std::int64_t>::min());
  return count == kNotATime ? std::numeric_limits<double>::quiet_NaN() : count * unit_s;
}

std::optional<NpyHeader> read_npy_header(std::string_view bytes, std::string& why) {
  why = "is cut off in its header";
  if (bytes.size() < 12) return std::nullopt;
  if (!bytes.starts_with(kMark) || bytes[6] < 1 || bytes[6] > 3) {
    why = "is no NumPy array of version 1, 2 or 3";
    return std::nullopt;
  }
  const bool first = bytes[6] == 1;
  const std::size_t begin = first ? 10 : 12;
  const std::size_t length =
      first ? little<std::uint16_t>(bytes.data() + 8) : little<std::uint32_t>(bytes.data() + 8);
  if (length > kLongestNpyHeader || begin + length > bytes.size()) return std::nullopt;
  const std::string_view text = bytes.substr(begin, length);
  NpyHeader out;
  out.header_bytes = begin + length;
  out.by_column = value_of(text, "'fortran_order'").starts_with("True");
  why = "holds no numbers (real ones of 4 or 8 bytes, whole ones, times)";
  if (!read_fields(value_of(text, "'descr'"), out)) return std::nullopt;
  why = "has more than two dimensions";
  if (!read_shape(value_of(text, "'shape'"), out)) return std::nullopt;
  return out;
}

}  // namespace dampline::drivers
