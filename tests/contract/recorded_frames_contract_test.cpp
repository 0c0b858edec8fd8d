// SPDX-License-Identifier: MIT
// The contract of hal::FrameSource over the formats of recordings. What other programs wrote is
// read in tests/app/frame_formats_test.cpp.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "drivers/record/frames.hpp"
#include "tests/contract/frame_source_contract.hpp"

namespace dampline {
namespace {

/// A file that a Format writes, opened by its content.
template <class Format>
class Recording {
 public:
  Recording()
      : path_{std::filesystem::temp_directory_path() /
              fmt::format("dampline_contract_{}.record", ::getpid())} {
    Format::write(path_.string());
    auto opened = drivers::open_frames({.path = path_.string()});
    EXPECT_TRUE(opened.ok()) << opened.error_text();
    source_ = std::move(opened.value());
  }
  ~Recording() { std::filesystem::remove(path_); }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  hal::FrameSource& source() { return *source_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<drivers::RecordedFrames> source_;
};

struct Screen {
  static void write(const std::string& path) {
    std::ofstream out{path};
    for (std::size_t i = 0; i < kContractFrames; ++i)
      out << fmt::format(" (000.{:06})  can0  {:03X}   [1]  {:02X}\n", i * 1111, 0x100 + i % 3,
                         i % 256);
  }
};

struct Asc {
  static void write(const std::string& path) {
    std::ofstream out{path};
    out << "date Tue Nov 14 22:13:20 2023\nbase hex  timestamps absolute\n";
    for (std::size_t i = 0; i < kContractFrames; ++i)
      out << fmt::format("   {:.6f} 1  {:X}       Rx   d 1 {:02X}\n", 1e-3 * static_cast<double>(i),
                         0x100 + i % 3, i % 256);
  }
};

struct Trc {
  static void write(const std::string& path) {
    std::ofstream out{path};
    out << ";$FILEVERSION=1.1\n";
    for (std::size_t i = 0; i < kContractFrames; ++i)
      out << fmt::format(" {}) {}.5 Rx {:04X} 1 {:02X}\n", i + 1, i, 0x100 + i % 3, i % 256);
  }
};

struct Blf {
  template <class T>
  static void put(std::ofstream& out, T number) {
    out.write(reinterpret_cast<const char*>(&number), sizeof number);
  }
  /// CAN_MESSAGE objects without a container.
  static void write(const std::string& path) {
    std::ofstream out{path, std::ios::binary};
    out << "LOGG";
    put(out, std::uint32_t{144});
    out << std::string(136, '\0');
    for (std::size_t i = 0; i < kContractFrames; ++i) {
      out << "LOBJ";
      put(out, std::uint32_t{32 | 1U << 16U});
      put(out, std::uint32_t{48});
      put(out, std::uint32_t{1});
      put(out, std::uint32_t{2});
      put(out, std::uint32_t{0});
      put(out, std::uint64_t{i * 1'000'000});
      put(out, std::uint32_t{1 | 1U << 24U});
      put(out, static_cast<std::uint32_t>(0x100 + i % 3));
      put(out, std::uint64_t{i});
    }
  }
};

/// By tests/mdf4.py.
struct Mdf {
  static void write_by(const std::string& path, const char* options) {
    const std::string command = fmt::format(
        "/usr/bin/python3 -c \"import sys; sys.path.insert(0, '{}/tests'); import mdf4; "
        "mdf4.write_frames('{}', [(1000000 * i, 1 + i % 2, 256 + i % 3, False, bytes([i % 256]), "
        "'data') for i in range({})], 1600000000000000000, {})\"",
        DAMPLINE_SOURCE_DIR, path, kContractFrames, options);
    ASSERT_EQ(std::system(command.c_str()), 0);  // NOLINT(cert-env33-c) the writer is a program
  }
};
struct SortedMdf {
  static void write(const std::string& path) {
    Mdf::write_by(path, "sort=True, deflate='transposed', pieces=3");
  }
};
struct UnsortedMdf {
  static void write(const std::string& path) {
    Mdf::write_by(path, "variable='records', lacks=0x25");
  }
};

using Recordings = ::testing::Types<Recording<Screen>, Recording<Asc>, Recording<Trc>,
                                    Recording<Blf>, Recording<SortedMdf>, Recording<UnsortedMdf>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Format, FrameSourceContract, Recordings);

}  // namespace
}  // namespace dampline
