// SPDX-License-Identifier: MIT
// The Debian package that cpack makes of this build. app/package/check installs it, with lintian,
// in a bare system; here is what needs no more than dpkg.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/service/shell.hpp"

namespace dampline::service {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

class Package : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_program("dpkg-shlibdeps") || !has_program("dpkg-deb"))
      GTEST_SKIP() << "dpkg-dev is not installed";
    const Ended made = shell("cpack --config '" DAMPLINE_BINARY_DIR "/CPackConfig.cmake' -B " +
                             quoted(folder_.path()) + " && mv " + quoted(folder_.path()) +
                             "/*.deb " + quoted(deb_));
    ASSERT_EQ(made.status, 0) << made.output;
  }
  [[nodiscard]] std::string field(const std::string& name) const {
    return shell("dpkg-deb -f " + quoted(deb_) + " " + name).output;
  }
  Folder folder_;
  std::filesystem::path deb_{folder_.path() / "package.deb"};
};

TEST_F(Package, HoldsWhatAServiceNeedsAndItRuns) {
  EXPECT_EQ(field("Package"), "dampline\n");
  EXPECT_THAT(field("Version"),
              MatchesRegex("0\\.1\\.0(~git[0-9]{8}\\.[0-9]{6}\\.[0-9a-f]+)?-1\n"));
  EXPECT_THAT(field("Depends"), HasSubstr("libfmt9"));
  EXPECT_THAT(field("Depends"), Not(HasSubstr("gnuplot")));
  const std::filesystem::path root = folder_.path() / "root";
  const Ended opened = shell("dpkg-deb -R " + quoted(deb_) + " " + quoted(root));
  ASSERT_EQ(opened.status, 0) << opened.output;
  EXPECT_EQ(text_of(root / "DEBIAN/conffiles"), "/etc/dampline/can0.toml\n");
  EXPECT_THAT(text_of(root / "usr/lib/systemd/system/dampline@.service"),
              HasSubstr("ExecStart=/usr/bin/dampline identify %i "));
  for (const char* const file :
       {"DEBIAN/postinst", "DEBIAN/prerm", "DEBIAN/postrm", "etc/dampline/can0.toml",
        "usr/libexec/dampline/dampline-verify", "usr/lib/sysusers.d/dampline.conf",
        "usr/share/doc/dampline/changelog.Debian.gz", "usr/share/doc/dampline/copyright"})
    EXPECT_TRUE(std::filesystem::exists(root / file)) << file;
  EXPECT_FALSE(std::filesystem::exists(root / "usr/include")) << "no part of the package";
  const Ended check = shell(quoted(root / "usr/bin/dampline") + " config check " +
                            quoted(root / "etc/dampline/can0.toml"));
  EXPECT_EQ(check.status, 0) << check.output;
}

}  // namespace
}  // namespace dampline::service
