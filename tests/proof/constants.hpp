// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "tests/proof/source_tree.hpp"

namespace dampline::proof {

/// A number that the sources or the table of constants.md give a name.
struct Constant {
  std::string file;      ///< room and stem: guard/spike_watch
  std::string name;      ///< kStrike
  std::string value;     ///< as it is written, without breaks of lines
  std::string origin{};  ///< in the table: the letter of its kind, and what is known

  [[nodiscard]] std::string text() const { return file + ' ' + name + " = " + value; }
};

/// Every `constexpr` whose name begins with k and whose value is written in numbers alone; what
/// follows from other constants is arithmetic. In the order of the files.
[[nodiscard]] std::vector<Constant> constants_of(const std::vector<SourceFile>& files);

/// The rows `| file | name | value | ...` of the tables in a Markdown text.
[[nodiscard]] std::vector<Constant> constants_in_table(std::string_view markdown);

/// The texts of those that are in `these` and not as often in `others`.
[[nodiscard]] std::vector<std::string> missing_from(const std::vector<Constant>& others,
                                                    const std::vector<Constant>& these);

}  // namespace dampline::proof
