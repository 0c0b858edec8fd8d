// SPDX-License-Identifier: MIT
// Reading must not allocate: every operator new of this program is counted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>

#include "drivers/candump/source.hpp"
#include "drivers/csv/reader.hpp"
#include "temporary_file.hpp"
#include "tests/blackbox.hpp"

namespace {
std::atomic<std::uint64_t> allocations{0};
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*unused*/) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  void* memory = operator new(size, std::nothrow);
  if (memory == nullptr) throw std::bad_alloc{};
  return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace dampline::drivers {
namespace {

TEST(NoAllocation, TheCounterFires) {
  const std::uint64_t before = allocations;
  ::operator delete(::operator new(8));  // an expression with new may be optimised away, a call not
  const std::uint64_t after = allocations;
  EXPECT_EQ(after, before + 1);
}

/// How many frames there were.
std::size_t read_without_allocation(hal::FrameSource& source) {
  std::array<CanFrame, 64> frames;
  std::size_t count = 0;
  const std::uint64_t before = allocations;
  for (auto read = source.read(frames); read.ok(); read = source.read(frames))
    count += read.value();
  EXPECT_EQ(allocations - before, 0U);
  return count;
}

TEST(NoAllocation, ReadingACandumpLog) {
  std::string text = "# a comment that is too long for a string's own room\n";
  for (int i = 0; i < 20000; ++i) {
    text += fmt::format("(1600000000.{:06}) can{} 123#1122334455667788\n", i * 10 - i % 7, i % 5);
    if (i % 100 == 50) text += "(not a line\n";
  }
  const test::TemporaryFile file{text};
  auto source = CandumpSource::open({.path = file.path(), .skip_bad_lines = true});
  EXPECT_EQ(read_without_allocation(*source.value()), 20000U);
}

TEST(NoAllocation, ReadingATable) {
  std::string text = "time_s,note,force_n\n";
  for (int i = 0; i < 20000; ++i) text += fmt::format("{},7,{}\n", i, 0.1 * i);
  const test::TemporaryFile file{text};
  auto reader = CsvReader::open({.path = file.path(), .required = {"time_s", "force_n"}});
  std::array<double, 128> rows{};
  std::size_t count = 0;
  const std::uint64_t before = allocations;
  for (auto read = reader.value()->read(rows); read.ok(); read = reader.value()->read(rows))
    count += read.value();
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(count, 20000U);
}

TEST(NoAllocation, WritingToABlackBoxWithinAFile) {
  const test::BoxFolder folder;
  const auto writer = test::open_box(test::box_config(folder.path()));
  writer->write(test::numbered_frame(0));
  const std::uint64_t before = allocations;
  for (std::uint64_t i = 1; i < 100'000; ++i) {
    writer->write(test::numbered_frame(i));
    if (i % 1000 == 0) writer->write(hal::Event{});
    if (i % 100 == 0) writer->tick(static_cast<std::int64_t>(i) * 10'000'000);
  }
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(writer->health().files, 1U);
}

TEST(NoAllocation, ReadingABlackBoxFromFileToFile) {
  const test::BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.rotate_bytes = 100'000;
  test::write_box(config, 0, 20'000);
  std::string bytes = test::bytes_of(folder.file(1));
  bytes[5000] = static_cast<char>(~bytes[5000]);
  test::write_bytes(folder.file(1), bytes);
  auto source = BlackboxSource::open({folder.path(), {}});
  EXPECT_EQ(read_without_allocation(*source.value()), 19'999U);
  EXPECT_GT(source.value()->findings().files, 5U);
}

}  // namespace
}  // namespace dampline::drivers
