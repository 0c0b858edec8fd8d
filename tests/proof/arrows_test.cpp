// SPDX-License-Identifier: MIT
#include "tests/proof/arrows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dampline::proof {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

const std::vector<std::string> kRooms{"firmware_core", "hal", "drivers", "sim_hw", "app"};

TEST(Arrows, PointFromTheApplicationToTheCoreInTheSourceTree) {
  const std::vector<SourceFile> files = read_sources(kRooms);
  ASSERT_THAT(files, Not(IsEmpty()));
  EXPECT_THAT(wrong_arrows(files), IsEmpty());
}

TEST(Arrows, AreReportedWhereTheyPointTheWrongWay) {
  const std::vector<SourceFile> files{
      {"firmware_core/dampline/a.hpp", "#include <Eigen/Core>\n#include <vector>\n"},
      {"firmware_core/dampline/b.cpp", "  #  include \"hal/frame_source.hpp\"\n"},
      {"firmware_core/dampline/c.hpp", "#include \"generate/exact_connection.hpp\"\n"},
      {"firmware_core/generate/d.cpp", "#include <vector>\n#include \"app/error.hpp\"\n"},
      {"firmware_core/dampline/e.hpp", "#include \"published/wavelet/terms.hpp\"\n"},
      {"firmware_core/published/f.hpp", "#include \"dampline/e.hpp\"\n#include \"sim_hw/x.hpp\"\n"},
      {"hal/clock.hpp", "#include \"drivers/csv.hpp\"\n#include <chrono>\n"},
      {"sim_hw/truck.cpp", "#include \"drivers/csv.hpp\"\n#include \"../app/main.hpp\"\n"},
      {"drivers/csv.cpp", "#include \"sim_hw/truck.hpp\"\n#include \"hal/frame_source.hpp\"\n"},
      {"app/verify/main.cpp", "#include \"published/f.hpp\"\n#include \"drivers/csv.hpp\"\n"},
      {"app/main.cpp", "#include \"published/f.hpp\"\n#include \"tests/x.hpp\"\n"}};
  EXPECT_THAT(
      wrong_arrows(files),
      ElementsAre(
          "firmware_core/dampline/a.hpp includes vector",
          "firmware_core/dampline/b.cpp includes hal/frame_source.hpp",
          "firmware_core/dampline/c.hpp includes generate/exact_connection.hpp",
          "firmware_core/generate/d.cpp includes vector",
          "firmware_core/generate/d.cpp includes app/error.hpp",
          "firmware_core/dampline/e.hpp includes published/wavelet/terms.hpp",
          "firmware_core/published/f.hpp includes sim_hw/x.hpp",
          "hal/clock.hpp includes drivers/csv.hpp", "sim_hw/truck.cpp includes drivers/csv.hpp",
          "sim_hw/truck.cpp includes ../app/main.hpp", "drivers/csv.cpp includes sim_hw/truck.hpp",
          "app/verify/main.cpp includes drivers/csv.hpp", "app/main.cpp includes published/f.hpp",
          "app/main.cpp includes tests/x.hpp"));
}

TEST(Arrows, BetweenRoomsOfTheCoreFormNoCircle) {
  const std::vector<SourceFile> files{
      {"firmware_core/dampline/basis/a.hpp",
       "#include \"dampline/numeric/b.hpp\"\n#include \"dampline/snapshot.hpp\"\n"},
      {"firmware_core/dampline/numeric/b.hpp", "#include \"dampline/basis/a.hpp\"\n"},
      {"firmware_core/dampline/estimate/c.cpp", "#include \"dampline/estimate/c.hpp\"\n"},
      {"firmware_core/dampline/identifier.hpp", "#include \"dampline/guard/guard.hpp\"\n"},
      {"firmware_core/dampline/attic/d.hpp", "#include \"dampline/attic/e.hpp\"\n"},
      {"app/main.cpp", "#include \"dampline/effect/f.hpp\"\n"}};
  EXPECT_THAT(wrong_arrows(files),
              ElementsAre("firmware_core/dampline/numeric/b.hpp includes dampline/basis/a.hpp",
                          "firmware_core/dampline/attic/d.hpp includes dampline/attic/e.hpp"));
}

}  // namespace
}  // namespace dampline::proof
