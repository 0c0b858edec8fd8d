// SPDX-License-Identifier: MIT
#include "drivers/text/quote.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace dampline::drivers {
namespace {

constexpr std::size_t kShown = 60;

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (lower(a[i - 1]) == lower(b[j - 1]) ? 0U : 1U);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, change});
    }
  }
  return row.back();
}

}  // namespace

std::string quote(std::string_view text) {
  if (text.empty()) return "nothing";
  std::string shown = "\"";
  for (const char c : text.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F) {
      shown += c;
    } else {
      fmt::format_to(std::back_inserter(shown), "\\x{:02X}", byte);
    }
  }
  return shown + (text.size() > kShown ? "...\"" : "\"");
}

std::string nearest_names(std::string_view wanted, const std::string* names, std::size_t count,
                          std::size_t most) {
  std::vector<std::size_t> distance(count);
  for (std::size_t i = 0; i < count; ++i) distance[i] = edit_distance(wanted, names[i]);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distance[a] < distance[b]; });
  order.resize(std::min(most, count));
  std::string list;
  for (const std::size_t i : order) list += (list.empty() ? "" : ", ") + names[i];
  return list;
}

}  // namespace dampline::drivers
