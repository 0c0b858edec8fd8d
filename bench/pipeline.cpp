// SPDX-License-Identifier: MIT
// Parts of a replay, for bench/replay.cpp to time: `pipeline frames|samples|job LOG [CONFIG]`.
// frames: every line of a candump log as a frame, as canplayer parses it. samples: decoded and
// assembled too. job: what bench/peers/pipeline.py does, by the core's classes: motion,
// histograms, rows of windows, one solution.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/record/frames.hpp"
#include "dampline/basis/columns.hpp"
#include "dampline/density/histogram.hpp"
#include "dampline/density/joint_histogram.hpp"
#include "dampline/motion/drift_free_integral.hpp"
#include "dampline/sample/assembler.hpp"
#include "dampline/wavelet/row_builder.hpp"
#include "drivers/candump/source.hpp"

namespace dampline::bench {
namespace {

constexpr double kRateHz = 300.0;
constexpr double kMassKg = 37200.0;
constexpr double kLargestVelocityMps = 0.05;
constexpr double kLargestDeflectionM = 2e-3;

/// What pipeline.py calculates from samples.
class Job {
 public:
  void take(const Sample& sample) noexcept {
    const auto& a = sample.accel_mps2;
    const double relative_mps2 = 2.0 * a[0] - a[1] - a[2];
    const std::int64_t n = count_++;
    rows_.set_accelerations(n, a[0], relative_mps2);
    double velocity_mps = 0.0;
    if (velocity_.update(relative_mps2, velocity_mps))
      take_velocity(n - velocity_.delay(), velocity_mps);
  }

  void print() const {
    // One width of the law, the ramps, stiffness, viscous; and the target.
    constexpr std::array<int, kColumns> kChosen{4, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20};
    Eigen::Matrix<double, kRowColumns, kColumns> map =
        Eigen::Matrix<double, kRowColumns, kColumns>::Zero();
    for (int i = 0; i < kColumns; ++i) map(kChosen[static_cast<std::size_t>(i)], i) = 1.0;
    Information<kColumns> chosen;
    total_.add_mapped(map, 1.0, chosen);
    Information<kColumns>::Vector answer = Information<kColumns>::Vector::Zero();
    const bool solved = chosen.solve(answer);
    fmt::print("coulomb {:.0f} N, stiffness {:.4g} N/m, {} and {} counted\n",
               solved ? kMassKg * answer[0] : std::nan(""), kMassKg * answer[kColumns - 3],
               density_.samples(), joint_.samples());
  }

 private:
  static constexpr int kColumns = 12;
  static constexpr std::size_t kRing = 2048;
  static constexpr std::size_t kPanel = 8;
  struct Panel {
    RowFactor::Panel<kPanel> rows{};
    std::size_t count{0};
  };

  void take_velocity(std::int64_t n, double velocity_mps) noexcept {
    if (first_ < 0) first_ = n;
    velocities_mps_[static_cast<std::size_t>(n) % kRing] = velocity_mps;
    density_.update(velocity_mps);
    double deflection_m = 0.0;
    if (deflection_.update(velocity_mps, deflection_m)) {
      const std::int64_t then = n - deflection_.delay();
      joint_.update(deflection_m, velocities_mps_[static_cast<std::size_t>(then) % kRing]);
    }
    rows_.set_law(n, law_.lanes(velocity_mps), false);
    for (std::size_t s = 0; s < kScales; ++s) {
      const std::int64_t half = rows_.bank().half(s);
      if ((n - first_) % rows_.bank().stride(s) == 0 && n - 2 * half >= first_) {
        panel_.rows.set(panel_.count, rows_.row(s, n - half));
        if (++panel_.count < kPanel) continue;
        total_.absorb_panel(panel_.rows);
        panel_.count = 0;
      }
    }
  }

  DriftFreeIntegral velocity_{kRateHz};
  DriftFreeIntegral deflection_{kRateHz};
  LawColumns law_{kDefaultCurveNodesMps};
  RowBuilder rows_{kRateHz};
  Histogram<64> density_{{.range = {.low = -kLargestVelocityMps, .high = kLargestVelocityMps}}};
  JointHistogram<32, 32> joint_{{.x = {.low = -kLargestDeflectionM, .high = kLargestDeflectionM},
                                 .y = {.low = -kLargestVelocityMps, .high = kLargestVelocityMps}}};
  Panel panel_;
  RowFactor total_{};
  std::array<double, kRing> velocities_mps_{};
  std::int64_t count_{0};
  std::int64_t first_{-1};
};

/// Calls `take` with every frame of the log; false where it cannot be read.
template <class Take>
bool read_frames(const std::string& path, Take take) {
  auto source = drivers::CandumpSource::open({.path = path});
  if (!source.ok()) return false;
  std::array<CanFrame, 256> frames;
  auto count = source.value()->read(frames);
  for (; count.ok(); count = source.value()->read(frames))
    for (std::size_t i = 0; i < count.value(); ++i) take(frames[i]);
  return count.error() == Errc::kEndOfStream;
}

template <class Take>
bool read_samples(const std::string& path, const std::string& config, Take take) {
  const auto assembler =
      std::make_unique<SampleAssembler>(app::can_channels(app::load_config(config)));
  Sample sample;
  const auto ready = [&] {
    while (assembler->pop(sample)) take(sample);
  };
  const bool read = read_frames(path, [&](const CanFrame& frame) {
    assembler->push(frame);
    ready();
  });
  assembler->flush();
  ready();
  return read;
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 2 || (words[0] != "frames" && words.size() < 3)) {
    fmt::print("usage: pipeline frames LOG | samples LOG CONFIG | job LOG CONFIG\n");
    return 2;
  }
  std::uint64_t count = 0;
  if (words[0] == "frames") {
    const bool read = read_frames(words[1], [&](const CanFrame& frame) { count += frame.length; });
    fmt::print("{} bytes of payload\n", count);
    return read ? 0 : 1;
  }
  if (words[0] == "samples") {
    double sum_mps2 = 0.0;
    const bool read = read_samples(words[1], words[2], [&](const Sample& sample) {
      ++count;
      for (const double accel_mps2 : sample.accel_mps2) sum_mps2 += accel_mps2;
    });
    fmt::print("{} samples, sum {:.6g} m/s^2\n", count, sum_mps2);
    return read ? 0 : 1;
  }
  const auto job = std::make_unique<Job>();
  const bool read =
      read_samples(words[1], words[2], [&](const Sample& sample) { job->take(sample); });
  job->print();
  return read ? 0 : 1;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run({argv + 1, argv + argc}); }
