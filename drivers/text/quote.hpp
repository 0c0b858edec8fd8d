// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace dampline::drivers {

/// Input as it may be shown to a person: in quotes, bytes that do not print as \xNN, and the
/// beginning only when it is long. An empty text is "nothing".
std::string quote(std::string_view text);

/// Text for a terminal or a log with what came from outside in it: control characters (C0, DEL, C1)
/// and bytes that are no UTF-8 as \xNN. `lines`: newlines stay.
std::string printable(std::string_view text, bool lines = false);

/// Names as "A, B, C": of a long one its beginning, of many the first `most` and how many more.
std::string list_names(const std::vector<std::string>& names, std::size_t most = 24);

/// Of many names the ones nearest to the wanted one, by edit distance without regard to case, as
/// "A, B, C"; at most `most` of them.
std::string nearest_names(std::string_view wanted, const std::string* names, std::size_t count,
                          std::size_t most = 5);

}  // namespace dampline::drivers
