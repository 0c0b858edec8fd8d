// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/verify/phase/measured.hpp"

namespace dampline::app {

struct VerifyOptions {
  bool json{false};                       ///< the figures as data
  bool markdown{false};                   ///< the figures as Markdown tables
  bool quiet{false};                      ///< nothing on standard output; the exit code tells
  std::vector<std::string> tables{};      ///< only these tables of the publication; empty: all
  std::vector<MeasuredRecord> records{};  ///< of rigs, for the subject phase: these alone
  std::string* page{nullptr};  ///< takes Markdown tables and figures in place of standard output

  [[nodiscard]] bool wants(const std::string& table) const {
    return tables.empty() || std::find(tables.begin(), tables.end(), table) != tables.end();
  }
};

/// Prints the text, or adds it to the page.
inline void put(const VerifyOptions& options, const std::string& text) {
  if (options.page != nullptr) {
    *options.page += text;
  } else if (!options.quiet) {
    fmt::print("{}", text);
  }
}

/// Adds a <figure> to the page; standard output has none.
inline void put_figure(const VerifyOptions& options, const std::string& html) {
  if (options.page != nullptr) *options.page += "\n" + html;
}

// The published methods whose cases `dampline verify` recomputes and prints: 0 when every promised
// figure is met, otherwise 1. They throw UsageError for a table that the publication does not have.

/// Kisilowski and Urbanski (1987).
int verify_fokker_planck(const VerifyOptions& options);
/// The resonances, sections and friction of the phase-mapping literature. Tables: resonance,
/// planarity, linearity, friction, figures. With records: both evidences of linearity on them, and
/// nothing else.
int verify_phase(const VerifyOptions& options);
/// Ghanem and Romeo (2001).
int verify_wavelet(const VerifyOptions& options);

/// Text of a cell of a Markdown table: the bars of magnitudes would end it.
[[nodiscard]] inline std::string markdown_cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
    text.insert(at, 1, '\\');
  return text;
}

}  // namespace dampline::app
