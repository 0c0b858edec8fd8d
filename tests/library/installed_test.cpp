// SPDX-License-Identifier: MIT
// The core as other projects get it: installed, found by CMake and by pkg-config, used from C++ and
// from C, with the figures of the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <regex>
#include <string>
#include <vector>

#include "tests/service/shell.hpp"

namespace dampline::library {
namespace {

namespace fs = std::filesystem;
using service::Folder;
using service::quoted;
using service::shell;

const fs::path kExamples{DAMPLINE_SOURCE_DIR "/firmware_core/examples"};

/// Every number of four digits or more: level, stiffness and the stiffness's deviation.
std::vector<long long> figures_of(const std::string& text) {
  std::vector<long long> out;
  const std::regex number{"[0-9]{4,}"};
  for (std::sregex_iterator it{text.begin(), text.end(), number}; it != std::sregex_iterator{};
       ++it)
    out.push_back(std::stoll(it->str()));
  return out;
}

/// The same of what the program wrote, rounded as the examples print it.
std::vector<long long> figures_of_run(const fs::path& run) {
  const std::string text = service::text_of(run / "parameters.json");
  const auto number = [&](const std::string& name, const std::string& key) {
    std::smatch found;
    const std::regex pattern{"\"name\": \"" + name + "\"[^}]*\"" + key + "\": ([-0-9.e+]+)"};
    EXPECT_TRUE(std::regex_search(text, found, pattern)) << name << ' ' << key;
    return found.empty() ? 0 : std::llround(std::stod(found[1]));
  };
  return {number("coulomb", "value"), number("stiffness", "value"), number("stiffness", "std")};
}

class InstalledCore : public testing::Test {
 protected:
  static void expect_success(const std::string& command) {
    const service::Ended ended = shell(command);
    ASSERT_EQ(ended.status, 0) << command << '\n' << ended.output;
  }
  /// The ride has spikes in all channels: the guards' part in the figures is compared too.
  void SetUp() override {
    expect_success("'" DAMPLINE_CMAKE "' --install '" DAMPLINE_BINARY_DIR
                   "' --component core --prefix " +
                   quoted(prefix_));
    expect_success("cd " + quoted(folder_.path()) +
                   " && '" DAMPLINE_BINARY_DIR
                   "/dampline' simulate --duration 60 --seed 1 --quiet --out clean.log --dbc s.dbc"
                   " --config-out ride.toml && sed -E '6000~3001s/#..(.)./#FF\\13/' clean.log"
                   " >ride.log && '" DAMPLINE_BINARY_DIR
                   "/dampline' identify ride.log --config ride.toml --no-report --out run");
  }
  void expect_figures_of_the_program(const fs::path& program) {
    const service::Ended ended =
        shell(quoted(program) + " <" + quoted(folder_.path() / "ride.log"));
    EXPECT_EQ(ended.status, 0) << ended.output;
    EXPECT_EQ(figures_of(ended.output), figures_of_run(folder_.path() / "run")) << ended.output;
  }
  /// Compiles and links by what pkg-config says of a package.
  void build(const std::string& compiler, const std::string& example, const std::string& package) {
    const std::string out = quoted(folder_.path() / example) + ".out";
    expect_success("export PKG_CONFIG_PATH=\"$(dirname \"$(find " + quoted(prefix_) +
                   " -name dampline.pc)\")\"; " + compiler + " -O2 " + quoted(kExamples / example) +
                   " -o " + out + " $(pkg-config --cflags --libs " + package + ")");
  }

  Folder folder_;
  fs::path prefix_{folder_.path() / "prefix"};
};

TEST_F(InstalledCore, IsFoundByCMakeFromCxxAndC) {
  const fs::path out = folder_.path() / "build";
  expect_success(
      "'" DAMPLINE_CMAKE "' -G Ninja -S " + quoted(kExamples) + " -B " + quoted(out) +
      " -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER='" DAMPLINE_CXX "' -DCMAKE_PREFIX_PATH=" +
      quoted(prefix_) + " && '" DAMPLINE_CMAKE "' --build " + quoted(out) + " --verbose");
  expect_figures_of_the_program(out / "embed");
  expect_figures_of_the_program(out / "embed_c");
}

TEST_F(InstalledCore, IsFoundByPkgConfigFromCxxAndC) {
  if (!service::has_program("pkg-config")) GTEST_SKIP() << "pkg-config is not installed";
  build("'" DAMPLINE_CXX "'", "embed.cpp", "dampline");
  expect_figures_of_the_program(folder_.path() / "embed.cpp.out");
  build("cc -std=c99 -Wall -Wextra -pedantic -Werror", "embed.c", "dampline-c");
  expect_figures_of_the_program(folder_.path() / "embed.c.out");
}

TEST_F(InstalledCore, NamesNoFolderOfTheBuild) {
  const service::Ended found =
      shell("grep -rlF -e '" DAMPLINE_SOURCE_DIR "' -e '" DAMPLINE_BINARY_DIR "' " +
            quoted(prefix_) + " --include=*.cmake --include=*.pc --include=*.hpp --include=*.h");
  EXPECT_EQ(found.output, "");
}

class BareSystem : public testing::Test {
 protected:
  /// Configures a project where Eigen is all that can be found.
  void expect_configures(const fs::path& project, const std::string& options) {
    std::string command = "'" DAMPLINE_CMAKE "' -G Ninja -S " + quoted(project) + " -B " +
                          quoted(folder_.path() / "build") + " " + options;
    for (const char* const absent :
         {"CLI11", "tomlplusplus", "nlohmann_json", "fmt", "PkgConfig", "GTest", "benchmark"})
      command += std::string{" -DCMAKE_DISABLE_FIND_PACKAGE_"} + absent + "=ON";
    const service::Ended ended = shell(command);
    EXPECT_EQ(ended.status, 0) << ended.output;
  }
  Folder folder_;
};

TEST_F(BareSystem, ConfiguresTheCore) {
  expect_configures(DAMPLINE_SOURCE_DIR "/firmware_core", "");
}

TEST_F(BareSystem, ConfiguresTheRepositoryWithoutTheProgram) {
  expect_configures(DAMPLINE_SOURCE_DIR, "-DDAMPLINE_PROGRAM=OFF");
}

TEST_F(BareSystem, CompilesForAProjectThatHasTheRepositoryBelowIt) {
  const fs::path project = folder_.path() / "project";
  fs::create_directories(project);
  std::ofstream{project / "CMakeLists.txt"}
      << "cmake_minimum_required(VERSION 3.25)\nproject(other LANGUAGES C CXX)\n"
         "add_subdirectory(\"" DAMPLINE_SOURCE_DIR
         "\" dampline)\n"
         "add_library(other OBJECT \"" DAMPLINE_SOURCE_DIR
         "/firmware_core/examples/embed.cpp\" \"" DAMPLINE_SOURCE_DIR
         "/firmware_core/examples/embed.c\")\n"
         "target_link_libraries(other dampline::core)\n"
         "get_target_property(flags dampline::core INTERFACE_COMPILE_OPTIONS)\n"
         "get_target_property(features dampline::core INTERFACE_COMPILE_FEATURES)\n"
         "if(NOT flags MATCHES -ffp-contract=off OR NOT features MATCHES cxx_std_20)\n"
         "  message(FATAL_ERROR \"lost: ${flags} ${features}\")\nendif()\n";
  expect_configures(project, "");
  const service::Ended built =
      shell("'" DAMPLINE_CMAKE "' --build " + quoted(folder_.path() / "build") + " --target other");
  EXPECT_EQ(built.status, 0) << built.output;
}

}  // namespace
}  // namespace dampline::library
