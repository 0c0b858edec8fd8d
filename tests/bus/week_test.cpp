// SPDX-License-Identifier: MIT
// What tests/bus/week does for seven days: a car that drives while the link goes,
// the clock steps, nodes restart, frames are lost and doubled, the disk fills, and the program is
// stopped, ended and killed, at moments that a seed draws. The sensors know what they made.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "sim_hw/simulation.hpp"
#include "tests/bus/bus.hpp"
#include "tests/bus/disk.hpp"
#include "tests/bus/live_program.hpp"
#include "tests/bus/sensors.hpp"

namespace dampline::bus {
namespace {

using Seconds = std::chrono::duration<double>;

double number_of(const char* variable, double otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtod(text, nullptr);
}

class TimeTravelNightlyWeek : public testing::Test {
 public:
  static constexpr int kAtOnce = 30;  // instants that are sent together
  TimeTravelNightlyWeek() {
    std::ofstream{folder_ / "car.toml"}
        << "[blackbox]\nrotate_mib = 4\nkeep_mib = 24\nreserve_free_mib = 0\n";
    sensors_.motion = [this] { return simulation_.next().counts; };
    sensors_.batch = kAtOnce;
  }

  [[nodiscard]] std::string run_name() const { return "car.run." + std::to_string(lives_); }

  // A life begins and ends undisturbed, so that nothing is missing where nobody could know.
  void begin_life() {
    ++lives_;
    made_before_ = sensors_.made();
    doubled_ = off_ = unsure_ = 0;
    happened_.clear();
    live_.emplace(folder_, bus_.name(), disk_.path() / run_name(),
                  Words{"--config", folder_ / "car.toml"});
    drive(2.0);
  }
  void drive(double time_s) {
    sensors_.run(Seconds{time_s});
    driven_s_ += time_s;
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random_);
  }

  // How long the link was away is known by the time to the instant, or to the one next to it.
  void link_goes() {
    unsure_ += kChannels;
    const Seconds away{between(0.1, 4.0)};
    std::thread operating{[this, away] {
      bus_.down();
      std::this_thread::sleep_for(away);
      bus_.up();
    }};
    drive(away.count() + 1.0);
    operating.join();
  }
  void clock_steps() {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    now.tv_sec += static_cast<time_t>(between(-7200.0, 7200.0));
    ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &now), 0);
    drive(2.0);
  }
  // What the node did not make while it was off may be taken for lost: no counter tells.
  void node_restarts() {
    const auto instants = static_cast<std::int64_t>(between(3.0, 300.0));
    sensors_.restart_node(random_() % kChannels, instants);
    off_ += static_cast<std::uint64_t>(instants);
    unsure_ += kChannels;
    drive(static_cast<double>(instants) / Sensors::kRateHz + 2.0);
  }
  void frames_go_astray() {
    std::bernoulli_distribution happens{between(0.001, 0.1)};
    sensors_.fate = [&](std::size_t /*channel*/, const CanFrame& frame) -> std::vector<CanFrame> {
      if (happens(random_)) return {};
      if (!happens(random_)) return {frame};
      ++doubled_;
      return {frame, frame};
    };
    drive(between(1.0, 20.0));
    sensors_.fate = {};
  }
  void disk_fills() {
    disk_.fill();
    drive(between(1.0, 40.0));
    disk_.empty();
    drive(7.0);  // until recording goes on
  }
  void program_stops() {
    live_->signal(SIGSTOP);
    drive(between(0.1, 5.0));
    live_->signal(SIGCONT);
  }
  void look_at_memory() {
    memory_kib_.push_back(live_->memory_kib("VmRSS"));
    locked_kib_ = std::max(locked_kib_, live_->memory_kib("VmLck"));
  }

  void end_life() {
    drive(3.0);
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
    look_at_memory();
    const nlohmann::json counts = live_->stop().at("counts");
    const auto count = [&](const char* name) { return counts.at(name).get<std::uint64_t>(); };
    const std::uint64_t made = sensors_.made() - made_before_ + doubled_;
    EXPECT_EQ(count("frames_sent"), count("frames_processed") + count("frames_dropped") +
                                        count("frames_missing") + count("frames_excluded"))
        << counts.dump(1);
    EXPECT_GE(count("frames_sent") + unsure_, made) << "life " << lives_ << ":" << happened_;
    EXPECT_LE(count("frames_sent"), made + off_ + unsure_) << "life " << lives_ << ":" << happened_;
    for (const char* name :
         {"frames_processed", "frames_dropped", "frames_missing", "frames_excluded"})
      sum_[name] += count(name);
    sum_["frames_made"] += made;
    if (HasFailure()) {
      std::printf("%s\n", counts.dump(1).c_str());
      std::ifstream events{live_->run() / "events.csv"};
      for (std::string line; std::getline(events, line);) std::printf("%s\n", line.c_str());
    }
    live_.reset();
    look_at_blackbox();
  }
  void kill_program() {
    drive(3.0);
    live_.reset();  // by SIGKILL
    ++kills_;
    look_at_blackbox();
  }
  void look_at_blackbox() {
    const Words command{DAMPLINE_BINARY_DIR "/dampline", "export",
                        disk_.path() / run_name() / "blackbox", "--out", "/dev/null"};
    const Ended read = Child{command, folder_.path()}.wait();
    EXPECT_EQ(read.status, 0) << read.error;
    EXPECT_THAT(read.error, testing::HasSubstr(" 0 damaged stretches")) << "life " << lives_;
    std::filesystem::remove_all(disk_.path() / run_name());
  }

  std::mt19937 random_{static_cast<std::uint32_t>(number_of("DAMPLINE_WEEK_SEED", 1.0))};
  const Folder folder_;
  const VirtualCan bus_;
  const Disk disk_{folder_ / "disk", "48m"};
  RawSender wire_{bus_.name()};
  Sensors sensors_{wire_};
  sim::Simulation simulation_{sim::reference_run(sim::Load::kLaden, 80.0, 7)};
  std::optional<LiveProgram> live_;
  std::map<std::string, std::uint64_t> sum_;
  std::uint64_t made_before_{0};
  std::uint64_t doubled_{0};
  std::uint64_t off_{0};
  std::uint64_t unsure_{0};
  std::vector<std::uint64_t> memory_kib_;
  std::uint64_t locked_kib_{0};
  std::string happened_;  ///< in this life
  double driven_s_{0.0};
  int lives_{0};
  int kills_{0};
};

TEST_F(TimeTravelNightlyWeek, EveryFrameIsAccountedForWhateverHappens) {
  const double end_s = number_of("DAMPLINE_WEEK_HOURS", 0.02) * 3600.0;  // tests/bus/week: more
  using Act = void (TimeTravelNightlyWeek::*)();
  struct Rule {
    const char* name;
    Act act;
    int times{0};
  };
  std::array rules{Rule{"link", &TimeTravelNightlyWeek::link_goes},
                   Rule{"clock", &TimeTravelNightlyWeek::clock_steps},
                   Rule{"node restarts", &TimeTravelNightlyWeek::node_restarts},
                   Rule{"frames astray", &TimeTravelNightlyWeek::frames_go_astray},
                   Rule{"full disk", &TimeTravelNightlyWeek::disk_fills},
                   Rule{"program stopped", &TimeTravelNightlyWeek::program_stops}};
  while (driven_s_ < end_s && !HasFailure()) {
    begin_life();
    const auto faults = static_cast<int>(between(2.0, 12.0));
    for (int i = 0; i < faults && !HasFailure(); ++i) {
      drive(between(1.0, std::min(600.0, end_s / 60.0)));
      Rule& rule = rules[random_() % rules.size()];
      happened_ += std::string{" "} + rule.name + "@" + std::to_string(driven_s_);
      (this->*rule.act)();
      ++rule.times;
      look_at_memory();
    }
    random_() % 4 == 0 ? kill_program() : end_life();
  }
  std::sort(memory_kib_.begin(), memory_kib_.end());
  const std::uint64_t usual_kib = memory_kib_[memory_kib_.size() / 2];
  EXPECT_LT(usual_kib, 64U * 1024U);
  EXPECT_LT(memory_kib_.back(), 76U * 1024U);  // while it looks for the other truck
  std::printf("week: %.2f h of driving, %d lives, %d of them killed\n", driven_s_ / 3600.0, lives_,
              kills_);
  for (const Rule& rule : rules) std::printf("week: %s %d times\n", rule.name, rule.times);
  for (const auto& [name, count] : sum_)
    std::printf("week: %s %llu\n", name.c_str(), static_cast<unsigned long long>(count));
  std::printf("week: memory %llu KiB, %llu at most; %llu locked\n",
              static_cast<unsigned long long>(usual_kib),
              static_cast<unsigned long long>(memory_kib_.back()),
              static_cast<unsigned long long>(locked_kib_));
}

}  // namespace
}  // namespace dampline::bus
