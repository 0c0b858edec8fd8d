// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace dampline::app {

/// Levenshtein distance: insertions, deletions and replacements of one character.
[[nodiscard]] std::size_t edit_distance(std::string_view left, std::string_view right);

/// The nearest of `known`; empty when `known` is.
[[nodiscard]] std::string_view nearest(std::string_view word,
                                       std::span<const std::string_view> known);

/// "a", "b" or "c", for messages that say what would have been accepted.
[[nodiscard]] std::string list_words(std::span<const std::string_view> words);

}  // namespace dampline::app
