// SPDX-License-Identifier: MIT
#include "dampline/density/drift_fit.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "dampline/numeric/cholesky.hpp"

namespace dampline {
namespace {

constexpr int kMaxUnknowns = 2 * (static_cast<int>(kCurveSegments) + 1);
constexpr int kMaxTests = 2 * static_cast<int>(DriftBins::kPerSide) + 1;
constexpr double kMinShare = 0.01;  // of the samples, beyond a segment's left end on one side
constexpr double kMinSamples = 60.0;
constexpr double kBend = 0.1;  // of the level: how far a node is from its neighbours' line

/// A function that is linear in u within a bin: at u = 0, and per u.
struct Line {
  int index;
  double base, slope;
};
using Lines = std::array<Line, 2>;

double product(const Line& f, const Line& g, const DriftMoments& m) noexcept {
  return f.base * g.base * m.n + (f.base * g.slope + f.slope * g.base) * m.u +
         f.slope * g.slope * m.uu;
}

/// The two hats of the broken line that are not zero in a bin. Bins 0 and 1 halve segment 1.
Lines curve_lines(std::size_t side, std::size_t bin, std::size_t segments) noexcept {
  const int node = static_cast<int>(side * (segments + 1) + (bin > 0 ? bin - 1 : 0));
  if (bin == 0) return {{{node, 1.0, -0.5}, {node + 1, 0.0, 0.5}}};
  if (bin == 1) return {{{node, 0.5, -0.5}, {node + 1, 0.5, 0.5}}};
  return {{{node, 1.0, -1.0}, {node + 1, 0.0, 1.0}}};
}

/// The two test functions of a bin: continuous, so that zero has one hat for both sides.
Lines test_lines(std::size_t side, std::size_t bin, std::size_t segments) noexcept {
  const int right = static_cast<int>(1 + side * (segments + 1) + bin);
  return {{{bin == 0 ? 0 : right - 1, 1.0, -1.0}, {right, 0.0, 1.0}}};
}

/// What lies in bins beyond the last segment, as seen from the last segment's bin.
DriftSums folded(const DriftSums& sums, const DriftBins& bins, std::size_t segments) noexcept {
  DriftSums out = sums;
  const auto& nodes = bins.nodes_mps();
  const double width = nodes[segments + 1] - nodes[segments];
  for (auto& side : out.sides) {
    for (std::size_t b = segments + 1; b < DriftBins::kPerSide; ++b) {
      const double c = (nodes[b] - nodes[segments]) / width;
      const double d = (nodes[b + 1] - nodes[b]) / width;
      const DriftMoments& m = side[b];
      side[segments].add({.n = m.n,
                          .u = c * m.n + d * m.u,
                          .uu = c * c * m.n + 2.0 * c * d * m.u + d * d * m.uu,
                          .y = m.y,
                          .uy = c * m.y + d * m.uy,
                          .a = m.a,
                          .ua = c * m.a + d * m.ua},
                         1.0);
      side[b] = {};
    }
  }
  return out;
}

/// The equations design * alpha = right, with the information `weight^-1` of their errors.
struct Equations {
  Eigen::Matrix<double, kMaxTests, kMaxUnknowns> design =
      Eigen::Matrix<double, kMaxTests, kMaxUnknowns>::Zero();
  Eigen::Matrix<double, kMaxTests, 1> right = Eigen::Matrix<double, kMaxTests, 1>::Zero();
  Eigen::Matrix<double, kMaxTests, kMaxTests> weight =
      Eigen::Matrix<double, kMaxTests, kMaxTests>::Zero();
};

/// Normal equations of the unknowns, and their solution.
struct Normal {
  using Matrix = Cholesky<kMaxUnknowns>::Matrix;
  using Vector = Cholesky<kMaxUnknowns>::Vector;
  Matrix matrix = Matrix::Zero();
  Vector right = Vector::Zero();
};

/// +1 for the unknowns of v >= 0, -1 for those of v < 0.
double sign_of(int unknown, int unknowns) noexcept { return 2 * unknown < unknowns ? -1.0 : 1.0; }

/// Level and offset: alpha = level sign(v) + offset put into the normal equations.
bool solve_level(const Normal& normal, int unknowns, DriftFit& fit) noexcept {
  double ss = 0.0;
  double s1 = 0.0;
  double one = 0.0;
  double rs = 0.0;
  double r1 = 0.0;
  for (int i = 0; i < unknowns; ++i) {
    const double si = sign_of(i, unknowns);
    rs += si * normal.right[i];
    r1 += normal.right[i];
    for (int j = 0; j < unknowns; ++j) {
      const double n = normal.matrix(i, j);
      ss += si * n * sign_of(j, unknowns);
      s1 += si * n;
      one += n;
    }
  }
  const double determinant = ss * one - s1 * s1;
  if (!(determinant > 0.0)) return false;
  fit.level_mps2 = (one * rs - s1 * r1) / determinant;
  fit.offset_mps2 = (ss * r1 - s1 * rs) / determinant;
  return true;
}

bool solve_curve(const Normal& normal, std::size_t segments, DriftFit& fit) noexcept {
  const int unknowns = 2 * (static_cast<int>(segments) + 1);
  Cholesky<kMaxUnknowns> cholesky;
  if (!cholesky.factor(normal.matrix, unknowns)) return false;
  Normal::Vector alpha = normal.right;
  cholesky.solve(alpha);
  int i = 0;
  for (auto& side : fit.alpha_mps2) {
    for (std::size_t node = 0; node <= segments; ++node) side[node] = alpha[i++];
  }
  return true;
}

/// Each inner node's departure from the line through its neighbours is expected to be
/// `departure_mps2`; `noise` is the variance of the equations' errors over their weight.
void expect_little_bend(const DriftBins& bins, std::size_t segments, double departure_mps2,
                        double noise, Normal& normal) noexcept {
  const double information = noise / (departure_mps2 * departure_mps2);
  const auto& ends = bins.nodes_mps();
  const auto place = [&](std::size_t node) { return ends[node == 0 ? 0 : node + 1]; };
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t node = 1; node < segments; ++node) {
      const double before = place(node) - place(node - 1);
      const double after = place(node + 1) - place(node);
      const std::array<double, 3> departure{-after / (before + after), 1.0,
                                            -before / (before + after)};
      const int first = static_cast<int>(side * (segments + 1) + node) - 1;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          normal.matrix(first + i, first + j) += information *
                                                 departure[static_cast<std::size_t>(i)] *
                                                 departure[static_cast<std::size_t>(j)];
        }
      }
    }
  }
}

void add_bin(const DriftMoments& m, const Lines& tests, const Lines& curve, double beta,
             double per_bin, Equations& out) noexcept {
  for (const Line& g : tests) {
    for (const Line& h : curve) out.design(g.index, h.index) += product(g, h, m);
    for (const Line& other : tests) out.weight(g.index, other.index) += product(g, other, m);
    out.right[g.index] += g.slope * per_bin * m.n - beta * (g.base * m.y + g.slope * m.uy);
  }
}

/// Generalised least squares: N = X' G^-1 X with G = L L'.
bool reduce(const Equations& equations, int tests, int unknowns, Normal& normal) noexcept {
  Cholesky<kMaxTests> cholesky;
  if (!cholesky.factor(equations.weight, tests)) return false;
  Eigen::Matrix<double, kMaxTests, kMaxUnknowns> whitened = equations.design;
  for (int j = 0; j < unknowns; ++j) {
    Eigen::Matrix<double, kMaxTests, 1> column = whitened.col(j);
    cholesky.forward(column);
    whitened.col(j) = column;
  }
  Eigen::Matrix<double, kMaxTests, 1> right = equations.right;
  cholesky.forward(right);
  for (int i = 0; i < unknowns; ++i) {
    for (int t = 0; t < tests; ++t) normal.right[i] += whitened(t, i) * right[t];
    for (int j = 0; j < unknowns; ++j) {
      for (int t = 0; t < tests; ++t) normal.matrix(i, j) += whitened(t, i) * whitened(t, j);
    }
  }
  return true;
}

/// Normal equations of the conditional mean of -(2 z_b'' + beta y), from bin `first` on.
Normal conditional_mean(const DriftSums& sums, double beta, std::size_t segments,
                        std::size_t first) noexcept {
  Normal normal;
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t b = first; b <= segments; ++b) {
      const DriftMoments& m = sums.sides[s][b];
      const Lines curve = curve_lines(s, b, segments);
      for (const Line& g : curve) {
        for (const Line& h : curve) normal.matrix(g.index, h.index) += product(g, h, m);
        normal.right[g.index] -=
            g.base * (2.0 * m.a + beta * m.y) + g.slope * (2.0 * m.ua + beta * m.uy);
      }
    }
  }
  return normal;
}

}  // namespace

void DriftMoments::add(const DriftMoments& other, double factor) noexcept {
  n += factor * other.n;
  u += factor * other.u;
  uu += factor * other.uu;
  y += factor * other.y;
  uy += factor * other.uy;
  a += factor * other.a;
  ua += factor * other.ua;
}

DriftBins::DriftBins(const std::array<double, kCurveSegments>& curve_nodes_mps) noexcept {
  nodes_[1] = 0.5 * curve_nodes_mps[0];
  for (std::size_t i = 0; i < kCurveSegments; ++i) nodes_[i + 2] = curve_nodes_mps[i];
  for (std::size_t i = 0; i < kPerSide; ++i) per_width_[i] = 1.0 / (nodes_[i + 1] - nodes_[i]);
}

void DriftSums::add(const DriftSums& other, double factor) noexcept {
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t b = 0; b < DriftBins::kPerSide; ++b) {
      sides[s][b].add(other.sides[s][b], factor);
    }
  }
}

void DriftSums::scale(double factor) noexcept {
  DriftSums scaled;
  scaled.add(*this, factor);
  *this = scaled;
}

double DriftSums::count() const noexcept {
  double sum = 0.0;
  for (const auto& side : sides) {
    for (const DriftMoments& m : side) sum += m.n;
  }
  return sum;
}

std::size_t supported_segments(const DriftSums& sums) noexcept {
  const double needed = kMinShare * sums.count();
  std::size_t segments = DriftBins::kPerSide - 1;
  for (const auto& side : sums.sides) {
    double beyond = 0.0;  // what the last segment would hold: it goes on without end
    std::size_t last = DriftBins::kPerSide;
    do {
      beyond += side[--last].n;
    } while (last > 0 && beyond < needed);
    std::size_t bin = 1;
    while (bin <= last && side[bin].n >= kMinSamples) ++bin;
    segments = std::min(segments, bin - 1);
  }
  return segments < 2 ? 0 : segments;
}

DriftFit fit_weak_form(const DriftSums& sums, const DriftBins& bins, double beta,
                       double input_level, double sample_rate_hz, std::size_t segments) noexcept {
  DriftFit fit{.segments = segments};
  if (segments == 0) return fit;
  const DriftSums all = folded(sums, bins, segments);
  Equations equations;
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t b = 0; b <= segments; ++b) {
      const double width = bins.nodes_mps()[b + 1] - bins.nodes_mps()[b];
      const double half_level = (s == 0 ? -0.5 : 0.5) * input_level / width;
      add_bin(all.sides[s][b], test_lines(s, b, segments), curve_lines(s, b, segments), beta,
              half_level, equations);
    }
  }
  const int unknowns = 2 * (static_cast<int>(segments) + 1);
  Normal normal;
  fit.ok = reduce(equations, unknowns + 1, unknowns, normal) && solve_level(normal, unknowns, fit);
  if (!fit.ok) return fit;
  expect_little_bend(bins, segments, kBend * fit.level_mps2, input_level * sample_rate_hz, normal);
  fit.ok = solve_curve(normal, segments, fit);
  return fit;
}

DriftFit fit_known_input(const DriftSums& sums, const DriftBins& bins, double beta,
                         std::size_t segments) noexcept {
  DriftFit fit{.segments = segments};
  if (segments == 0) return fit;
  const DriftSums all = folded(sums, bins, segments);
  const int unknowns = 2 * (static_cast<int>(segments) + 1);
  fit.ok = solve_level(conditional_mean(all, beta, segments, 2), unknowns, fit) &&
           solve_curve(conditional_mean(all, beta, segments, 1), segments, fit);
  return fit;
}

}  // namespace dampline
