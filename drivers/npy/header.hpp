// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::drivers {

/// A number as NumPy stores it.
struct NpyType {
  enum class Kind : std::uint8_t { kSigned, kUnsigned, kFloat, kTime };
  Kind kind{Kind::kFloat};
  std::size_t bytes{8};  ///< 1, 2, 4 or 8
  bool big_endian{false};
  double unit_s{0.0};  ///< of kTime, counts since 1970
  /// NaN for NaT. Precondition: `bytes` bytes.
  [[nodiscard]] double read(const char* at) const noexcept;
};

/// A field of a structured array, or the only one of a plain array, without a name.
struct NpyField {
  std::string name;
  std::size_t offset{0};
  NpyType type;
};

/// What an array's header says (NumPy Enhancement Proposal 1, versions 1 to 3).
struct NpyHeader {
  std::vector<NpyField> fields;
  std::size_t item_bytes{0};
  bool by_column{false};             ///< Fortran's order
  std::vector<std::uint64_t> shape;  ///< at most two
  std::size_t header_bytes{0};       ///< before the data
};

inline constexpr std::size_t kLongestNpyHeader = 65536;
/// `bytes` is an array's beginning. Nothing: it is no array, or one of other things than numbers;
/// `why` says what.
[[nodiscard]] std::optional<NpyHeader> read_npy_header(std::string_view bytes, std::string& why);

}  // namespace dampline::drivers
