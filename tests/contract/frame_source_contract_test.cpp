// SPDX-License-Identifier: MIT
// The contract of hal::FrameSource, over every implementation that has an end. SocketCanSource has
// none: tests/fault/socketcan_contract_test.cpp.
#include "tests/contract/frame_source_contract.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "drivers/candump/source.hpp"
#include "hal/frame_source.hpp"
#include "sim_hw/simulated_source.hpp"
#include "tests/blackbox.hpp"

namespace dampline {
namespace {

constexpr std::size_t kFrames = kContractFrames;

std::string candump_text() {
  std::string text;
  for (std::size_t i = 0; i < kFrames; ++i) {
    text += fmt::format("(1600000000.{:06}) can0 {:03X}#{:04X}\n", i * 1111, 0x100 + i % 3, i);
  }
  return text;
}

/// A source in memory: the least that fulfils the contract.
class FakeSource final : public hal::FrameSource {
 public:
  explicit FakeSource(std::size_t frames) : frames_{frames} {}

 private:
  Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override {
    if (next_ == frames_ && !out.empty()) return Errc::kEndOfStream;
    std::size_t count = 0;
    for (; count < out.size() && next_ < frames_; ++count, ++next_) {
      out[count] = CanFrame{};
      out[count].time_ns = static_cast<std::int64_t>(next_) * 1000;
    }
    return count;
  }
  Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override { return true; }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override {
    hal::SourceHealth health;
    health.frames = next_;
    return health;
  }
  std::size_t frames_;
  std::size_t next_{0};
};

class Fake {
 public:
  hal::FrameSource& source() { return source_; }

 private:
  FakeSource source_{kFrames};
};

class CandumpFile {
 public:
  CandumpFile()
      : path_{std::filesystem::temp_directory_path() /
              fmt::format("dampline_contract_{}.log", ::getpid())} {
    std::ofstream{path_} << candump_text();
    source_ = std::move(drivers::CandumpSource::open({.path = path_.string()}).value());
  }
  ~CandumpFile() { std::filesystem::remove(path_); }
  CandumpFile(const CandumpFile&) = delete;
  CandumpFile& operator=(const CandumpFile&) = delete;
  hal::FrameSource& source() { return *source_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<drivers::CandumpSource> source_;
};

/// A pipe in place of standard input while the source is opened.
class Pipe {
 public:
  Pipe() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    writer_ = ends[1];
    const int kept = ::dup(STDIN_FILENO);
    ::dup2(ends[0], STDIN_FILENO);
    ::close(ends[0]);
    source_ = std::move(drivers::CandumpSource::open({.path = "-"}).value());
    if (kept >= 0) ::dup2(kept, STDIN_FILENO);
    if (kept >= 0) ::close(kept);
  }
  ~Pipe() { close(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void write(std::string_view text) const {
    EXPECT_EQ(::write(writer_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void close() {
    if (writer_ >= 0) ::close(writer_);
    writer_ = -1;
  }
  hal::FrameSource& source() { return *source_; }

 private:
  int writer_{-1};
  std::unique_ptr<drivers::CandumpSource> source_;
};

class CandumpPipe {
 public:
  CandumpPipe() {
    pipe_.write(candump_text());
    pipe_.close();
  }
  hal::FrameSource& source() { return pipe_.source(); }

 private:
  Pipe pipe_;
};

class Simulated {
 public:
  hal::FrameSource& source() { return *source_; }

 private:
  std::unique_ptr<sim::SimulatedSource> source_ =
      std::make_unique<sim::SimulatedSource>(sim::SimulationConfig{}, kFrames / kChannels);
};

/// Frames of one message overtake each other on the way.
class SimulatedSwapping {
 public:
  hal::FrameSource& source() { return *source_; }

 private:
  std::unique_ptr<sim::SimulatedSource> source_ = std::make_unique<sim::SimulatedSource>(
      sim::SimulationConfig{}, kFrames / kChannels, sim::NodeConfig{},
      sim::TransportConfig{.swap_time_s = 0.1});
};

/// With events among the frames, in several files.
class BlackboxFolder {
 public:
  BlackboxFolder() {
    auto config = test::box_config(folder_.path());
    config.rotate_bytes = 4096;
    const auto writer = test::open_box(config);
    for (std::size_t i = 0; i < kFrames; ++i) {
      writer->write(test::numbered_frame(i));
      if (i % 40 == 0) writer->write(hal::Event{test::kStartNs, hal::EventKind::kPulse, 0, 0});
    }
    writer->close();
    source_ = std::move(drivers::BlackboxSource::open({folder_.path(), {}}).value());
  }
  hal::FrameSource& source() { return *source_; }

 private:
  test::BoxFolder folder_;
  std::unique_ptr<drivers::BlackboxSource> source_;
};

/// One record more, and one of them hit.
class DamagedBlackbox {
 public:
  DamagedBlackbox() {
    test::write_box(test::box_config(folder_.path()), 0, kFrames + 1);
    std::string bytes = test::bytes_of(folder_.file(1));
    bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
    test::write_bytes(folder_.file(1), bytes);
    source_ = std::move(drivers::BlackboxSource::open({folder_.path(), {}}).value());
  }
  hal::FrameSource& source() { return *source_; }

 private:
  test::BoxFolder folder_;
  std::unique_ptr<drivers::BlackboxSource> source_;
};

using Implementations = ::testing::Types<Fake, CandumpFile, CandumpPipe, Simulated,
                                         SimulatedSwapping, BlackboxFolder, DamagedBlackbox>;
INSTANTIATE_TYPED_TEST_SUITE_P(Record, FrameSourceContract, Implementations);

TEST(CandumpPipeSource, DoesNotBlockOnAPipeThatHasNothingYet) {
  Pipe pipe;
  std::array<CanFrame, 4> frames;
  EXPECT_EQ(pipe.source().read(frames).value(), 0U);
  EXPECT_FALSE(pipe.source().wait(std::chrono::milliseconds{1}).value());
  pipe.write("(1.000000) can0 123#11\n(1.000001) can0 12");
  EXPECT_TRUE(pipe.source().wait(std::chrono::seconds{10}).value());
  EXPECT_EQ(pipe.source().read(frames).value(), 1U);
  EXPECT_EQ(pipe.source().read(frames).value(), 0U);
  pipe.write("3#22\n");
  EXPECT_EQ(pipe.source().read(frames).value(), 1U);
  EXPECT_EQ(frames[0].data[0], 0x22);
  pipe.close();
  EXPECT_EQ(pipe.source().read(frames).error(), Errc::kEndOfStream);
}

TEST(CandumpPipeSource, SaysThatStandardInputWasEmpty) {
  Pipe pipe;
  pipe.close();
  std::array<CanFrame, 4> frames;
  EXPECT_EQ(pipe.source().read(frames).error(), Errc::kMalformed);
  const auto& source = dynamic_cast<const drivers::CandumpSource&>(pipe.source());
  EXPECT_NE(source.error_text().find("standard input: is empty"), std::string::npos);
}

}  // namespace
}  // namespace dampline
