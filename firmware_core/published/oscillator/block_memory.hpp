// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/estimate/block_store.hpp"
#include "dampline/estimate/weighted_fit.hpp"
#include "dampline/numeric/blocks.hpp"
#include "dampline/numeric/cholesky.hpp"
#include "dampline/numeric/information.hpp"
#include "dampline/result.hpp"

namespace dampline {

/// Value and standard deviation of each unknown.
template <int Unknowns>
struct ParameterEstimate {
  std::array<double, static_cast<std::size_t>(Unknowns)> value{};
  std::array<double, static_cast<std::size_t>(Unknowns)> std{};
  double residual_rms{0.0};  ///< of the rows, in the unit of their last column
  int blocks{0};
  [[nodiscard]] double t_ratio(std::size_t i) const noexcept { return value[i] / std[i]; }
};

/// Square-root information of blocks, remembered for ever, over a sliding window or with
/// forgetting. What is kept is a ring of factors, each of one block or of several consecutive ones;
/// the estimate merges them on demand, and nothing is ever subtracted from a factor.
template <int Columns, int Entries = 32>
class BlockMemory {
  static_assert(Entries % 2 == 0);

 public:
  static constexpr int kUnknowns = Columns - 1;
  using Factor = Information<Columns>;
  using Estimate = ParameterEstimate<kUnknowns>;
  /// What scatter between blocks cannot show, added in quadrature to every standard deviation.
  static constexpr double kRelativeFloor = 1e-4;

  struct Config {
    Memory memory{Memory::kInfinite};
    double memory_blocks{0.0};  ///< length of the window, or time constant of forgetting
  };

  explicit BlockMemory(const Config& config = {}) noexcept : config_{config} {
    if (config.memory == Memory::kWindow) {
      const double blocks = std::clamp(std::round(config.memory_blocks), 1.0, 1e6);
      per_entry_ = static_cast<int>(std::ceil(blocks / Entries));
      limit_ = std::max(1, static_cast<int>(blocks) / per_entry_);
    }
  }

  /// Adds a block of so many independent rows. When infinite memory is full, neighbours merge two
  /// by two; a window loses its oldest entry. At most Entries / 2 merges.
  void add(const Factor& block, double rows) noexcept {
    if (config_.memory == Memory::kForgetting) forget();
    if (count_ == 0 || newest().blocks >= per_entry_) open();
    newest().factor.merge(block);
    newest().rows += rows;
    ++newest().blocks;
  }

  /// Adds what another run has learned; as if its blocks had been added here.
  void merge(const BlockMemory& other) noexcept {
    for (int i = 0; i < other.count_; ++i) {
      open();
      newest() = other.entry(i);
    }
    per_entry_ = std::max(per_entry_, other.per_entry_);
  }

  [[nodiscard]] int blocks() const noexcept {
    int sum = 0;
    for (int i = 0; i < count_; ++i) sum += entry(i).blocks;
    return sum;
  }

  /// All that is remembered, as one factor.
  [[nodiscard]] Factor total() const noexcept {
    Factor sum;
    for (int i = 0; i < count_; ++i) sum.merge(entry(i).factor);
    return sum;
  }

  /// Standard deviations are those of the jackknife, widened for few blocks (docs/adr/0004) and by
  /// the floor. kNotReady below four entries, and while the data do not determine every unknown.
  [[nodiscard]] Result<Estimate> estimate() const noexcept;

  void clear() noexcept { head_ = count_ = 0; }

 private:
  struct Entry {
    Factor factor;
    double rows{0.0};
    int blocks{0};
  };
  using Vector = Eigen::Matrix<double, kUnknowns, 1>;
  using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;

  [[nodiscard]] static std::size_t index(int i) noexcept {
    return static_cast<std::size_t>(i % Entries);
  }
  [[nodiscard]] const Entry& entry(int i) const noexcept { return entries_[index(head_ + i)]; }
  [[nodiscard]] Entry& newest() noexcept { return entries_[index(head_ + count_ - 1)]; }

  void open() noexcept {
    if (count_ == limit_) {
      if (config_.memory == Memory::kWindow) {
        head_ = (head_ + 1) % Entries;
        --count_;
      } else {
        compact();  // only a window turns, so that the oldest is entry 0
      }
    }
    ++count_;
    newest() = {};
  }

  void compact() noexcept {
    const std::size_t left =
        join_neighbours(entries_, entries_.size(), [](Entry& into, const Entry& next) {
          into.factor.merge(next.factor);
          into.rows += next.rows;
          into.blocks += next.blocks;
        });
    count_ = static_cast<int>(left);
    per_entry_ *= 2;
  }

  void forget() noexcept {
    const double kept = std::exp(-1.0 / config_.memory_blocks);
    for (int i = 0; i < count_; ++i) {
      Entry& old = entries_[index(head_ + i)];
      old.factor.scale(std::sqrt(kept));
      old.rows *= kept;
    }
  }

  /// Covariance by leaving out one entry after the other (Efron and Stein 1981), valid for rows
  /// that are correlated within an entry and of unequal variance between them.
  [[nodiscard]] Square jackknife(const Square& normal, const Vector& theta) const noexcept;

  Config config_;
  std::array<Entry, static_cast<std::size_t>(Entries)> entries_{};
  int limit_{Entries};
  int per_entry_{1};
  int head_{0};
  int count_{0};
};

template <int Columns, int Entries>
auto BlockMemory<Columns, Entries>::jackknife(const Square& normal,
                                              const Vector& theta) const noexcept -> Square {
  std::array<Vector, static_cast<std::size_t>(Entries)> change;
  Vector mean = Vector::Zero();
  for (int i = 0; i < count_; ++i) {
    const typename Factor::Gram gram = entry(i).factor.gram();
    const Square own = gram.template topLeftCorner<kUnknowns, kUnknowns>();
    const Vector score = gram.template topRightCorner<kUnknowns, 1>() - own.lazyProduct(theta);
    change[index(i)] = solve_cholesky<kUnknowns>(normal - own, score);
    mean += change[index(i)] / count_;
  }
  Square sum = Square::Zero();
  for (int i = 0; i < count_; ++i) {
    const Vector off = change[index(i)] - mean;
    sum += off.lazyProduct(off.transpose());
  }
  return sum * (static_cast<double>(count_ - 1) / count_);
}

template <int Columns, int Entries>
auto BlockMemory<Columns, Entries>::estimate() const noexcept -> Result<Estimate> {
  if (count_ < 4) return Errc::kNotReady;
  const Factor sum = total();
  Estimate out;
  Vector theta;
  if (!sum.solve(theta)) return Errc::kNotReady;
  double rows = 0.0;
  for (int i = 0; i < count_; ++i) {
    rows += entry(i).rows;
    out.blocks += entry(i).blocks;
  }
  out.residual_rms = sum.residual_norm() / std::sqrt(std::max(rows - kUnknowns, 1.0));
  const Square normal = sum.gram().template topLeftCorner<kUnknowns, kUnknowns>();
  const Square covariance = jackknife(normal, theta);
  for (int i = 0; i < kUnknowns; ++i) {
    const auto at = static_cast<std::size_t>(i);
    out.value[at] = theta[i];
    out.std[at] = std::hypot(short_record_factor(count_) * std::sqrt(covariance(i, i)),
                             kRelativeFloor * theta[i]);
    if (!std::isfinite(out.std[at])) return Errc::kNotReady;
  }
  return out;
}

}  // namespace dampline
