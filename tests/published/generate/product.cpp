// SPDX-License-Identifier: MIT
#include "tests/published/generate/product.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "tests/published/generate/decimal.hpp"
#include "tests/published/generate/low_pass.hpp"

namespace dampline::generate {
namespace {

using Row = std::vector<mpf_class>;

struct Pair {
  int p;
  int q;
};

/// The pairs whose three functions overlap, and where each stands among the unknowns.
class Support {
 public:
  explicit Support(int reach) : reach_{reach} {
    for (int p = -reach; p <= reach; ++p) {
      for (int q = -reach; q <= reach; ++q) {
        if (std::abs(p - q) <= reach) pairs_.push_back({p, q});
      }
    }
  }
  [[nodiscard]] const std::vector<Pair>& pairs() const { return pairs_; }
  /// -1 outside.
  [[nodiscard]] int index(int p, int q) const {
    const auto found = std::find_if(pairs_.begin(), pairs_.end(),
                                    [&](const Pair& pair) { return pair.p == p && pair.q == q; });
    return found == pairs_.end() ? -1 : static_cast<int>(found - pairs_.begin());
  }
  [[nodiscard]] int reach() const { return reach_; }

 private:
  int reach_;
  std::vector<Pair> pairs_;
};

Row zero_row(const Support& support) {
  Row row(support.pairs().size() + 1, mpf_class{0, kBits});
  return row;
}

void add(Row& row, const Support& support, int p, int q, const mpf_class& value) {
  const int i = support.index(p, q);
  if (i >= 0) row[static_cast<std::size_t>(i)] += value;
}

/// Omega(p, q) = sum_ijn c_i c_j c_n Omega(2p + j - i, 2q + n - i), c = sqrt(2) h.
Row two_scale(const Support& support, const std::vector<mpf_class>& c, Pair at) {
  Row row = zero_row(support);
  const int taps = static_cast<int>(c.size());
  const auto tap = [&c](int i) -> const mpf_class& { return c[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < taps; ++i) {
    for (int j = 0; j < taps; ++j) {
      for (int n = 0; n < taps; ++n) {
        const mpf_class product{tap(i) * tap(j) * tap(n), kBits};
        add(row, support, 2 * at.p + j - i, 2 * at.q + n - i, product);
      }
    }
  }
  add(row, support, at.p, at.q, mpf_class{-1, kBits});
  return row;
}

/// sum_p p^power Omega(p, q) = right.
Row moment(const Support& support, int power, int q, int right) {
  Row row = zero_row(support);
  for (int p = -support.reach(); p <= support.reach(); ++p) {
    add(row, support, p, q, mpf_class{power == 0 ? 1 : p, kBits});
  }
  row.back() = right;
  return row;
}

void eliminate_below(std::vector<Row>& rows, std::size_t column) {
  for (std::size_t r = column + 1; r < rows.size(); ++r) {
    const mpf_class factor{rows[r][column] / rows[column][column], kBits};
    for (std::size_t c = column; c < rows[r].size(); ++c) rows[r][c] -= factor * rows[column][c];
  }
}

/// Gauss with row exchange; equations beyond the unknowns must agree with the others.
Row solve(std::vector<Row> rows) {
  const std::size_t unknowns = rows[0].size() - 1;
  const mpf_class small{"1e-100", kBits};
  for (std::size_t column = 0; column < unknowns; ++column) {
    const auto first = rows.begin() + static_cast<std::ptrdiff_t>(column);
    const auto largest = std::max_element(first, rows.end(), [&](const Row& a, const Row& b) {
      return abs(a[column]) < abs(b[column]);
    });
    if (abs((*largest)[column]) < small) throw std::runtime_error{"Omega is not determined"};
    std::swap(*first, *largest);
    eliminate_below(rows, column);
  }
  for (std::size_t r = unknowns; r < rows.size(); ++r) {
    if (abs(rows[r][unknowns]) > small) throw std::runtime_error{"Omega's equations contradict"};
  }
  Row out(unknowns, mpf_class{0, kBits});
  for (std::size_t i = unknowns; i-- > 0;) {
    mpf_class sum{rows[i][unknowns], kBits};
    for (std::size_t j = i + 1; j < unknowns; ++j) sum -= rows[i][j] * out[j];
    out[i] = sum / rows[i][i];
  }
  return out;
}

}  // namespace

std::vector<std::vector<mpf_class>> product_connection(int vanishing_moments) {
  const Support support{2 * vanishing_moments - 2};
  std::vector<mpf_class> c = low_pass(vanishing_moments);
  const mpf_class root{sqrt(mpf_class{2, kBits}), kBits};
  for (mpf_class& x : c) x *= root;
  std::vector<Row> rows;
  for (const Pair& pair : support.pairs()) rows.push_back(two_scale(support, c, pair));
  for (int q = -support.reach(); q <= support.reach(); ++q) {
    rows.push_back(moment(support, 0, q, 0));
    rows.push_back(moment(support, 1, q, q == 0 ? 1 : 0));
  }
  const Row solution = solve(std::move(rows));
  const auto size = static_cast<std::size_t>(2 * support.reach() + 1);
  std::vector<std::vector<mpf_class>> out(size, Row(size, mpf_class{0, kBits}));
  for (std::size_t i = 0; i < solution.size(); ++i) {
    const Pair& pair = support.pairs()[i];
    out[static_cast<std::size_t>(pair.p + support.reach())]
       [static_cast<std::size_t>(pair.q + support.reach())] = solution[i];
  }
  return out;
}

std::string product_header() {
  std::ostringstream out;
  out << "// SPDX-License-Identifier: MIT\n"
         "// Generated by tests/published/generate (target connection_tables).\n"
         "// clang-format off\n"
         "#pragma once\n"
         "#include <array>\n"
         "\n"
         "namespace dampline {\n"
         "\n"
         "/// Omega(p, q) = int phi(y) phi'(y - p) phi(y - q) dy of D8's scaling function, p and q "
         "from\n"
         "/// -6 to 6: with samples s_l at a step D, the product s s' is, to third order,\n"
         "///   1/D sum_pq Omega(p, q) s_(l+p) s_(l+q).\n"
         "inline constexpr std::array<std::array<double, 13>, 13> kProductD8{{\n";
  for (const auto& row : product_connection(4)) {
    out << "    {{";
    for (std::size_t i = 0; i < row.size(); ++i) {
      out << (i == 0 ? "" : i % 3 == 0 ? ",\n      " : ", ") << decimal(row[i]);
    }
    out << "}},\n";
  }
  out << "}};\n\n}  // namespace dampline\n";
  return out.str();
}

}  // namespace dampline::generate
