// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <string>

#include "app/config/config.hpp"
#include "app/error.hpp"
#include "app/record/rate.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::app {
namespace {

using testing::AllOf, testing::HasSubstr;

std::string rows(double rate_hz) {
  std::string out = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  for (int i = 0; i < 50; ++i) out += std::to_string(i / rate_hz) + ",0.1,0.2,0.3\n";
  return out;
}

TEST(RecordRate, IsTheFilesOwnWhereNoneWasSet) {
  const dampline::test::TemporaryFile file{rows(512.0), ".csv"};
  const SourceOptions source{file.path(), false};
  const Config found = with_record_rate({}, source, SourceKind::kTruckRows);
  EXPECT_NEAR(found.input.sample_rate_hz, 512.0, 0.1);
  EXPECT_NEAR(truck_rate_hz(found.input), 256.0, 0.05);
  const Config set = parse_config("[input]\nsample_rate_hz = 300.0\n", "test");
  EXPECT_EQ(with_record_rate(set, source, SourceKind::kTruckRows).input.sample_rate_hz, 300.0);
}

TEST(RecordRate, ThatIsNotTheDeclaredOneEndsTheRun) {
  const auto told = [](double rate_hz) {
    try {
      return std::to_string(make_correction({rate_hz, 0.0, 1000}, 300.0, "can0").ratio);
    } catch (const RunError& error) {
      return std::string{error.what()};
    }
  };
  EXPECT_EQ(told(301.5), "1.005000");
  EXPECT_THAT(told(305.0), HasSubstr("can0: sampled at 305.000 Hz by its own time"));
  EXPECT_THAT(told(5120.0), HasSubstr("can0: sampled at 5120.000 Hz by its own time"));
  // Stamps of bursts too long to be numbered lie on one another.
  EXPECT_THAT(told(4e15),
              AllOf(HasSubstr("sampled at 4e+15 Hz by its own time"), HasSubstr("300.000"),
                    HasSubstr("bursts of more than 48 instants")));
}

}  // namespace
}  // namespace dampline::app
