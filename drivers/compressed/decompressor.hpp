// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace dampline::drivers {

enum class Compression : std::uint8_t { kNone, kGzip, kZstd };

/// More than deflate makes of one byte, which is 1032 at most (RFC 1951).
inline constexpr std::uint64_t kMostDeflation = 1100;

/// What the first bytes of a file say (RFC 1952; RFC 8878). Four bytes are enough.
[[nodiscard]] Compression compression_of(std::string_view head) noexcept;
/// Whether more bytes could still make it one: `head` is a beginning of their marks.
[[nodiscard]] bool may_become_compressed(std::string_view head) noexcept;

/// Compressed bytes in, bytes out, piece by piece. Its memory does not depend on the data: zlib's
/// 32 KiB window, and at most 128 MiB of zstd's (what `zstd -22 --ultra` asks for).
class Decompressor {
 public:
  struct Step {
    std::size_t taken{0};
    std::size_t given{0};
    const char* fault{nullptr};  ///< what is wrong with the data; null: nothing
  };
  Decompressor() = default;
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;
  virtual ~Decompressor() = default;
  [[nodiscard]] virtual Step push(std::span<const char> in, std::span<char> out) noexcept = 0;
  /// Between two members or frames: the data may end here.
  [[nodiscard]] virtual bool is_whole() const noexcept = 0;
  /// Forgets what came before.
  virtual void restart() noexcept = 0;
};

/// Null: there is no memory for it. Only of gzip and zstd may members follow one another.
[[nodiscard]] std::unique_ptr<Decompressor> make_zlib();     ///< RFC 1950
[[nodiscard]] std::unique_ptr<Decompressor> make_deflate();  ///< RFC 1951, as in zip files
[[nodiscard]] std::unique_ptr<Decompressor> make_gzip();
[[nodiscard]] std::unique_ptr<Decompressor> make_zstd();

}  // namespace dampline::drivers
