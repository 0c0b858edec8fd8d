// SPDX-License-Identifier: MIT
#include "tests/proof/constants.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace dampline::proof {
namespace {

bool is_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_letter(char c) { return is_of_word(c) && std::isdigit(static_cast<unsigned char>(c)) == 0; }

std::string without_comments(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t comment = std::min(text.find("//", at), text.size());
    out.append(text, at, comment - at);
    at = std::min(text.find('\n', comment), text.size());
  }
  return out;
}

/// Without spaces at the ends, and with single ones between.
std::string trimmed(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!space) out += c;
    if (space && !out.empty() && out.back() != ' ') out += ' ';
  }
  if (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

/// No word in it: letters belong to a number (1e-3, 16U).
bool is_numbers_alone(std::string_view value) {
  for (std::size_t i = 0; i < value.size(); ++i)
    if (is_letter(value[i]) && (i == 0 || !(is_of_word(value[i - 1]) || value[i - 1] == '.')))
      return false;
  return !value.empty();
}

/// The last word of a declaration up to its value.
std::string last_word(std::string_view declaration) {
  while (!declaration.empty() && !is_of_word(declaration.back())) declaration.remove_suffix(1);
  std::size_t first = declaration.size();
  while (first > 0 && is_of_word(declaration[first - 1])) --first;
  return std::string{declaration.substr(first)};
}

std::string room_and_stem(const std::string& path) {
  std::size_t first = 0;
  for (const std::string_view folder : {"firmware_core/dampline/", "firmware_core/"})
    if (first == 0 && path.starts_with(folder)) first = folder.size();
  return path.substr(first, path.rfind('.') - first);
}

void add_constants(const SourceFile& file, std::vector<Constant>& out) {
  const std::string text = without_comments(file.text);
  const std::string_view word = "constexpr";
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at)) {
    at += word.size();
    const std::size_t value = text.find_first_of("=;({", at);
    const std::size_t end = text.find(';', at);
    if (value >= end || text[value] == '(') continue;
    const std::string name = last_word(std::string_view{text}.substr(at, value - at));
    if (name.size() < 2 || name[0] != 'k' || std::isupper(static_cast<unsigned char>(name[1])) == 0)
      continue;
    const std::size_t first = value + (text[value] == '=' ? 1 : 0);
    const std::string number = trimmed(std::string_view{text}.substr(first, end - first));
    if (is_numbers_alone(number)) out.push_back({room_and_stem(file.path), name, number});
  }
}

}  // namespace

std::vector<Constant> constants_of(const std::vector<SourceFile>& files) {
  std::vector<Constant> out;
  for (const SourceFile& file : files) add_constants(file, out);
  return out;
}

std::vector<Constant> constants_in_table(std::string_view markdown) {
  std::vector<Constant> out;
  while (!markdown.empty()) {
    const std::size_t end = std::min(markdown.find('\n'), markdown.size() - 1);
    const std::string_view line = markdown.substr(0, end);
    markdown.remove_prefix(end + 1);
    std::vector<std::string> cells;
    for (std::size_t at = line.find('|'); at != std::string_view::npos;) {
      const std::size_t next = line.find('|', at + 1);
      if (next != std::string_view::npos)
        cells.push_back(trimmed(line.substr(at + 1, next - at - 1)));
      at = next;
    }
    if (cells.size() == 6 && cells[1].starts_with('k'))
      out.push_back({cells[0], cells[1], cells[2], cells[5]});
  }
  return out;
}

std::vector<std::string> missing_from(const std::vector<Constant>& others,
                                      const std::vector<Constant>& these) {
  std::multiset<std::string> known;
  for (const Constant& c : others) known.insert(c.text());
  std::vector<std::string> out;
  for (const Constant& c : these) {
    const auto found = known.find(c.text());
    if (found == known.end())
      out.push_back(c.text());
    else
      known.erase(found);
  }
  return out;
}

}  // namespace dampline::proof
