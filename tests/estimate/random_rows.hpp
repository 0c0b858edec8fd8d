// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Dense>
#include <random>
#include <vector>

#include "dampline/estimate/block_store.hpp"

namespace dampline {

/// Rows of a block as they went in, for the truth by a batch.
struct PlainRow {
  std::int64_t block;
  std::size_t scale;
  GalerkinRow row;
};

using RowGram = RowFactor::Gram;

inline std::vector<PlainRow> random_rows(std::int64_t blocks, int rows_per_scale,
                                         std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  std::vector<PlainRow> out;
  for (std::int64_t b = 0; b < blocks; ++b) {
    for (int i = 0; i < rows_per_scale; ++i) {
      for (std::size_t s = 0; s < kScales; ++s) {
        GalerkinRow row;
        for (int c = 0; c < kRowColumns; ++c) row[c] = normal(random);
        out.push_back({b, s, row});
      }
    }
  }
  return out;
}

/// Sum of weight(block) row row' over the rows of one scale.
template <class Weight>
RowGram batch_gram(const std::vector<PlainRow>& rows, std::size_t scale, const Weight& weight) {
  RowGram out = RowGram::Zero();
  for (const PlainRow& r : rows) {
    if (r.scale == scale) out += weight(r.block) * r.row * r.row.transpose();
  }
  return out;
}

/// Largest difference over the largest entry.
inline double relative_difference(const RowGram& a, const RowGram& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

/// Feeds a store as the Estimator does: rows, then close, with `steps` steps after each block.
template <class Store>
void feed(Store& store, const std::vector<PlainRow>& rows, int steps) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    store.absorb(rows[i].block, rows[i].scale, rows[i].row);
    if (i + 1 < rows.size() && rows[i + 1].block == rows[i].block) continue;
    store.close(rows[i].block);
    for (int k = 0; k < steps; ++k) store.step();
  }
}

}  // namespace dampline
