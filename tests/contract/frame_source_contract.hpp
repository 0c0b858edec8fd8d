// SPDX-License-Identifier: MIT
// What every FrameSource keeps. An implementation is brought here as a class with source(), which
// delivers kContractFrames frames. A record then ends; a bus (kEnds false) goes on, and its class
// has down() and up(), after which one frame more comes.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

#include "hal/frame_source.hpp"

namespace dampline {

inline constexpr std::size_t kContractFrames = 300;

template <class Implementation>
class FrameSourceContract : public ::testing::Test {
 protected:
  static constexpr bool kEnds = !requires(Implementation & bus) { bus.down(); };

  hal::FrameSource& source() { return implementation_.source(); }
  Implementation& implementation() { return implementation_; }
  /// Everything that is there, `some` frames at a time.
  std::vector<CanFrame> read_all(std::size_t some) {
    std::vector<CanFrame> frames;
    std::vector<CanFrame> part(some);
    for (;;) {
      const auto count = source().read(part);
      if (!count.ok() || (!kEnds && count.value() == 0)) break;
      EXPECT_LE(count.value(), some);
      frames.insert(frames.end(), part.begin(),
                    part.begin() + static_cast<std::ptrdiff_t>(count.value()));
      if (frames.size() > kContractFrames) break;
    }
    return frames;
  }

 private:
  Implementation implementation_;
};
TYPED_TEST_SUITE_P(FrameSourceContract);

TYPED_TEST_P(FrameSourceContract, DeliversFramesInNonDecreasingTime) {
  const auto frames = this->read_all(7);
  ASSERT_EQ(frames.size(), kContractFrames);
  EXPECT_TRUE(std::ranges::is_sorted(frames, {}, &CanFrame::time_ns));
  const auto now_ns = this->source().now_ns();
  EXPECT_EQ(now_ns.has_value(), !TestFixture::kEnds) << "a bus has a clock, a record has none";
  EXPECT_LE(frames.back().time_ns, now_ns.value_or(std::numeric_limits<std::int64_t>::max()));
}

TYPED_TEST_P(FrameSourceContract, TellsEventsInTheOrderOfTheirTime) {
  static_cast<void>(this->read_all(1000));
  std::int64_t before_ns = std::numeric_limits<std::int64_t>::min();
  for (hal::Event event; this->source().next_event(event); before_ns = event.time_ns)
    EXPECT_GE(event.time_ns, before_ns);
}

TYPED_TEST_P(FrameSourceContract, StaysAtItsEndOrHasNone) {
  static_cast<void>(this->read_all(1000));
  std::array<CanFrame, 4> frames;
  for (int i = 0; i < 3; ++i) {
    const auto count = this->source().read(frames);
    ASSERT_EQ(count.ok(), !TestFixture::kEnds) << "no frame is success, an end is not";
    if (count.ok()) {
      EXPECT_EQ(count.value(), 0U);
    } else {
      EXPECT_EQ(count.error(), Errc::kEndOfStream);
    }
  }
}

TYPED_TEST_P(FrameSourceContract, DeliversAgainAfterALinkThatWasDown) {
  if constexpr (!TestFixture::kEnds) {
    ASSERT_EQ(this->read_all(1000).size(), kContractFrames);
    this->implementation().down();
    std::array<CanFrame, 4> frames;
    const auto down = this->source().read(frames);
    ASSERT_FALSE(down.ok());
    EXPECT_EQ(down.error(), Errc::kLinkDown);
    EXPECT_FALSE(this->source().health().link_up);
    this->implementation().up();
    EXPECT_TRUE(this->source().wait(std::chrono::seconds{10}).value());
    EXPECT_EQ(this->read_all(1000).size(), 1U);
    EXPECT_TRUE(this->source().health().link_up);
  }
}

TYPED_TEST_P(FrameSourceContract, ReadsNothingIntoNoSpaceAndLosesNothingByIt) {
  const auto count = this->source().read({});
  ASSERT_TRUE(count.ok());
  EXPECT_EQ(count.value(), 0U);
  EXPECT_EQ(this->read_all(1).size(), kContractFrames);
}

TYPED_TEST_P(FrameSourceContract, CountsWhatItDelivered) {
  static_cast<void>(this->read_all(11));
  EXPECT_EQ(this->source().health().frames, kContractFrames);
  EXPECT_FALSE(this->source().health().truncated);
}

TYPED_TEST_P(FrameSourceContract, SaysWhetherThereIsSomethingToRead) {
  const auto something = this->source().wait(std::chrono::milliseconds{1});
  ASSERT_TRUE(something.ok());
  EXPECT_TRUE(something.value());
  static_cast<void>(this->read_all(100));
  // An end is to be reported; on a bus nothing is left.
  EXPECT_EQ(this->source().wait(std::chrono::milliseconds{1}).value(), TestFixture::kEnds);
}

REGISTER_TYPED_TEST_SUITE_P(FrameSourceContract, DeliversFramesInNonDecreasingTime,
                            TellsEventsInTheOrderOfTheirTime, StaysAtItsEndOrHasNone,
                            DeliversAgainAfterALinkThatWasDown,
                            ReadsNothingIntoNoSpaceAndLosesNothingByIt, CountsWhatItDelivered,
                            SaysWhetherThereIsSomethingToRead);

}  // namespace dampline
