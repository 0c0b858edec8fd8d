// SPDX-License-Identifier: MIT
// Sensors that sit where they do not tell the motion of one truck, by a simulation that shares
// nothing with the program. bench/places has every row on more records.
#include <gtest/gtest.h>

#include <string>

#include "tests/app/plain_truck.hpp"

namespace dampline::app {
namespace {

using test::explained_from;
using test::kPlainTrucks;
using test::PlainSensors;

struct Sitting {
  const char* name;
  const char* fault;
  PlainSensors sensors;
};

class PlacesTest : public testing::TestWithParam<Sitting> {};

TEST_P(PlacesTest, AreNamedAndPassForNoEffect) {
  for (const std::size_t which : {0U, 2U}) {
    const test::PlainExplained found =
        explained_from(kPlainTrucks.at(which), GetParam().sensors, 150.0, 61);
    EXPECT_TRUE(found.has_fault(GetParam().fault)) << kPlainTrucks.at(which).name;
    EXPECT_FALSE(found.names_effect()) << kPlainTrucks.at(which).name;
    EXPECT_EQ(found.result.trust, Trust::kDataFaulty) << kPlainTrucks.at(which).name;
  }
}

std::string name_of_sitting(const testing::TestParamInfo<Sitting>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Rows, PlacesTest,
    testing::Values(Sitting{"OffTheMiddle", "off_centre", {.off_centre_m = 0.1}},
                    Sitting{"WhereWheelsetsRoll", "foreign_motion", {.roll = 0.3}},
                    Sitting{"OnAMountThatRings", "ringing_mount", {.frame_mount_hz = 70.0}}),
    name_of_sitting);
INSTANTIATE_TEST_SUITE_P(
    NightlyRows, PlacesTest,
    testing::Values(Sitting{"WhereAllRoll", "foreign_motion", {.roll = 0.3, .frame_rolls = true}},
                    Sitting{"OnATruckThatHunts", "foreign_motion", {.hunting_mps2 = 0.1}},
                    Sitting{"OnAWheelsetsMount", "ringing_mount", {.wheelset_mount_hz = 40.0}}),
    name_of_sitting);

TEST(Places, AreDoubtedByIdentifyToo) {
  for (const std::size_t which : {0U, 2U}) {
    const test::PlainTruck& truck = kPlainTrucks.at(which);
    const RunResult result = test::identified_from(truck, {.off_centre_m = 0.06}, 150.0, 62);
    EXPECT_EQ(result.trust, Trust::kModelIncomplete) << truck.name;
    ASSERT_FALSE(result.trust_reasons.empty()) << truck.name;
    EXPECT_NE(result.trust_reasons.front().find("over the middle"), std::string::npos);
  }
}

TEST(Places, AreSoundWhereTheyShouldBe) {
  for (const test::PlainTruck& truck : kPlainTrucks) {
    const test::PlainExplained found = explained_from(truck, {}, 150.0, 61);
    EXPECT_TRUE(found.result.faults.list.empty()) << truck.name;
    EXPECT_EQ(found.result.trust, Trust::kTrusted) << truck.name;
  }
}

}  // namespace
}  // namespace dampline::app
