// SPDX-License-Identifier: MIT
// The systemd unit, judged by systemd's own tools; none of them needs a running manager.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "tests/service/shell.hpp"

namespace dampline::service {
namespace {

constexpr double kMostExposure = 3.0;

std::string unit() { return text_of(DAMPLINE_BINARY_DIR "/app/service/dampline@.service"); }

/// An instance, so that the tools need not guess one; `text` takes the template's place.
std::string write_instance(const Folder& folder, const std::string& text) {
  const std::filesystem::path path = folder.path() / "dampline@can0.service";
  std::ofstream{path} << text;
  return quoted(path);
}

/// Absent figure: 10, the worst.
double exposure(const std::string& file) {
  const Ended ended =
      shell("systemd-analyze security --offline=true --no-pager --threshold=30 " + file);
  EXPECT_EQ(ended.status, 0) << ended.output;
  std::smatch found;
  const std::regex figure{"Overall exposure level for [^:]*: ([0-9.]+)"};
  return std::regex_search(ended.output, found, figure) ? std::stod(found[1]) : 10.0;
}

TEST(Unit, IsWellConfined) {
  if (!has_program("systemd-analyze")) GTEST_SKIP() << "systemd-analyze is not installed";
  const Folder folder;
  const double level = exposure(write_instance(folder, unit()));
  EXPECT_LT(level, kMostExposure);
  RecordProperty("exposure", std::to_string(level));
}

TEST(Unit, WouldBeExposedWithoutItsConfinement) {  // the figure above can be too high
  if (!has_program("systemd-analyze")) GTEST_SKIP() << "systemd-analyze is not installed";
  const Folder folder;
  const std::string bare = "[Service]\nExecStart=/bin/true\n";
  const Ended ended = shell("systemd-analyze security --offline=true --no-pager --threshold=30 " +
                            write_instance(folder, bare));
  EXPECT_NE(ended.status, 0) << ended.output;
}

TEST(Unit, IsRightInTheEyesOfSystemd) {
  if (!has_program("systemd-analyze")) GTEST_SKIP() << "systemd-analyze is not installed";
  const Folder folder;
  // The program is where it was built.
  const std::string here = std::regex_replace(unit(), std::regex{"ExecStart=[^ ]*"},
                                              "ExecStart=" DAMPLINE_BINARY_DIR "/dampline");
  const Ended verify = shell("systemd-analyze verify --man=no " + write_instance(folder, here) +
                             " 2>&1 | grep dampline");
  EXPECT_EQ(verify.output, "") << "nothing is said of a unit that is right";
  const Ended wrong =
      shell("systemd-analyze verify --man=no " +
            write_instance(folder, here + "\n[Service]\nWatchdog=5\n") + " 2>&1 | grep dampline");
  EXPECT_NE(wrong.output, "") << "and something of one that is not";
}

TEST(Unit, WithWhatOpensTheNetworkIsRightAndStillWellConfined) {
  if (!has_program("systemd-analyze")) GTEST_SKIP() << "systemd-analyze is not installed";
  const Folder folder;
  const std::string here = std::regex_replace(unit(), std::regex{"ExecStart=[^ ]*"},
                                              "ExecStart=" DAMPLINE_BINARY_DIR "/dampline");
  for (const char* const drop_in : {"/app/service/serve.conf", "/app/service/mqtt.conf"}) {
    const std::string opened = here + "\n" + text_of(std::string{DAMPLINE_SOURCE_DIR} + drop_in);
    const Ended verify = shell("systemd-analyze verify --man=no " + write_instance(folder, opened) +
                               " 2>&1 | grep dampline");
    EXPECT_EQ(verify.output, "") << drop_in;
    EXPECT_LT(exposure(write_instance(folder, opened)), kMostExposure) << drop_in;
  }
  EXPECT_EQ(unit().find("AF_INET"), std::string::npos) << "what nobody asked for is closed";
}

TEST(Unit, OfTheForwarderIsRightAndWellConfined) {
  if (!has_program("systemd-analyze")) GTEST_SKIP() << "systemd-analyze is not installed";
  const Folder folder;
  const std::string text = std::regex_replace(
      text_of(DAMPLINE_SOURCE_DIR "/app/service/nats/dampline-forward.service"),
      std::regex{"\nExecStart=[^ ]*"}, "\nExecStart=" DAMPLINE_BINARY_DIR "/dampline");
  const std::string file = write_instance(folder, text);
  EXPECT_EQ(shell("systemd-analyze verify --man=no " + file + " 2>&1 | grep dampline").output, "");
  EXPECT_LT(exposure(file), kMostExposure);
  const Ended help = shell("'" DAMPLINE_BINARY_DIR "/dampline' forward --help");
  for (const char* const flag : {"--nats", "--ca", "--cert", "--key"})
    EXPECT_NE(help.output.find(flag), std::string::npos) << flag;
}

TEST(Unit, StartsWhatTheProgramUnderstands) {
  std::smatch found;
  const std::string text = unit();
  ASSERT_TRUE(std::regex_search(text, found, std::regex{"ExecStart=[^ ]* identify (.*)"}));
  const std::string arguments = found[1];
  const Ended help = shell("'" DAMPLINE_BINARY_DIR "/dampline' identify --help");
  const std::regex flag{"--[a-z-]+"};
  for (std::sregex_iterator it{arguments.begin(), arguments.end(), flag};
       it != std::sregex_iterator{}; ++it) {
    EXPECT_NE(help.output.find(it->str()), std::string::npos) << it->str();
  }
}

/// What the program's own promises rest on.
TEST(Unit, GivesWhatTheProgramNeeds) {
  const std::string text = unit();
  for (const char* const line :
       {"Type=notify", "NotifyAccess=main", "WatchdogSec=20", "Restart=on-failure",
        "RestartPreventExitStatus=2", "LimitRTPRIO=60", "LimitMEMLOCK=infinity",
        "StateDirectory=dampline", "KillSignal=SIGTERM", "ExecReload=/bin/kill -HUP $MAINPID",
        "RestrictAddressFamilies=AF_UNIX AF_CAN AF_NETLINK", "DeviceAllow=char-gpiochip rw",
        "CapabilityBoundingSet=\n"}) {
    EXPECT_NE(text.find(std::string{"\n"} + line), std::string::npos) << line;
  }
  for (const char* const hurts :
       {"\nPrivateNetwork=", "\nPrivateDevices=", "\nRestrictRealtime="}) {
    EXPECT_EQ(text.find(hurts), std::string::npos) << hurts;
  }
}

TEST(Unit, HasItsUser) {
  if (!has_program("systemd-sysusers")) GTEST_SKIP() << "systemd-sysusers is not installed";
  const Folder folder;
  std::filesystem::create_directories(folder.path() / "etc");
  const Ended made = shell("systemd-sysusers --root=" + quoted(folder.path()) +
                           " '" DAMPLINE_SOURCE_DIR "/app/service/dampline.sysusers'");
  ASSERT_EQ(made.status, 0) << made.output;
  EXPECT_NE(text_of(folder.path() / "etc/passwd").find("dampline:"), std::string::npos);
  EXPECT_NE(text_of(folder.path() / "etc/group").find("dampline:"), std::string::npos);
}

}  // namespace
}  // namespace dampline::service
