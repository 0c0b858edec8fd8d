// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>

#include "published/wavelet/coarse_rows.hpp"
#include "published/wavelet/estimates.hpp"
#include "published/wavelet/model_selection.hpp"
#include "tests/proof/heap_hook.hpp"

namespace dampline::proof {
namespace {

using Element = TermList<Viscous, Spring, CubicSpring, Friction<>, ProgressiveFriction<>>;
using Chain = ChainModel<Element, Element>;
constexpr int kUnknowns = Chain::kUnknowns;

MotionSample<2> sample(std::int64_t i) {
  const double t = 1e-3 * static_cast<double>(i);
  return {.deflection_m = {std::sin(9.0 * t), 2.0 * std::sin(9.0 * t) + 0.3 * std::sin(23.0 * t)},
          .force_n = {std::sin(25.0 * t), std::sin(35.0 * t)}};
}

/// Everything that a stream of motion and force goes through.
struct Stream {
  MotionRows<D16, Chain> rows;
  CoarseRows<D8, Chain, 2> coarse;
  SequentialWindows<kUnknowns> windows{64};
  RecursiveEstimate<kUnknowns> recursive;
  FactorRing<kUnknowns, 4> ring{64};
  ModelSelection<Chain> selection{256};
  MotionRow<Chain> row;
  std::int64_t used{0};

  void update(const MotionSample<2>& sample) noexcept {
    if (coarse.push(sample, row) && row.usable) recursive.absorb(row.equation(1));
    if (!rows.push(sample, row) || !row.usable) return;
    ++used;
    for (int d = 0; d < Chain::kDof; ++d) {
      static_cast<void>(windows.absorb(row.equation(d)));
      recursive.absorb(row.equation(d));
      ring.absorb(row.equation(d));
    }
    static_cast<void>(ring.update());
    selection.absorb(row, {12.0, 12.0});
  }
};

TEST(MotionHeap, IsNotTouchedFromTheSampleToTheChoiceOfTerms) {
  const auto stream = std::make_unique<Stream>();
  std::uint64_t calls = 0;
  bool valid = false;
  {
    const HeapWatch watch;
    const MotionRowsConfig<2> config{.step_s = 1e-3, .mass_kg = {12.0, 12.0}};
    stream->rows = MotionRows<D16, Chain>::make(config, Chain{}).value();
    stream->coarse = CoarseRows<D8, Chain, 2>::make(config, Chain{}).value();
    for (std::int64_t i = 0; i < 50'000; ++i) stream->update(sample(i));
    stream->rows.restart();
    stream->coarse.restart();
    for (std::int64_t i = 0; i < 1'000; ++i) stream->update(sample(i));
    valid = stream->recursive.update();
    valid = stream->selection.choose().valid && valid;
    calls = HeapWatch::calls();
  }
  EXPECT_EQ(calls, 0U);
  EXPECT_TRUE(valid);  // it did what it is for
  EXPECT_GT(stream->used, 10'000);
}

}  // namespace
}  // namespace dampline::proof
