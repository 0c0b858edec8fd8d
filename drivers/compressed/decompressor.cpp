// SPDX-License-Identifier: MIT
#include "drivers/compressed/decompressor.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>

namespace dampline::drivers {
namespace {

constexpr std::string_view kGzipMark = "\x1F\x8B\x08";
constexpr std::string_view kZstdMark = "\x28\xB5\x2F\xFD";

/// Of zlib's inflate: what stands around the deflated data.
constexpr int kGzipFormat = 15 + 16;
constexpr int kZlibFormat = 15;
constexpr int kNoFormat = -15;

template <int kFormat>
class Inflate final : public Decompressor {
 public:
  /// False: there is no memory.
  [[nodiscard]] bool start() noexcept {
    started_ = ::inflateInit2(&state_, kFormat) == Z_OK;
    return started_;
  }
  ~Inflate() override {
    if (started_) ::inflateEnd(&state_);
  }

  [[nodiscard]] Step push(std::span<const char> in, std::span<char> out) noexcept override {
    std::size_t padding = 0;
    if (kFormat == kGzipFormat && whole_ &&
        any_) {  // behind a member: another one, or zeros as tapes have them
      while (padding < in.size() && in[padding] == '\0') ++padding;
      if (padding == in.size()) return {padding, 0, nullptr};
      if (in[padding] != kGzipMark[0])
        return {padding, 0, "other bytes behind the compressed data"};
      ::inflateReset(&state_);
    }
    any_ = true;
    whole_ = false;
    constexpr std::size_t kMost = std::numeric_limits<uInt>::max();
    const auto input = static_cast<uInt>(std::min(in.size() - padding, kMost));
    const auto room = static_cast<uInt>(std::min(out.size(), kMost));
    state_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data() + padding));
    state_.avail_in = input;
    state_.next_out = reinterpret_cast<Bytef*>(out.data());
    state_.avail_out = room;
    const int code = ::inflate(&state_, Z_NO_FLUSH);
    whole_ = code == Z_STREAM_END;
    const bool good = whole_ || code == Z_OK || code == Z_BUF_ERROR;
    return {padding + input - state_.avail_in, room - state_.avail_out,
            good                    ? nullptr
            : state_.msg != nullptr ? state_.msg
                                    : "damaged data"};
  }
  [[nodiscard]] bool is_whole() const noexcept override { return whole_; }
  void restart() noexcept override {
    ::inflateReset(&state_);
    any_ = false;
    whole_ = kFormat == kGzipFormat;
  }

 private:
  z_stream state_{};
  bool started_{false};
  bool whole_{kFormat == kGzipFormat};  // no member at all is whole
  bool any_{false};
};

class Zstd final : public Decompressor {
 public:
  Zstd() : state_{::ZSTD_createDStream()} {}
  [[nodiscard]] bool start() noexcept {
    return state_ != nullptr && ::ZSTD_isError(::ZSTD_initDStream(state_)) == 0U;
  }
  ~Zstd() override { ::ZSTD_freeDStream(state_); }

  [[nodiscard]] Step push(std::span<const char> in, std::span<char> out) noexcept override {
    if (whole_ && in.empty()) return {};  // else it would begin to wait for a frame
    ZSTD_inBuffer input{in.data(), in.size(), 0};
    ZSTD_outBuffer output{out.data(), out.size(), 0};
    const std::size_t hint = ::ZSTD_decompressStream(state_, &output, &input);
    if (::ZSTD_isError(hint) != 0U) return {input.pos, output.pos, ::ZSTD_getErrorName(hint)};
    whole_ = hint == 0;
    return {input.pos, output.pos, nullptr};
  }
  [[nodiscard]] bool is_whole() const noexcept override { return whole_; }
  void restart() noexcept override {
    static_cast<void>(::ZSTD_initDStream(state_));
    whole_ = true;
  }

 private:
  ZSTD_DStream* state_;
  bool whole_{true};
};

template <class Kind>
std::unique_ptr<Decompressor> make() {
  auto out = std::make_unique<Kind>();
  if (!out->start()) return nullptr;
  return out;
}

}  // namespace

Compression compression_of(std::string_view head) noexcept {
  if (head.starts_with(kGzipMark)) return Compression::kGzip;
  return head.starts_with(kZstdMark) ? Compression::kZstd : Compression::kNone;
}

bool may_become_compressed(std::string_view head) noexcept {
  return kGzipMark.starts_with(head) || kZstdMark.starts_with(head);
}

std::unique_ptr<Decompressor> make_gzip() { return make<Inflate<kGzipFormat>>(); }
std::unique_ptr<Decompressor> make_zlib() { return make<Inflate<kZlibFormat>>(); }
std::unique_ptr<Decompressor> make_deflate() { return make<Inflate<kNoFormat>>(); }
std::unique_ptr<Decompressor> make_zstd() { return make<Zstd>(); }

}  // namespace dampline::drivers
