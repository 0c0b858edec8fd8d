// SPDX-License-Identifier: MIT
#include "app/law/noise.hpp"

#include <cmath>

#include "app/law/left_over.hpp"
#include "dampline/numeric/random.hpp"

namespace dampline::app::law {
namespace {

using Eigen::Index, Eigen::VectorXd;

constexpr std::uint64_t kOfForce = 1;  // streams of the seed
constexpr std::uint64_t kOfDeflection = 2;

VectorXd white(Index count, double rms, Random random) {
  VectorXd out{count};
  for (double& value : out) value = rms * random.normal();
  return out;
}

VectorXd force_of(const Input& input) {
  VectorXd out{input.size()};
  for (Index i = 0; i + 1 < input.size(); ++i) out[i] = input.at(i, 0.0);
  out[input.size() - 1] = input.at(input.size() - 2, 1.0);
  return out;
}

}  // namespace

double white_rms(const VectorXd& values) {
  LeftOver spectrum;
  for (const double value : values) spectrum.add(value, value);
  return std::sqrt(spectrum.quietest());
}

Shot follow_own_noise(const LawOf& law_of, const Shot& shot, const std::vector<Drive>& drives,
                      const std::vector<Noise>& noise, std::uint64_t seed) {
  const Law law = law_of(shot.unknowns);
  std::vector<Drive> made = drives;
  for (std::size_t k = 0; k < drives.size(); ++k, ++seed) {
    Drive& d = made[k];
    const Index count = d.input.size();
    const Input felt{force_of(d.input) + white(count, noise[k].force_n, Random{seed, kOfForce}),
                     d.input.interval_s()};
    const State seen{d.deflection_m[0], d.velocity_mps[0]};
    Course course = move(law, felt, k == 0 ? shot.start : seen);
    if (!course.whole) return {};
    d.deflection_m =
        course.deflection_m + white(count, noise[k].deflection_m, Random{seed, kOfDeflection});
    d.velocity_mps = std::move(course.velocity_mps);
  }
  return follow(law_of, shot.unknowns, made, shot.segment_s);
}

}  // namespace dampline::app::law
