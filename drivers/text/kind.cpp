// SPDX-License-Identifier: MIT
#include "drivers/text/kind.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "drivers/text/cursor.hpp"

namespace dampline::drivers {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kSaveAsCsv = "save the table as CSV";

struct Magic {
  std::string_view bytes;
  ForeignKind kind;
};
/// First bytes, as the formats' own descriptions have them.
constexpr std::array kMagic{
    Magic{"%PDF-"sv, {"a PDF document", kSaveAsCsv}},
    Magic{"SQLite format 3"sv,
          {"an SQLite database", "sqlite3 -header -csv FILE 'SELECT ...' > run.csv"}},
    Magic{"RIFF"sv, {"a RIFF file (WAV)", "sox FILE run.dat makes a table of it"}},
    Magic{"\x7F"
          "ELF"sv,
          {"a program", "name the record"}},
    Magic{"\x89PNG"sv, {"a picture", "name the record"}},
    Magic{"\xFF\xD8\xFF"sv, {"a picture", "name the record"}},
    Magic{"\xFF\xFE"sv, {"UTF-16 text", "iconv -f UTF-16 -t UTF-8 FILE > run.csv"}},
    Magic{"\xFE\xFF"sv, {"UTF-16 text", "iconv -f UTF-16 -t UTF-8 FILE > run.csv"}},
};

bool is_white(char c) noexcept { return std::isspace(static_cast<unsigned char>(c)) != 0; }

std::string_view without_white(std::string_view text) noexcept {
  while (!text.empty() && is_white(text.front())) text.remove_prefix(1);
  return text;
}

bool holds_text(std::string_view text, std::string_view part) noexcept {
  return text.find(part) != std::string_view::npos;
}

/// An object or an array that begins as one.
bool is_json(std::string_view text) noexcept {
  if (!text.starts_with('{') && !text.starts_with('[')) return false;
  const bool object = text.front() == '{';
  text = without_white(text.substr(1));
  if (text.empty()) return true;
  const std::string_view first = object ? "\"}" : "\"{[]-0123456789";
  // "[12:00:01] text" is a log, not an array.
  const std::size_t word = object ? std::string_view::npos : text.find_first_not_of("-0123456789.");
  return first.find(text.front()) != std::string_view::npos &&
         (word == std::string_view::npos || word == 0 || text[word] == ',' || is_white(text[word]));
}

bool begins_as(std::string_view text, std::string_view lower_case) noexcept {
  return text.size() >= lower_case.size() &&
         std::equal(lower_case.begin(), lower_case.end(), text.begin(), [](char a, char b) {
           return a == static_cast<char>(std::tolower(static_cast<unsigned char>(b)));
         });
}

std::optional<ForeignKind> kind_of_text(std::string_view head) {
  head = without_byte_order_mark(head);
  const std::string_view text = without_white(head);
  if (is_json(text)) return ForeignKind{"JSON", "write its numbers as CSV, with jq -r and @csv"};
  if (begins_as(text, "<!doctype html") || begins_as(text, "<html"))
    return ForeignKind{"a web page", "download the record itself"};
  if (begins_as(text, "<?xml")) return ForeignKind{"XML", kSaveAsCsv};
  if (holds_text(head, "\nBO_ ") && holds_text(head, "\n SG_ "))
    return ForeignKind{"a DBC file", "dampline inspect RECORD --dbc FILE reads a record with it"};
  if (text.starts_with("[car]") || holds_text(head, "\n[car]") || holds_text(head, "\n[input"))
    return ForeignKind{"a configuration", "dampline config check FILE"};
  return std::nullopt;
}

}  // namespace

std::optional<ForeignKind> foreign_kind(std::string_view head) {
  for (const Magic& magic : kMagic)
    if (head.starts_with(magic.bytes)) return magic.kind;
  return kind_of_text(head);
}

}  // namespace dampline::drivers
