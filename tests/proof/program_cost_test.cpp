// SPDX-License-Identifier: MIT
// What the program as a whole costs per sample of a candump log: the difference between a short and
// a long log, all threads together. Valgrind offers no SHA instructions, so the checksum of the
// input is that of a processor without them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <ostream>
#include <string>
#include <string_view>

#include "tests/proof/command.hpp"
#include "tests/proof/counts.hpp"
#include "tests/proof/profile.hpp"

namespace dampline::proof {
namespace {

namespace fs = std::filesystem;

struct Verb {
  const char* name;
  std::int64_t short_s;
  std::int64_t long_s;
};
void PrintTo(const Verb& verb, std::ostream* stream) { *stream << verb.name; }

// The shortest that can be explained; identify is cheap, so its report weighs more, and reads the
// first two minutes once more.
constexpr std::array<Verb, 2> kVerbs{{{"identify", 150, 270}, {"explain", 60, 90}}};
constexpr std::int64_t kRateHz = 300;

void run(const std::string& command) {
  const CommandResult result = run_command(command + " 2>&1");
  ASSERT_EQ(result.status, 0) << command << '\n' << result.output;
}

Profile profile_log(const Verb& verb, std::int64_t seconds, const std::string& folder) {
  const std::string log = fmt::format("{}/{}", folder, seconds);
  run(fmt::format(
      "{} simulate --quiet --force --seed 1 --duration {} --out {}.log --config-out {}.toml",
      DAMPLINE_PROGRAM, seconds, log, log));
  return profile_of(fmt::format("{} {} {}.log --config {}.toml --out {}.run --no-report",
                                DAMPLINE_PROGRAM, verb.name, log, log, log),
                    log + ".profile");
}

/// What the samples cost that only the long log has. A function of the report may cost less there;
/// what these functions are less by is taken from the small ones, so that the sum is right.
Profile difference(const Profile& brief, const Profile& extended) {
  Profile out;
  for (const auto& [name, count] : extended) {
    const auto before = brief.find(name);
    const std::uint64_t less = before == brief.end() ? 0 : before->second;
    if (count > less) out[name] = count - less;
  }
  const std::uint64_t wanted = total_of(extended) - total_of(brief);
  std::uint64_t excess = total_of(out) - wanted;
  for (auto& [name, count] : out) {
    if (count * 1000 > wanted) continue;
    const std::uint64_t taken = std::min(count, excess);
    count -= taken;
    excess -= taken;
  }
  return out;
}

/// Instructions of functions whose names hold one of these.
double per_sample(const Profile& profile, std::initializer_list<std::string_view> parts,
                  std::int64_t samples) {
  std::uint64_t sum = 0;
  for (const auto& [name, count] : profile) {
    const bool counts = std::any_of(parts.begin(), parts.end(), [&name = name](auto part) {
      return name.find(part) != std::string::npos;
    });
    if (counts) sum += count;
  }
  return static_cast<double>(sum) / static_cast<double>(samples);
}

class ProgramCost : public testing::TestWithParam<Verb> {};

TEST_P(ProgramCost, IsWhatWasCommitted) {
  if (const auto why = why_not_counted()) GTEST_SKIP() << *why;
  const Verb verb = GetParam();
  const std::string folder =
      fmt::format("{}/proof/program_cost_{}", DAMPLINE_BINARY_DIR, verb.name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  const Profile brief = profile_log(verb, verb.short_s, folder);
  const Profile extended = profile_log(verb, verb.long_s, folder);
  fs::remove_all(folder);
  ASSERT_GT(total_of(extended), total_of(brief));

  const Profile samples = difference(brief, extended);
  const std::int64_t count = (verb.long_s - verb.short_s) * kRateHz;
  const double whole = static_cast<double>(total_of(samples)) / static_cast<double>(count);
  const double checksum = per_sample(samples, {"sha256"}, count);
  const double decode = per_sample(
      samples, {"Candump", "LineReader", "memchr", "ChannelLane", "SampleAssembler"}, count);
  fmt::print("program_{}: decode {:.0f}, SHA-256 {:.0f}, the rest {:.0f}\n", verb.name, decode,
             checksum, whole - decode - checksum);
  fmt::print(
      "program_{}: {:.1f} million instructions beside its samples: start-up and report, less "
      "what the first samples do not cost yet\n",
      verb.name,
      1e-6 * static_cast<double>(total_of(brief)) -
          1e-6 * whole * static_cast<double>(verb.short_s * kRateHz));
  EXPECT_GT(checksum, 3'000.0) << "SHA-256 has another name now";
  EXPECT_GT(decode, 1'000.0) << "decoding has other names now";
  check_counts(std::string{"program_"} + verb.name, samples, count);
}

INSTANTIATE_TEST_SUITE_P(Verbs, ProgramCost, testing::ValuesIn(kVerbs),
                         [](const auto& verb) { return std::string{verb.param.name}; });

}  // namespace
}  // namespace dampline::proof
