// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/estimate/statistics.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

struct SummaryConfig {
  double moving_mass_kg{0.0};
};

/// Everything that the statistics say: law, stiffness, curve, deviations, errors. Some
/// milliseconds of work; not for the sample path. Entries: EntryList or GroupedList.
template <class Entries>
[[nodiscard]] Snapshot summarise(const StatisticsHeader& header, const ScaleFactors& total,
                                 Entries entries, const SummaryConfig& config) noexcept;
[[nodiscard]] Snapshot summarise(const Statistics& statistics,
                                 const SummaryConfig& config) noexcept;

/// The two of a snapshot's figures that a history needs, the same to the last bit, at a seventh of
/// the work.
template <class Entries>
[[nodiscard]] Level summarise_level(const StatisticsHeader& header, const ScaleFactors& total,
                                    Entries entries, const SummaryConfig& config) noexcept;
[[nodiscard]] Level summarise_level(const Statistics& statistics,
                                    const SummaryConfig& config) noexcept;

}  // namespace dampline
