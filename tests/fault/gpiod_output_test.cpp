// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cerrno>

#include "drivers/gpiod/lines.hpp"
#include "tests/fault/fault_plan.hpp"
#include "tests/fault/gpiod_model.hpp"

namespace dampline::fault {
namespace {

using drivers::open_output;
using drivers::OutputConfig;

const OutputConfig kLamp{.chip = "gpiochip_model", .offset = 4, .active_low = true};

TEST(GpiodOutput, DrivesItsLine) {
  GpioModel model;
  auto lamp = open_output(kLamp);
  ASSERT_TRUE(lamp.ok()) << lamp.error_text();
  EXPECT_TRUE(model.active_low(4));
  EXPECT_FALSE(model.output(4));
  EXPECT_TRUE(lamp.value()->set(true).value());
  EXPECT_TRUE(model.output(4));
  EXPECT_FALSE(lamp.value()->set(false).value());
  EXPECT_FALSE(model.output(4));
}

TEST(GpiodOutput, TellsAnErrorFromAChipThatIsGone) {
  GpioModel model;
  auto lamp = open_output(kLamp);
  ASSERT_TRUE(lamp.ok()) << lamp.error_text();
  {
    const ArmedFault fault{{.call = Call::kGpio, .error = EIO}};
    EXPECT_EQ(lamp.value()->set(true).error(), Errc::kIo);
    EXPECT_FALSE(model.output(4));
    EXPECT_TRUE(lamp.value()->set(true).ok());
  }
  model.remove();
  EXPECT_EQ(lamp.value()->set(false).error(), Errc::kLinkDown);
}

TEST(GpiodOutput, SurvivesEachFailingCall) {
  for (std::uint64_t nth = 1;; ++nth) {
    GpioModel model;
    const ArmedFault fault{{.call = Call::kGpio, .nth = nth, .error = EPERM}};
    {
      auto lamp = open_output(kLamp);
      if (!lamp.ok()) {
        EXPECT_NE(lamp.error_text().find("/dev/gpiochip_model"), std::string::npos);
        EXPECT_EQ(fault.fired(), 1U);
      } else {
        const bool set = lamp.value()->set(true).ok();
        EXPECT_EQ(set, model.output(4)) << "success must be true";
        EXPECT_EQ(set, fault.fired() == 0);
      }
    }
    EXPECT_EQ(model.objects(), 0) << nth;
    EXPECT_EQ(model.lines_in_use(), 0) << nth;
    if (fault.fired() == 0) break;
    ASSERT_LT(nth, 100U);
  }
}

}  // namespace
}  // namespace dampline::fault
