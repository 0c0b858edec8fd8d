// SPDX-License-Identifier: MIT
// Compressed by zlib and zstd themselves, in every form that files have.
#include "drivers/compressed/decompressor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <array>
#include <string>

namespace dampline::drivers {
namespace {

using testing::HasSubstr;
using testing::IsNull;

/// By zlib's window: 31 as gzip, 15 as zlib, -15 deflate alone.
std::string deflated(const std::string& text, int window) {
  z_stream state{};
  EXPECT_EQ(::deflateInit2(&state, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(::deflateBound(&state, text.size()), '\0');
  state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  state.avail_in = static_cast<uInt>(text.size());
  state.next_out = reinterpret_cast<Bytef*>(out.data());
  state.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(::deflate(&state, Z_FINISH), Z_STREAM_END);
  out.resize(state.total_out);
  ::deflateEnd(&state);
  return out;
}

std::string packed_by_zstd(const std::string& text) {
  std::string out(::ZSTD_compressBound(text.size()), '\0');
  out.resize(::ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 3));
  return out;
}

struct Unpacked {
  std::string text;
  const char* fault{nullptr};
};

/// `step` bytes at a time, into small room.
Unpacked unpack(Decompressor& decompressor, std::string_view packed, std::size_t step) {
  Unpacked out;
  std::array<char, 100> room{};
  while (!packed.empty()) {
    std::string_view part = packed.substr(0, step);
    packed.remove_prefix(part.size());
    for (std::size_t given = room.size(); !part.empty() || given == room.size();) {
      const auto done = decompressor.push(part, room);
      part.remove_prefix(done.taken);
      given = done.given;
      out.text.append(room.data(), given);
      out.fault = done.fault;
      if (out.fault != nullptr) return out;
    }
  }
  return out;
}

std::string sample_text() {
  std::string text;
  for (int i = 0; i < 300; ++i) text += std::to_string(i * i) + "\n";
  return text;
}

struct Form {
  const char* name;
  std::unique_ptr<Decompressor> (*make)();
  std::string packed;
  bool has_members;
};
std::vector<Form> forms() {
  const std::string text = sample_text();
  return {{"gzip", make_gzip, deflated(text, 31), true},
          {"zlib", make_zlib, deflated(text, 15), false},
          {"deflate", make_deflate, deflated(text, -15), false},
          {"zstd", make_zstd, packed_by_zstd(text), true}};
}

TEST(Decompressor, GivesTheTextWhateverThePieces) {
  for (const Form& form : forms()) {
    for (const std::size_t step : {1U, 2U, 3U, 17U, 100'000U}) {
      const auto decompressor = form.make();
      const Unpacked out = unpack(*decompressor, form.packed, step);
      EXPECT_THAT(out.fault, IsNull()) << form.name << " " << step;
      EXPECT_EQ(out.text, sample_text()) << form.name << " " << step;
      EXPECT_TRUE(decompressor->is_whole()) << form.name << " " << step;
    }
  }
}

TEST(Decompressor, IsWholeBetweenMembersOnly) {
  for (const Form& form : forms()) {
    const auto decompressor = form.make();
    EXPECT_EQ(decompressor->is_whole(), form.has_members) << form.name << ": a file of no bytes";
    for (int again = 0; again < 2; ++again) {
      static_cast<void>(unpack(*decompressor, form.packed.substr(0, form.packed.size() / 2), 50));
      EXPECT_FALSE(decompressor->is_whole()) << form.name;
      decompressor->restart();
      EXPECT_EQ(decompressor->is_whole(), form.has_members) << form.name;
      EXPECT_EQ(unpack(*decompressor, form.packed, 50).text, sample_text()) << form.name;
      EXPECT_TRUE(decompressor->is_whole()) << form.name;
      decompressor->restart();
    }
  }
}

TEST(Decompressor, TakesMembersBehindOneAnother) {
  for (const Form& form : forms()) {
    if (!form.has_members) continue;
    const auto decompressor = form.make();
    EXPECT_EQ(unpack(*decompressor, form.packed + form.packed, 100'000).text,
              sample_text() + sample_text());
    std::array<char, 10> room{};
    const auto nothing = decompressor->push({}, room);
    EXPECT_EQ(nothing.given, 0U) << form.name;
    EXPECT_THAT(nothing.fault, IsNull()) << form.name;
    EXPECT_TRUE(decompressor->is_whole()) << form.name;
  }
}

// Tapes fill their last block with zeros.
TEST(Decompressor, PassesOverZerosBehindAMember) {
  const std::string packed = deflated(sample_text(), 31);
  const std::string zeros(512, '\0');
  for (const std::size_t step : {1U, 100U, 100'000U}) {
    const auto decompressor = make_gzip();
    const Unpacked out = unpack(*decompressor, packed + zeros + packed + zeros, step);
    EXPECT_THAT(out.fault, IsNull()) << step;
    EXPECT_EQ(out.text, sample_text() + sample_text()) << step;
    EXPECT_TRUE(decompressor->is_whole()) << step;
    EXPECT_THAT(unpack(*decompressor, "more", step).fault, HasSubstr("other bytes behind"));
  }
}

TEST(Decompressor, TakesNoOtherForm) {
  for (const Form& form : forms()) {
    for (const Form& other : forms()) {
      if (form.name == other.name) continue;
      EXPECT_TRUE(unpack(*form.make(), other.packed, 1000).fault != nullptr)
          << other.name << " as " << form.name;
    }
  }
}

TEST(Decompressor, SaysWhatIsWrongWithDamagedData) {
  const std::string no_such_block = "\x07";
  EXPECT_THAT(unpack(*make_deflate(), no_such_block, 1).fault, HasSubstr("invalid block type"));
}

TEST(Decompressor, KnowsItsDataByTheFirstBytes) {
  const std::string gzip = deflated("x", 31);
  const std::string zstd = packed_by_zstd("x");
  EXPECT_EQ(compression_of(gzip), Compression::kGzip);
  EXPECT_EQ(compression_of(zstd), Compression::kZstd);
  EXPECT_EQ(compression_of("(1600000000.000000) can0"), Compression::kNone);
  for (const std::string& packed : {gzip, zstd}) {
    for (std::size_t length = 0; length < 3; ++length) {
      EXPECT_TRUE(may_become_compressed(packed.substr(0, length))) << length;
      EXPECT_EQ(compression_of(packed.substr(0, length)), Compression::kNone) << length;
    }
  }
  EXPECT_FALSE(may_become_compressed("x"));
  EXPECT_FALSE(may_become_compressed("\x1F("));
}

}  // namespace
}  // namespace dampline::drivers
