// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/error.hpp"
#include "app/run/directory.hpp"
#include "app/run/disk.hpp"
#include "app/run/json.hpp"
#include "app/run/provenance.hpp"
#include "app/run/tables.hpp"
#include "tests/app/fake_result.hpp"

namespace dampline::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunDirectoryTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path{testing::TempDir()} / (std::string{"run_directory_"} + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  static std::size_t entries(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator{folder}, {}));
  }
  fs::path folder_;
};

TEST_F(RunDirectoryTest, ShowsNothingBeforeItIsWhole) {
  const fs::path out = folder_ / "deep" / "run";
  RunDirectory run{out, false};
  run.write("run.toml", "a");
  EXPECT_FALSE(fs::exists(out / "run.toml"));
  run.commit();
  EXPECT_TRUE(fs::exists(out / "run.toml"));
}

TEST_F(RunDirectoryTest, LeavesNothingBehindWhenItIsAbandoned) {
  {
    RunDirectory run{folder_ / "deep" / "run", false};
    run.write("curve.csv", "a");
  }
  EXPECT_EQ(entries(folder_), 0U);
}

TEST_F(RunDirectoryTest, DoesNotTouchADirectoryThatHoldsSomething) {
  std::ofstream{folder_ / "thesis.tex"} << "years of work";
  EXPECT_THROW((RunDirectory{folder_, false}), UsageError);
  EXPECT_THROW((RunDirectory{folder_, true}), UsageError) << "even when asked to replace";
}

TEST_F(RunDirectoryTest, ReplacesAnEarlierRunWhenAskedTo) {
  {
    RunDirectory first{folder_, false};
    first.write("run.toml", "first");
    first.write("force.csv", "of the first");
    first.commit();
  }
  EXPECT_THROW((RunDirectory{folder_, false}), UsageError);
  RunDirectory second{folder_, true};
  second.write("run.toml", "second");
  second.commit();
  EXPECT_FALSE(fs::exists(folder_ / "force.csv"));
  std::string text;
  std::getline(std::ifstream{folder_ / "run.toml"}, text);
  EXPECT_EQ(text, "second");
}

TEST_F(RunDirectoryTest, RefusesAFileAsItsPlace) {
  std::ofstream{folder_ / "file"} << "x";
  EXPECT_THROW((RunDirectory{folder_ / "file", false}), UsageError);
  EXPECT_THROW((RunDirectory{folder_ / "file" / "below", false}), RunError);
}

TEST_F(RunDirectoryTest, ReportsAPlaceThatCannotBeWritten) {
  if (::geteuid() == 0) {
    // Nothing is forbidden to root; a file system without directories to make is closed to it, too.
    if (!fs::exists("/proc/self")) GTEST_SKIP() << "root, and /proc is not mounted here";
    EXPECT_THROW((RunDirectory{"/proc/self/run", false}), RunError);
    return;
  }
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THROW((RunDirectory{folder_ / "run", false}), RunError);
  fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(RunDirectoryTest, ReportsAFullDiskAndLeavesNothing) {
  if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "a small file system cannot be mounted here";
  try {
    RunDirectory run{folder_ / "run", false};
    run.write("motion.csv", std::string(1'000'000, 'x'));
    ADD_FAILURE() << "a megabyte fitted into 64 KiB";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("No space left"));
    EXPECT_THAT(error.what(), HasSubstr("motion.csv"));
  }
  EXPECT_EQ(entries(folder_), 0U);
  ::umount(folder_.c_str());
}

TEST_F(RunDirectoryTest, ReadsBackWhatItWrote) {
  RunResult result = fake_result();
  make_live(result);
  const std::string toml =
      write_run_toml(Config{}, {{"a.log", "record", 12, std::string(64, 'f')}});
  RunDirectory directory{folder_ / "run", false};
  stage_files({result, toml, "state"}, directory);
  directory.commit();
  const RunFiles back = read_files(folder_ / "run");
  EXPECT_EQ(to_json(back.result), to_json(result));
  EXPECT_EQ(to_csv(back.result.curve, back.result.methods), to_csv(result.curve, result.methods));
  EXPECT_EQ(to_csv(back.result.densities), to_csv(result.densities));
  EXPECT_EQ(to_json(*back.result.phase), to_json(*result.phase));
  EXPECT_EQ(back.result.phase->section_count[0], 2U);
  EXPECT_EQ(to_csv(back.result.convergence), to_csv(result.convergence));
  EXPECT_EQ(to_csv(back.result.motion), to_csv(result.motion));
  EXPECT_EQ(to_csv(back.result.excluded), to_csv(result.excluded));
  EXPECT_EQ(to_csv(back.result.lateness), to_csv(result.lateness));
  EXPECT_EQ(back.result.lateness.size(), 41U);
  EXPECT_EQ(back.run_toml, toml);
}

TEST_F(RunDirectoryTest, NamesTheFileAndLineThatIsDamaged) {
  RunDirectory directory{folder_ / "run", false};
  stage_files({fake_result(), write_run_toml(Config{}, {}), ""}, directory);
  directory.commit();
  std::ofstream{folder_ / "run" / "curve.csv"}
      << "velocity_mps,force_n,std_n,samples,a,b,c,d\n1,2,3,4,5,6,7,8\n1,x,3,4,5,6,7,8\n";
  try {
    static_cast<void>(read_files(folder_ / "run"));
    ADD_FAILURE();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("curve.csv:3: \"x\""));
  }
  std::ofstream{folder_ / "run" / "curve.csv"} << "velocity_mps,force_n,std_n,samples\n1,2,3,4\n";
  EXPECT_THROW(static_cast<void>(read_files(folder_ / "run")), RunError);  // no columns of methods
  fs::remove(folder_ / "run" / "run.toml");
  EXPECT_THROW(static_cast<void>(read_files(folder_ / "run")), RunError);
}

TEST(FreeRunName, NeverNamesWhatExists) {
  const fs::path folder = fs::path{testing::TempDir()} / "free_run_name";
  fs::remove_all(folder);
  EXPECT_EQ(free_run_name(folder, "a").filename(), "a.run");
  fs::create_directories(folder / "a.run");
  EXPECT_EQ(free_run_name(folder, "a").filename(), "a.run.2");
}

TEST_F(RunDirectoryTest, KeepsTheNewestRunsOfAServiceAndNothingThatIsNone) {
  for (const char* name :
       {"car.run", "car.run.2", "car.run.3", "car.run.10", "car.run.4", "van.run"})
    std::ofstream{(fs::create_directories(folder_ / name), folder_ / name / "run.toml")} << "a";
  fs::create_directories(folder_ / "car.run.1x");
  std::ofstream{(fs::create_directories(folder_ / "car.run.5"), folder_ / "car.run.5/thesis")}
      << "a";
  fs::create_directory_symlink(folder_ / "van.run", folder_ / "car.run.6");
  const std::vector<fs::path> gone = remove_old_runs(folder_, "car", 2);
  EXPECT_EQ(gone, (std::vector{folder_ / "car.run", folder_ / "car.run.2", folder_ / "car.run.3",
                               folder_ / "car.run.4"}));
  for (const char* kept :
       {"car.run.10", "car.run.5", "car.run.6", "car.run.1x", "van.run/run.toml"})
    EXPECT_TRUE(fs::exists(folder_ / kept)) << kept;
  EXPECT_EQ(free_run_name(folder_, "car"), folder_ / "car.run.11");
}

TEST_F(RunDirectoryTest, RemovesWhatNobodyWritesAnyMoreAndFollowsNoLink) {
  Descriptor lock;
  const fs::path written = make_partial(folder_, ".partial-", lock);
  fs::create_directories(folder_ / ".partial-0123456789abcdef/blackbox");
  std::ofstream{folder_ / ".partial-left"} << "half";
  fs::create_directories(folder_ / "elsewhere");
  std::ofstream{folder_ / "elsewhere/precious"} << "a";
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / ".partial-link");
  remove_stale(folder_, ".partial-");
  EXPECT_TRUE(fs::exists(written)) << "it is locked";
  EXPECT_FALSE(fs::exists(folder_ / ".partial-0123456789abcdef"));
  EXPECT_FALSE(fs::exists(folder_ / ".partial-left"));
  EXPECT_TRUE(fs::exists(folder_ / "elsewhere/precious"));
}

// Whoever waits for a name finds none that he could have laid a link under.
TEST_F(RunDirectoryTest, TemporaryNamesCannotBeForeseenAndAreNewFilesOnly) {
  EXPECT_NE(partial_name(), partial_name());
  EXPECT_EQ(partial_name().size(), kPartial.size() + 16);
  const Descriptor folder = open_directory(folder_);
  std::ofstream{folder_ / "victim"} << "kept";
  fs::create_symlink(folder_ / "victim", folder_ / "link");
  EXPECT_THROW(write_new(folder.get(), "link", "new", folder_), IoError);
  EXPECT_THROW(write_new(folder.get(), "victim", "new", folder_), IoError);
  EXPECT_EQ(fs::file_size(folder_ / "victim"), 4U);
  fs::rename(folder_, folder_.string() + ".moved");  // the opened folder is what counts
  write_new(folder.get(), "new", "content", folder_);
  EXPECT_TRUE(fs::exists(folder_.string() + ".moved/new"));
  fs::rename(folder_.string() + ".moved", folder_);
}

TEST(ParametersJson, IsOneOfTheDesign) {
  const auto json = nlohmann::json::parse(to_json(fake_result()));
  ASSERT_EQ(json.at("parameters").size(), 4U);
  EXPECT_EQ(json.at("parameters")[0].at("name"), "coulomb");
  EXPECT_EQ(json.at("parameters")[0].at("unit"), "N");
  EXPECT_DOUBLE_EQ(json.at("parameters")[0].at("value"), 8351.2);
  EXPECT_DOUBLE_EQ(json.at("fit").at("held_out_nmse"), 0.0115);
  EXPECT_EQ(json.at("counts").at("lost"), 31);
  EXPECT_EQ(json.at("asymmetry"), "not observable from accelerations");
}

TEST(ParametersJson, WritesNullForWhatIsNoNumber) {
  RunResult result = fake_result();
  result.parameters[0].std = std::nan("");
  result.fit.rrse.reset();
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_TRUE(json.at("parameters")[0].at("std").is_null());
  EXPECT_TRUE(json.at("fit").at("rrse").is_null());
  EXPECT_TRUE(std::isnan(from_json(to_json(result), "x").parameters[0].std));
}

TEST(RunToml, LoadsBackAsAConfiguration) {
  Config config;
  config.car.moving_mass_kg = 9700.0;
  const std::string toml = write_run_toml(
      config, {{"a b\".log", "record", 12, std::string(64, 'f')}, {"-", "record", 0, ""}});
  EXPECT_EQ(parse_config(toml, "run.toml").car.moving_mass_kg, 9700.0);
  const Provenance provenance = read_provenance(toml, "run.toml");
  ASSERT_EQ(provenance.inputs.size(), 2U);
  EXPECT_EQ(provenance.inputs[0].name, "a b\".log");
  EXPECT_EQ(provenance.inputs[0].bytes, 12U);
  EXPECT_EQ(provenance.inputs[1].sha256, "");
  EXPECT_EQ(provenance.version, version());
}

TEST(Checksum, IsWhatSha256sumPrints) {
  const fs::path file = fs::path{testing::TempDir()} / "checksum_abc";
  std::ofstream{file} << "abc";
  const InputFile input = describe_input(file, "record");
  EXPECT_EQ(input.bytes, 3U);
  EXPECT_EQ(input.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace dampline::app
