// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/service/shell.hpp"

namespace dampline::service {
namespace {

const std::filesystem::path kSource{DAMPLINE_SOURCE_DIR};

TEST(Install, PutsEverythingInPlaceAndItRuns) {
  const Folder folder;
  const Ended install = shell("DESTDIR='" + folder.path().string() +
                              "' '" DAMPLINE_CMAKE "' --install '" DAMPLINE_BINARY_DIR "'");
  ASSERT_EQ(install.status, 0) << install.output;
  const std::filesystem::path root = folder.path().string() + DAMPLINE_INSTALL_PREFIX;
  for (const char* const file :
       {"bin/dampline", "share/man/man1/dampline.1.gz", "lib/systemd/system/dampline@.service",
        "lib/sysusers.d/dampline.conf", "share/dampline/dampline_sensors.dbc",
        "share/dampline/dampline.schema.json", "share/dampline/dampline.py",
        "share/dampline/loadrun.m", "share/doc/dampline/README.md", "share/doc/dampline/can0.toml",
        "share/doc/dampline/80-can0.network", "share/doc/dampline/90-dampline.rules",
        "share/doc/dampline/90-dampline.sysctl", "share/doc/dampline/copyright",
        "share/doc/dampline/examples/emps.toml", "share/bash-completion/completions/dampline",
        "share/zsh/vendor-completions/_dampline"}) {
    EXPECT_TRUE(std::filesystem::exists(root / file)) << file;
  }
  const std::string program = quoted(root / "bin/dampline");
  const Ended version = shell(program + " --version");
  EXPECT_EQ(version.status, 0) << version.output;
  EXPECT_TRUE(version.output.starts_with("dampline ")) << version.output;
  const Ended run = shell("cd " + quoted(folder.path()) + " && " + program +
                          " simulate --duration 20 --quiet --out run.log && " + program +
                          " identify run.log --no-report --out run");
  EXPECT_EQ(run.status, 0) << run.output;
  const std::string unit = text_of(root / "lib/systemd/system/dampline@.service");
  EXPECT_NE(unit.find("ExecStart=" DAMPLINE_INSTALL_PREFIX "/bin/dampline identify %i "),
            std::string::npos);
  EXPECT_EQ(unit.find("@bindir"), std::string::npos) << "a name was not filled in";
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "etc")) << "a configuration is not replaced";
}

TEST(Samples, TheConfigurationIsRight) {
  const Ended check = shell("'" DAMPLINE_BINARY_DIR "/dampline' config check " +
                            quoted(kSource / "app/service/can0.toml"));
  EXPECT_EQ(check.status, 0) << check.output;
}

TEST(Samples, TheConfigurationHasAnEstimateAfterAMinute) {
  const Folder folder;
  const Ended run =
      shell("cd " + quoted(folder.path()) +
            " && '" DAMPLINE_BINARY_DIR
            "/dampline' simulate --duration 60 --quiet --out run.log && "
            "'" DAMPLINE_BINARY_DIR "/dampline' identify run.log --no-report --config " +
            quoted(kSource / "app/service/can0.toml"));
  EXPECT_EQ(run.status, 0) << run.output;
}

TEST(Samples, TheConfigurationIsRightWithItsExamplesToo) {
  const Folder folder;
  const std::filesystem::path all = folder.path() / "can0.toml";
  // What is commented out is KEY = VALUE behind one # and a space.
  const Ended edit =
      shell("sed 's/^# \\([a-z0-9_]* = \\)/\\1/' " + quoted(kSource / "app/service/can0.toml") +
            " >" + quoted(all) + " && cp " + quoted(kSource / "sim_hw/dbc/dampline_sensors.dbc") +
            " " + quoted(folder.path() / "sensors.dbc"));
  ASSERT_EQ(edit.status, 0) << edit.output;
  const Ended check = shell("'" DAMPLINE_BINARY_DIR "/dampline' config check " + quoted(all));
  EXPECT_EQ(check.status, 0) << check.output;
  EXPECT_NE(text_of(all).find("\nlamp = "), std::string::npos);
}

}  // namespace
}  // namespace dampline::service
