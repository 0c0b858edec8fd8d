// SPDX-License-Identifier: MIT
#include "tests/published/generate/exact_connection.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace dampline::generate {
namespace {

using Equations = std::vector<std::vector<mpq_class>>;  // rows of [A | b]

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Value at 1/2 of the Lagrange polynomial of node 1 - j among the 2N nodes 1 - N...N.
mpq_class weight_of_midpoint(int j, int n) {
  mpq_class weight = 1;
  for (int i = 1 - n; i <= n; ++i) {
    if (i == j) continue;
    mpq_class factor{1 - 2 * i, 2 * (j - i)};
    factor.canonicalize();
    weight *= factor;
  }
  return weight;
}

void eliminate(Equations& rows, std::size_t pivot, std::size_t column) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (r == pivot || rows[r][column] == 0) continue;
    const mpq_class factor = rows[r][column] / rows[pivot][column];
    for (std::size_t c = column; c < rows[r].size(); ++c) rows[r][c] -= factor * rows[pivot][c];
  }
}

/// Gauss and Jordan; the equations may be more than the unknowns, but must agree.
std::vector<mpq_class> solve(Equations rows, std::size_t unknowns) {
  for (std::size_t column = 0; column < unknowns; ++column) {
    const auto first = rows.begin() + static_cast<std::ptrdiff_t>(column);
    const auto found =
        std::find_if(first, rows.end(), [&](const auto& row) { return row[column] != 0; });
    if (found == rows.end())
      throw std::runtime_error{"the equations do not determine all unknowns"};
    std::swap(*first, *found);
    eliminate(rows, column, column);
  }
  for (std::size_t r = unknowns; r < rows.size(); ++r) {
    if (rows[r][unknowns] != 0) throw std::runtime_error{"the equations contradict each other"};
  }
  std::vector<mpq_class> out(unknowns);
  for (std::size_t i = 0; i < unknowns; ++i) out[i] = rows[i][unknowns] / rows[i][i];
  return out;
}

}  // namespace

std::vector<mpq_class> interpolant_mask(int vanishing_moments) {
  const int n = vanishing_moments;
  std::vector<mpq_class> mask(at(4 * n - 1));
  mask[at(2 * n - 1)] = 1;
  // Phi is even: the value midway comes from the node j with the weight a_(2j - 1).
  for (int j = 1 - n; j <= n; ++j) mask[at(2 * j - 1 + 2 * n - 1)] = weight_of_midpoint(j, n);
  return mask;
}

std::vector<mpq_class> connection(int vanishing_moments, int order) {
  const int n = vanishing_moments;
  const int reach = 2 * n - 2;
  const int count = 2 * reach + 1;
  const std::vector<mpq_class> mask = interpolant_mask(n);
  Equations rows;
  // Phi^(order)(j) = 2^order sum_m a_(2j - m) Phi^(order)(m)
  for (int j = -reach; j <= reach; ++j) {
    std::vector<mpq_class> row(at(count + 1));
    for (int m = -reach; m <= reach; ++m) {
      const int k = 2 * j - m;
      if (std::abs(k) <= 2 * n - 1) row[at(m + reach)] = mask[at(k + 2 * n - 1)] * (1 << order);
    }
    row[at(j + reach)] -= 1;
    rows.push_back(std::move(row));
  }
  std::vector<mpq_class> moment(at(count + 1));
  for (int k = -reach; k <= reach; ++k) moment[at(k + reach)] = order == 1 ? k : k * k;
  moment[at(count)] = order;  // n! for 1 and 2
  rows.push_back(std::move(moment));
  return solve(std::move(rows), at(count));
}

}  // namespace dampline::generate
