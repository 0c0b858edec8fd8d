// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "app/live/digital_lines.hpp"

namespace dampline::app {
namespace {

constexpr std::int64_t kOneSecondNs = 1'000'000'000;
constexpr std::int64_t kTickNs = 25'000'000;

/// What a lamp was told; outlives it.
struct Wire {
  std::vector<bool> set;
  bool broken{false};
};

class FakeLamp final : public hal::DigitalOutput {
 public:
  explicit FakeLamp(Wire& wire) : wire_{wire} {}

 private:
  Result<bool> do_set(bool active) noexcept override {
    if (wire_.broken) return Errc::kIo;
    wire_.set.push_back(active);
    return active;
  }
  Wire& wire_;
};

/// Changes and share of light in 10 s, looked at every millisecond.
struct Look {
  int changes{0};
  double lit{0.0};
};
Look look_at(LampState state) {
  Look look;
  constexpr std::int64_t kMillisecondNs = 1'000'000;
  for (std::int64_t i = 0; i < 10'000; ++i) {
    const bool now = lamp_lit(state, i * kMillisecondNs);
    if (now != lamp_lit(state, (i + 1) * kMillisecondNs)) ++look.changes;
    look.lit += now ? 1e-4 : 0.0;
  }
  return look;
}

TEST(LampPattern, TellsTheStatesApart) {
  EXPECT_EQ(look_at(LampState::kOff).changes, 0);
  EXPECT_NEAR(look_at(LampState::kOff).lit, 0.0, 1e-9);
  EXPECT_EQ(look_at(LampState::kIdentifying).changes, 0);
  EXPECT_NEAR(look_at(LampState::kIdentifying).lit, 1.0, 1e-9);
  EXPECT_EQ(look_at(LampState::kDegraded).changes, 10);
  EXPECT_NEAR(look_at(LampState::kDegraded).lit, 0.5, 1e-9);
  EXPECT_EQ(look_at(LampState::kFault).changes, 80);  // four flashes a second
  EXPECT_NEAR(look_at(LampState::kFault).lit, 0.5, 1e-9);
}

TEST(StatusLamp, IsSetOnlyWhenItChanges) {
  Wire wire;
  StatusLamp lamp{std::make_unique<FakeLamp>(wire)};
  for (std::int64_t ns = 0; ns < 5 * kOneSecondNs; ns += kTickNs) {
    lamp.show(LampState::kIdentifying, ns);
  }
  EXPECT_EQ(wire.set, std::vector<bool>{true});
  for (std::int64_t ns = 5 * kOneSecondNs; ns < 9 * kOneSecondNs; ns += kTickNs) {
    lamp.show(LampState::kDegraded, ns);
  }
  EXPECT_EQ(wire.set, (std::vector<bool>{true, false, true, false, true}));
}

TEST(StatusLamp, IsDarkAtTheEnd) {
  Wire wire;
  {
    StatusLamp lamp{std::make_unique<FakeLamp>(wire)};
    lamp.show(LampState::kIdentifying, 0);
  }
  EXPECT_EQ(wire.set, (std::vector<bool>{true, false}));
}

TEST(StatusLamp, CountsFailuresAndTriesAgainOnceASecond) {
  Wire wire;
  wire.broken = true;
  StatusLamp lamp{std::make_unique<FakeLamp>(wire)};
  for (std::int64_t ns = 0; ns < 5 * kOneSecondNs; ns += kTickNs) lamp.show(LampState::kFault, ns);
  EXPECT_GE(lamp.failures(), 4U);
  EXPECT_LE(lamp.failures(), 6U);
  wire.broken = false;
  for (std::int64_t ns = 5 * kOneSecondNs; ns < 7 * kOneSecondNs; ns += kTickNs) {
    lamp.show(LampState::kIdentifying, ns);
  }
  EXPECT_EQ(wire.set, std::vector<bool>{true});
}

TEST(StatusLamp, IsContentWithoutALamp) {
  StatusLamp lamp{nullptr};
  lamp.show(LampState::kFault, 0);
  EXPECT_EQ(lamp.failures(), 0U);
}

}  // namespace
}  // namespace dampline::app
