// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <string>

#include "app/config/config.hpp"
#include "app/record/rate.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::app {
namespace {

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

}  // namespace
}  // namespace dampline::app
