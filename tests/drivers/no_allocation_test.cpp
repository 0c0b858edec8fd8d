// SPDX-License-Identifier: MIT
// Reading must not allocate: every operator new of this program is counted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>

#include "drivers/candump/candump_source.hpp"
#include "drivers/csv/csv_reader.hpp"
#include "temporary_file.hpp"

namespace {
std::atomic<std::uint64_t> allocations{0};
}  // namespace

void* operator new(std::size_t size, const std::nothrow_t& /*unused*/) noexcept {
  ++allocations;
  return std::malloc(size);
}
void* operator new(std::size_t size) {
  void* memory = operator new(size, std::nothrow);
  if (memory == nullptr) throw std::bad_alloc{};
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

namespace dampline::drivers {
namespace {

TEST(NoAllocation, TheCounterFires) {
  const std::uint64_t before = allocations;
  const auto number = std::make_unique<std::array<int, 100>>();
  EXPECT_NE(number.get(), nullptr);
  EXPECT_GT(allocations, before);
}

TEST(NoAllocation, ReadingACandumpLog) {
  std::string text = "# comment\n";
  for (int i = 0; i < 20000; ++i) {
    text += fmt::format("(1600000000.{:06}) can{} 123#1122334455667788\n", i * 10 - i % 7, i % 5);
    if (i % 100 == 50) text += "(not a line\n";
  }
  const testing::TemporaryFile file{text};
  auto source = CandumpSource::open({.path = file.path(), .skip_bad_lines = true});
  std::array<CanFrame, 64> frames;
  std::size_t count = 0;
  const std::uint64_t before = allocations;
  for (auto read = source.value()->read(frames); read.ok(); read = source.value()->read(frames))
    count += read.value();
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(count, 20000U);
}

TEST(NoAllocation, ReadingATable) {
  std::string text = "time_s,note,force_n\n";
  for (int i = 0; i < 20000; ++i) text += fmt::format("{},7,{}\n", i, 0.1 * i);
  const testing::TemporaryFile file{text};
  auto reader = CsvReader::open({.path = file.path(), .required = {"time_s", "force_n"}});
  std::array<double, 128> rows{};
  std::size_t count = 0;
  const std::uint64_t before = allocations;
  for (auto read = reader.value()->read(rows); read.ok(); read = reader.value()->read(rows))
    count += read.value();
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(count, 20000U);
}

}  // namespace
}  // namespace dampline::drivers
