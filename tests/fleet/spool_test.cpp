// SPDX-License-Identifier: MIT
// A logger's segments, and the folder in which they wait for the fleet.
#include "app/fleet/spool.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <numeric>
#include <set>
#include <thread>

#include "app/error.hpp"
#include "app/fleet/leaves.hpp"
#include "dampline/damping/summary.hpp"
#include "tests/fleet/logger.hpp"
#include "tests/fleet/segments.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

constexpr double kSeconds = 100.0;
constexpr std::int64_t kSegmentNs = 20'000'000'000;

const std::vector<SegmentFile>& kept_states() {
  static const std::vector<SegmentFile> kStates = Logger{Logger::config(20.0, 6.0)}.drive(kSeconds);
  return kStates;
}

TEST(SegmentRun, IsCumulativeWithinASegmentAndBeginsAtFullOnes) {
  const std::vector<SegmentFile> ended = last_states(kept_states());
  ASSERT_EQ(ended.size(), 5U);  // the simulated time begins at a full one
  EXPECT_GT(kept_states().size(), 2 * ended.size());
  for (std::size_t i = 1; i < kept_states().size(); ++i) {
    const StateAbout& a = kept_states()[i - 1].about;
    const StateAbout& b = kept_states()[i].about;
    if (a.segment == b.segment) {
      EXPECT_LT(a.sequence, b.sequence);
      EXPECT_LT(a.end_ns, b.end_ns);
    } else {
      EXPECT_LT(a.end_ns, b.segment.start_ns);
      EXPECT_LT(b.segment.start_ns % kSegmentNs, 10'000'000);
    }
  }
  EXPECT_EQ(ended[2].about.segment.vehicle, "4711");
  EXPECT_EQ(ended[2].about.load, "laden");
}

TEST(SegmentRun, AddsUpToTheWholeRun) {
  Logger logger{Logger::config(20.0, 6.0)};
  const std::vector<SegmentFile> ended = last_states(logger.drive(kSeconds));
  const auto sum = std::make_unique<Statistics>();
  const auto part = std::make_unique<Statistics>();
  decode_state(ended.front().bytes, "first", *sum);
  for (std::size_t i = 1; i < ended.size(); ++i) {
    decode_state(ended[i].bytes, "part", *part);
    merge_state(*sum, *part, "part");
  }
  const auto whole = logger.run().statistics();
  EXPECT_EQ(sum->header.counts.samples, static_cast<std::uint64_t>(300.0 * kSeconds));
  EXPECT_EQ(sum->header.counts.blocks, whole->header.counts.blocks);
  EXPECT_EQ(sum->header.counts.rows, whole->header.counts.rows);
  EXPECT_EQ(sum->total.blocks, whole->total.blocks);
  EXPECT_EQ(sum->header.velocity.moving, whole->header.velocity.moving);
  const SummaryConfig mass{.moving_mass_kg = 37200.0};
  const Snapshot a = summarise(*sum, mass);
  const Snapshot b = summarise(*whole, mass);
  ASSERT_TRUE(a.valid && b.valid);
  // The same information, added in another order.
  EXPECT_NEAR(a.coulomb_n.value / b.coulomb_n.value, 1.0, 1e-3);
  EXPECT_NEAR(a.stiffness_npm.value / b.stiffness_npm.value, 1.0, 1e-3);
}

TEST(SegmentRun, BeginsAnotherSegmentWhereTheClockJumps) {
  const auto ended = last_states(
      Logger{Logger::config(3600.0, 5.0)}.drive(60.0, {{20.0, -500.0}, {40.0, 40'000.0}}));
  ASSERT_GE(ended.size(), 2U);
  std::set<std::int64_t> starts;
  std::uint64_t samples = 0;
  for (const SegmentFile& file : ended) {
    starts.insert(file.about.segment.start_ns);
    samples += file.about.sequence;
    EXPECT_LE(file.about.segment.start_ns, file.about.end_ns);
  }
  EXPECT_EQ(starts.size(), ended.size());
  EXPECT_GE(samples, 35U * 300U);  // some may be unusable about a jump
}

TEST(SegmentRun, IsKnownByANumberWhereTheClockHasNoDate) {
  const auto ended =
      last_states(Logger{Logger::config(20.0, 6.0)}.drive(50.0, {{0.0, -1'699'999'000.0}}));
  ASSERT_GE(ended.size(), 3U);
  std::set<std::string> names;
  for (const SegmentFile& file : ended) {
    EXPECT_EQ(file.about.segment.start_ns, 0);
    names.insert(fleet::segment_name(file.about.segment));
  }
  EXPECT_EQ(names.size(), ended.size());
}

TEST(SegmentName, IsOneForEachKey) {
  using fleet::segment_name;
  EXPECT_EQ(segment_name({"31 80 4567", "A", 17, 0}), "31%2080%204567.A.17");
  EXPECT_EQ(segment_name({"a", "b", 0, 255}), "a.b.0-00000000000000ff");
  EXPECT_NE(segment_name({"a.b", "c", 1, 0}), segment_name({"a", "b.c", 1, 0}));
  EXPECT_NE(segment_name({"a_", "c", 1, 0}), segment_name({"a.", "c", 1, 0}));
  EXPECT_EQ(segment_name({"*>/", "\x01", 1, 0}), "%2A%3E%2F.%01.1");
}

class SpoolTest : public SegmentsTest {
 protected:
  SpoolTest() {
    settings_.folder = program_.path("spool").string();
    settings_.reserve_free_mib = 0;
  }
  fleet::Spool open() const { return {settings_, {"4711", "front", "", ""}}; }
  std::filesystem::path file_of(const SegmentFile& state) const {
    return std::filesystem::path{settings_.folder} /
           (fleet::segment_name(state.about.segment) + ".dls");
  }
  /// The last state again, of the hour `i`.
  static SegmentFile hour(int i) {
    const auto sums = std::make_unique<Statistics>();
    SegmentFile out = kept_states().back();
    decode_state(out.bytes, "last", *sums);
    out.about.segment.start_ns += i * 3'600'000'000'000;
    out.bytes = encode_state(*sums, out.about);
    return out;
  }
  std::size_t count(std::string_view extension) const {
    std::size_t out = 0;
    for (const auto& entry : std::filesystem::directory_iterator{settings_.folder})
      if (entry.path().extension() == extension) ++out;
    return out;
  }
  SpoolSettings settings_;
};

TEST_F(SpoolTest, HoldsOfEachSegmentTheNewest) {
  fleet::Spool spool = open();
  for (const SegmentFile& state : kept_states()) spool.put(state.about.segment, state.bytes);
  const auto ended = last_states(kept_states());
  EXPECT_EQ(count(".dls"), ended.size());
  std::string files;
  for (const SegmentFile& state : ended)
    EXPECT_TRUE(fleet::file_reader(file_of(state))() == state.bytes);
  EXPECT_TRUE(spool.warnings().empty());
  // What the program makes of them: of the folder, of the files, and by way of a database.
  expect_success("collect spool --db fleet.sqlite --quiet");
  for (const SegmentFile& state : ended)
    files += "spool/" + file_of(state).filename().string() + " ";
  EXPECT_TRUE(merged_bytes("spool") == merged_bytes(files));
  EXPECT_TRUE(merged_bytes("spool") == merged_bytes("fleet.sqlite"));
}

TEST_F(SpoolTest, LosesTheSentOnesFirstAndCountsTheOthers) {
  settings_.keep_mib = 1;
  fleet::Spool spool = open();
  const auto fit = static_cast<int>((std::size_t{1} << 20U) / hour(0).bytes.size());
  ASSERT_GT(fit, 3);
  for (int i = 0; i < fit; ++i) spool.put(hour(i).about.segment, hour(i).bytes);
  EXPECT_EQ(count(".dls"), static_cast<std::size_t>(fit));
  for (int i = 1; i < 3; ++i) fleet::mark_sent(file_of(hour(i)), hour(i).bytes);
  for (int i = fit; i < fit + 2; ++i) spool.put(hour(i).about.segment, hour(i).bytes);
  EXPECT_EQ(spool.health().dropped, 0U);
  EXPECT_TRUE(std::filesystem::exists(file_of(hour(0))));
  EXPECT_FALSE(std::filesystem::exists(file_of(hour(1))));
  EXPECT_FALSE(std::filesystem::exists(file_of(hour(2))));
  EXPECT_EQ(count(".sent"), 0U);
  spool.put(hour(fit + 2).about.segment, hour(fit + 2).bytes);
  EXPECT_EQ(spool.health().dropped, 1U);
  EXPECT_FALSE(std::filesystem::exists(file_of(hour(0))));
  EXPECT_THAT(spool.warnings().at(0), HasSubstr("1 segments went before they were sent"));
}

TEST_F(SpoolTest, OnAFullDiskStatesWaitAndAreTold) {
  constexpr int kMoreThanAnyDisk = 1'000'000'000;  // MiB that shall stay free
  fleet::Spool roomy = open();
  roomy.put(hour(0).about.segment, hour(0).bytes);
  roomy.put(hour(1).about.segment, hour(1).bytes);
  fleet::mark_sent(file_of(hour(1)), hour(1).bytes);
  settings_.reserve_free_mib = kMoreThanAnyDisk;
  fleet::Spool full = open();
  full.put(hour(2).about.segment, hour(2).bytes);
  EXPECT_EQ(full.waiting(), 1U);
  EXPECT_EQ(full.health().failures, 1U);
  EXPECT_THAT(full.warnings().at(0), HasSubstr("the disk is full"));
  EXPECT_TRUE(std::filesystem::exists(file_of(hour(0)))) << "not sent";
  EXPECT_FALSE(std::filesystem::exists(file_of(hour(1)))) << "sent";
  // A folder that is gone and comes back.
  settings_.reserve_free_mib = 0;
  fleet::Spool spool = open();
  std::filesystem::remove_all(settings_.folder);
  spool.put(hour(3).about.segment, hour(3).bytes);
  EXPECT_EQ(spool.waiting(), 1U);
  std::filesystem::create_directory(settings_.folder);
  spool.put(hour(4).about.segment, hour(4).bytes);
  EXPECT_EQ(spool.waiting(), 0U);
  EXPECT_EQ(count(".dls"), 2U);
}

TEST_F(SpoolTest, ALaterStateIsToBeSentAgain) {
  fleet::Spool spool = open();
  const SegmentFile& first = kept_states().at(0);
  const SegmentFile& second = kept_states().at(1);
  ASSERT_EQ(first.about.segment, second.about.segment);
  spool.put(first.about.segment, first.bytes);
  EXPECT_FALSE(fleet::was_sent(file_of(first)));
  fleet::mark_sent(file_of(first), first.bytes);
  EXPECT_TRUE(fleet::was_sent(file_of(first)));
  spool.put(second.about.segment, second.bytes);
  EXPECT_FALSE(fleet::was_sent(file_of(first)));
  fleet::mark_sent(file_of(first), first.bytes);  // a late word of the first
  EXPECT_FALSE(fleet::was_sent(file_of(first)));
}

TEST_F(SpoolTest, SurvivesAKillAtAnyMoment) {
  ASSERT_FALSE(kept_states().empty());  // made before the children
  for (int round = 0; round < 8; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      fleet::Spool spool = open();
      for (std::size_t i = 0;; ++i) {
        const SegmentFile& state = kept_states()[i % kept_states().size()];
        spool.put(state.about.segment, state.bytes);
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{15 + 7 * round});
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    fleet::Spool after = open();  // takes away what was being written
    const auto sums = std::make_unique<Statistics>();
    for (const auto& entry : std::filesystem::directory_iterator{settings_.folder}) {
      EXPECT_EQ(entry.path().extension(), ".dls") << entry.path();
      const StateAbout about = load_state(entry.path(), *sums);
      EXPECT_EQ(fleet::segment_name(about.segment), entry.path().stem());
    }
  }
  EXPECT_GT(count(".dls"), 0U);
}

TEST_F(SpoolTest, WantsToKnowWhoseStatesTheyAre) {
  EXPECT_THROW((fleet::Spool{settings_, {"4711", "", "", ""}}), UsageError);
  EXPECT_THROW((fleet::Spool{settings_, {std::string(90, ' '), "a", "", ""}}), UsageError);
}

}  // namespace
}  // namespace dampline::app
