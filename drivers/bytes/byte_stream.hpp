// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dampline/result.hpp"
#include "drivers/compressed/decompressor.hpp"
#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// The bytes of a file, a pipe or standard input from their beginning; gzip and zstd, known by
/// their first bytes, are decompressed. Never waits: a pipe that has nothing yet gives kNothingYet.
///
/// A pipe can be opened again as long as no stream of it has gone beyond kKept bytes: what came
/// first is kept until then, so that a program may look what it is given before it reads it.
class ByteStream {
 public:
  static constexpr std::size_t kKept = std::size_t{8} * 1024 * 1024;

  enum class Status : std::uint8_t {
    kBytes,
    kNothingYet,  ///< a pipe is open but empty
    kEnd,
    kError,  ///< error() and error_text() say why
  };
  struct Read {
    Status status{Status::kEnd};
    std::size_t count{0};  ///< at least 1 with kBytes, else 0
  };

  /// What a pipe, or standard input, gave from its first byte to its last.
  struct Passed {
    std::uint64_t bytes{0};
    std::string sha256;  ///< 64 hexadecimal digits
  };
  /// Nothing: it is none, or was not read to its end.
  [[nodiscard]] static std::optional<Passed> passed_through(const std::string& path);

  /// path "-" is standard input. Errors: no such file, a directory, a pipe that was read already.
  static Outcome<ByteStream> open(const std::string& path);
  ByteStream(ByteStream&& other) noexcept;
  ByteStream& operator=(ByteStream&&) = delete;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  ~ByteStream();

  /// Precondition: out has room for 4 bytes.
  Read read(std::span<char> out) noexcept;
  /// True when read() will give something, or the end.
  bool wait(std::chrono::nanoseconds timeout) noexcept;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] Errc error() const noexcept { return error_; }
  /// With the stream's name.
  [[nodiscard]] std::string error_text() const;
  /// At the end: compressed data stopped in the middle.
  [[nodiscard]] bool is_cut_off() const noexcept { return cut_off_; }
  /// Of the file as it lies there, 0...1; none of a pipe.
  [[nodiscard]] std::optional<double> share_read() const noexcept;

 private:
  struct Pipe;
  ByteStream(std::string name, int descriptor);
  Read read_raw(std::span<char> out) noexcept;
  Read read_first(std::span<char> out) noexcept;
  Read read_compressed(std::span<char> out) noexcept;
  Read fail(Errc error, const char* text) noexcept;
  [[nodiscard]] bool start_decompressor(Compression compression) noexcept;
  [[nodiscard]] bool readable(int timeout_ms) const noexcept;
  [[nodiscard]] static std::shared_ptr<Pipe> pipe_of(int descriptor);
  [[nodiscard]] static std::vector<std::shared_ptr<Pipe>>& pipes();

  enum class Mode : std::uint8_t { kUnknown, kPlain, kCompressed };
  std::string name_;
  int descriptor_;
  bool may_block_{false};
  std::shared_ptr<Pipe> pipe_;  // null: not a pipe
  std::size_t pipe_at_{0};      // of the bytes that are kept
  std::uint64_t size_{0};       // of the file; 0: not known
  std::uint64_t raw_at_{0};
  Mode mode_{Mode::kUnknown};
  std::array<char, 4> first_{};
  std::size_t first_count_{0};
  std::unique_ptr<Decompressor> decompressor_;
  std::vector<char> raw_;  // compressed bytes that were read
  std::size_t raw_begin_{0};
  std::size_t raw_end_{0};
  bool raw_ended_{false};
  bool cut_off_{false};
  Errc error_{Errc::kIo};
  const char* fault_{nullptr};  // of the compressed data
  int error_number_{0};
};

}  // namespace dampline::drivers
