// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>

#include "app/error.hpp"
#include "app/run/state.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/damping/summary.hpp"
#include "drivers/checksum/crc32c.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

void fill_factors(ScaleFactors& factors, double seed) {
  for (auto& factor : factors.factor)
    for (double& x : factor.packed()) x = (seed += 0.37);
  factors.rows.fill(seed);
  factors.blocks = static_cast<std::uint32_t>(seed);
}

std::unique_ptr<Statistics> some_statistics() {
  auto s = std::make_unique<Statistics>();
  s->header.basis_hash = 0x0123456789abcdefULL;
  s->header.sample_rate_hz = 300.0;
  s->header.curve_nodes_mps.fill(0.25);
  s->header.entry_count = 3;
  s->header.newest_tick = -5;
  s->header.velocity.positive[7] = 77;
  s->header.counts.rows_still = 12;
  fill_factors(s->total, 1.0);
  for (std::size_t i = 0; i < 3; ++i)
    fill_factors(s->entries[i], 100.0 * static_cast<double>(i + 1));
  return s;
}

std::string error_of(std::string_view bytes) {
  const auto out = std::make_unique<Statistics>();
  try {
    decode_state(bytes, "half.dls", *out);
  } catch (const RunError& error) {
    return error.what();
  }
  return "no error";
}

TEST(StateFile, ReadsBackEveryField) {
  const auto written = some_statistics();
  const auto read = std::make_unique<Statistics>();
  decode_state(encode_state(*written), "whole.dls", *read);
  EXPECT_EQ(read->header.basis_hash, written->header.basis_hash);
  EXPECT_EQ(read->header.newest_tick, -5);
  EXPECT_EQ(read->header.entry_count, 3U);
  EXPECT_EQ(read->header.velocity.positive[7], 77U);
  EXPECT_EQ(read->header.counts.rows_still, 12U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read->entries[i].factor[kScales - 1].packed(),
              written->entries[i].factor[kScales - 1].packed());
    EXPECT_EQ(read->entries[i].rows, written->entries[i].rows);
    EXPECT_EQ(read->entries[i].blocks, written->entries[i].blocks);
  }
  EXPECT_EQ(encode_state(*read), encode_state(*written));
}

/// As version 2 wrote it: without alarms.
std::string of_version_2(std::string bytes) {
  constexpr std::size_t kLengthAt = 32;
  constexpr std::size_t kEmptyText = 4;
  constexpr std::size_t kChecksum = 4;
  const auto put = [&](std::size_t at, auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof(value));
  };
  bytes.erase(bytes.size() - kChecksum - kEmptyText, kEmptyText);
  bytes[8] = 2;
  put(kLengthAt, std::uint64_t{bytes.size() - kLengthAt - 8 - kChecksum});
  const std::size_t covered = bytes.size() - kChecksum;
  put(covered, drivers::crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), covered}));
  return bytes;
}

TEST(StateFile, KnowsTheAlarmsOfItsSegment) {
  const auto sums = some_statistics();
  StateAbout about;
  about.segment.vehicle = "4711";
  about.trust = Trust::kModelIncomplete;
  const std::string old = of_version_2(encode_state(*sums, about));
  EXPECT_EQ(decode_state(old, "old.dls", *sums).alarms, "");
  EXPECT_EQ(decode_state(old, "old.dls", *sums).trust, Trust::kModelIncomplete);
  about.alarms = "coulomb_below, drift";
  for (const StateKind kind : {StateKind::kFull, StateKind::kLight})
    EXPECT_EQ(decode_state(encode_state(*sums, about, kind), "new.dls", *sums).alarms,
              about.alarms);
}

TEST(StateFile, IsLittleEndian) {
  const std::string bytes = encode_state(*some_statistics());
  EXPECT_EQ(bytes.substr(0, 8), "DAMPLINE");
  EXPECT_EQ(bytes.substr(8, 4), std::string("\x03\x00\x00\x00", 4));
  EXPECT_EQ(bytes.substr(24, 8), "\xef\xcd\xab\x89\x67\x45\x23\x01");
}

/// Steps through every byte near the ends, where the frame lies, and through a sample of those
/// between.
std::size_t step(std::size_t at, std::size_t size) { return at < 200 || at + 200 > size ? 1 : 97; }

TEST(StateFile, RefusesEveryTruncation) {
  const std::string bytes = encode_state(*some_statistics());
  for (std::size_t size = 0; size < bytes.size(); size += step(size, bytes.size()))
    ASSERT_THAT(error_of(std::string_view{bytes}.substr(0, size)), HasSubstr("half.dls")) << size;
}

TEST(StateFile, NoticesEveryDamagedByte) {
  std::string bytes = encode_state(*some_statistics());
  for (std::size_t i = 0; i < bytes.size(); i += step(i, bytes.size())) {
    bytes[i] = static_cast<char>(bytes[i] ^ 0x10);
    ASSERT_THAT(error_of(bytes), HasSubstr("half.dls")) << i;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x10);
  }
  EXPECT_EQ(error_of(bytes), "no error");
}

TEST(StateFile, LeavesTheOldContentWhereTheNewOneIsDamaged) {
  auto statistics = some_statistics();
  std::string bytes = encode_state(*statistics);
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  statistics->header.basis_hash = 42;
  EXPECT_THROW(decode_state(bytes, "half.dls", *statistics), RunError);
  EXPECT_EQ(statistics->header.basis_hash, 42U);
}

TEST(StateFile, RefusesBytesAfterTheEnd) {
  EXPECT_THAT(error_of(encode_state(*some_statistics()) + "x"), HasSubstr("too many"));
}

/// A whole record, and the same in two halves that go through files.
TEST(StateFile, TwoHalvesMergeToTheWhole) {
  constexpr int kSamples = 36000;
  sim::Simulation simulation{sim::SimulationConfig{}};
  const auto whole = std::make_unique<Estimator>(EstimatorConfig{});
  const auto parts = std::make_unique<Estimator>(EstimatorConfig{});
  auto statistics = std::make_unique<Statistics>();
  std::string first;
  for (int i = 0; i < kSamples; ++i) {
    const Sample sample = sim::to_sample(simulation.next());
    whole->update(sample);
    parts->update(sample);
    if (i != kSamples / 2) continue;
    parts->export_statistics(*statistics);
    first = encode_state(*statistics);
    parts->clear_statistics();
  }
  whole->finish();
  parts->finish();
  parts->export_statistics(*statistics);
  const std::string second = encode_state(*statistics);

  auto merged = std::make_unique<Statistics>();
  decode_state(first, "first.dls", *merged);
  decode_state(second, "second.dls", *statistics);
  merge_state(*merged, *statistics, "second.dls");
  whole->export_statistics(*statistics);
  const SummaryConfig config{.moving_mass_kg = EstimatorConfig{}.moving_mass_kg};
  const Snapshot from_parts = summarise(*merged, config);
  const Snapshot from_whole = summarise(*statistics, config);
  EXPECT_EQ(from_parts.counts.blocks, from_whole.counts.blocks);
  EXPECT_EQ(from_parts.counts.samples, from_whole.counts.samples);
  EXPECT_NEAR(from_parts.coulomb_n.value / from_whole.coulomb_n.value, 1.0, 1e-10);
  EXPECT_NEAR(from_parts.stiffness_npm.value / from_whole.stiffness_npm.value, 1.0, 1e-10);
  for (std::size_t i = 0; i < kCurveSegments; ++i)
    EXPECT_NEAR(from_parts.curve[i].force_n / from_whole.curve[i].force_n, 1.0, 1e-9);
}

TEST(StateFile, StatesOfAnotherBasisAreNotAdded) {
  const auto into = some_statistics();
  const auto from = some_statistics();
  from->header.basis_hash = 1;
  const std::string before = encode_state(*into);
  EXPECT_THROW(merge_state(*into, *from, "other.dls"), RunError);
  EXPECT_EQ(encode_state(*into), before);
}

TEST(StateFile, SaysWhenAFileIsOfAnotherKind) {
  EXPECT_THAT(error_of("(1600000000.000000) can0 123#00"), HasSubstr("no dampline state"));
}

}  // namespace
}  // namespace dampline::app
