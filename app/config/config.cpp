// SPDX-License-Identifier: MIT
#include "app/config/config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "app/config/fields.hpp"
#include "app/error.hpp"
#include "app/text/format.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

/// Where a value stands, for messages.
struct Place {
  std::string origin;
  std::string_view table;
  std::string_view key;
  toml::source_region source;

  [[noreturn]] void fail(const std::string& what) const {
    throw UsageError{
        fmt::format("{}:{}: [{}] {}: {}", origin, source.begin.line, table, key, what)};
  }
};

std::string describe(const toml::node& node) {
  if (const auto text = node.value<std::string>(); node.is_string())
    return fmt::format(R"("{}")", *text);
  if (const auto number = node.value<double>(); node.is_number()) return fmt::format("{}", *number);
  if (node.is_boolean()) return node.value<bool>().value_or(false) ? "true" : "false";
  if (node.is_array()) return "an array";
  if (node.is_table()) return "a table";
  return "a date or time";
}

double read_number(const toml::node& node, const Limits& limits, const Place& place) {
  if (!node.is_number()) place.fail(fmt::format("found {}, expected a number", describe(node)));
  const double value = node.value<double>().value_or(std::nan(""));
  if (!(value >= limits.minimum && value <= limits.maximum))
    place.fail(fmt::format("found {}, expected a number from {} to {}", value, limits.minimum,
                           limits.maximum));
  return value;
}

std::string read_text(const toml::node& node, std::span<const std::string_view> allowed,
                      const Place& place) {
  if (!node.is_string()) place.fail(fmt::format("found {}, expected a text", describe(node)));
  std::string value = node.value<std::string>().value_or("");
  if (allowed.empty() || std::find(allowed.begin(), allowed.end(), value) != allowed.end())
    return value;
  if (allowed.size() <= 4)
    place.fail(fmt::format("found \"{}\", expected {}", value, list_words(allowed)));
  place.fail(fmt::format(R"("{}" is not known; the nearest known name is "{}")", value,
                         nearest(value, allowed)));
}

const toml::array& read_array(const toml::node& node, const Place& place) {
  if (!node.is_array()) place.fail(fmt::format("found {}, expected an array", describe(node)));
  return *node.as_array();
}

void read(const NumberField& field, const toml::node& node, const Place& place) {
  *field.value = read_number(node, field.limits, place);
}

void read(const IntegerField& field, const toml::node& node, const Place& place) {
  if (!node.is_integer())
    place.fail(fmt::format("found {}, expected a whole number", describe(node)));
  *field.value = static_cast<int>(read_number(node, field.limits, place));
}

void read(const OptionalNumberField& field, const toml::node& node, const Place& place) {
  if (!field.absent_word.empty() && node.is_string()) {
    if (node.value<std::string>() != field.absent_word)
      place.fail(
          fmt::format("found {}, expected a number or \"{}\"", describe(node), field.absent_word));
    field.value->reset();
    return;
  }
  const double value = read_number(node, field.limits, place);
  const auto& choices = field.choices;
  if (!choices.empty() && std::find(choices.begin(), choices.end(), value) == choices.end())
    place.fail(fmt::format("found {}, expected one of {} or \"{}\"", value,
                           fmt::join(choices, ", "), field.absent_word));
  *field.value = value;
}

void read(const TextField& field, const toml::node& node, const Place& place) {
  *field.value = read_text(node, field.allowed, place);
}

void read(const TextListField& field, const toml::node& node, const Place& place) {
  field.value->clear();
  for (const toml::node& item : read_array(node, place))
    field.value->push_back(read_text(item, field.allowed, place));
}

void read(const NumberListField& field, const toml::node& node, const Place& place) {
  field.value->clear();
  for (const toml::node& item : read_array(node, place))
    field.value->push_back(read_number(item, field.limits, place));
  const auto& values = *field.value;
  if (!values.empty() && values.size() != field.count)
    place.fail(fmt::format("found {} numbers, expected {} (or none)", values.size(), field.count));
  if (std::adjacent_find(values.begin(), values.end(), std::greater_equal<>{}) != values.end())
    place.fail("expected numbers in ascending order");
}

bool is_table_name(std::string_view name, const std::vector<Field>& known) {
  return std::any_of(known.begin(), known.end(), [&](const Field& field) {
    return field.table == name || field.table.starts_with(std::string{name} + ".");
  });
}

/// What to say about a key that does not exist: the nearest one of its table, or its right table.
std::string suggest(std::string_view table, std::string_view key, const std::vector<Field>& known) {
  std::vector<std::string_view> names;
  for (const Field& field : known) {
    if (field.key == key) return fmt::format("it belongs into [{}]", field.table);
    if (field.table == table) names.push_back(field.key);
    const std::string inner = std::string{table} + ".";
    if (!table.empty() && field.table.starts_with(inner))
      names.push_back(field.table.substr(inner.size()));
    if (table.empty()) names.push_back(field.table);
  }
  return fmt::format("the nearest known one is {}", nearest(key, names));
}

class Loader {
 public:
  Loader(Config& config, std::string origin) : known_{fields(config)}, origin_{std::move(origin)} {}

  void read_file(const toml::table& file) {
    std::vector<Open> tables{{"", &file}};
    while (!tables.empty()) {
      const Open table = tables.back();
      tables.pop_back();
      for (const auto& [key, node] : *table.content) read_entry(table.path, key, node, tables);
    }
  }

 private:
  /// A table that is still to be read.
  struct Open {
    std::string path;
    const toml::table* content;
  };

  void read_entry(const std::string& path, const toml::key& key, const toml::node& node,
                  std::vector<Open>& tables) {
    const std::string inner =
        path.empty() ? std::string{key.str()} : fmt::format("{}.{}", path, key.str());
    if (inner == "run" && node.is_table() && (*node.as_table())["version"].is_string())
      return;  // provenance that a run directory adds to its configuration
    if (node.is_table() && is_table_name(inner, known_)) {
      tables.push_back({inner, node.as_table()});
      return;
    }
    const auto field = std::find_if(known_.begin(), known_.end(), [&](const Field& candidate) {
      return candidate.table == path && candidate.key == key.str();
    });
    if (field == known_.end()) fail_unknown(path, key, node.is_table());
    const Place place{origin_, field->table, field->key, node.source()};
    std::visit([&](const auto& target) { read(target, node, place); }, field->target);
  }

  [[noreturn]] void fail_unknown(const std::string& path, const toml::key& key, bool table) const {
    const std::string where = path.empty() ? "" : fmt::format(" in [{}]", path);
    throw UsageError{fmt::format("{}:{}: unknown {} \"{}\"{}; {}", origin_, key.source().begin.line,
                                 table ? "table" : "key", key.str(), where,
                                 suggest(path, key.str(), known_))};
  }

  std::vector<Field> known_;
  std::string origin_;
};

/// "car", "input", "input.columns", ...
std::vector<std::string> tables_of(const toml::table& file) {
  std::vector<std::string> out;
  if (file["run"].is_table()) return out;
  for (const auto& [key, node] : file) {
    if (!node.is_table()) continue;
    out.emplace_back(key.str());
    for (const auto& [inner, part] : *node.as_table())
      if (part.is_table()) out.push_back(fmt::format("{}.{}", key.str(), inner.str()));
  }
  return out;
}

}  // namespace

Config parse_config(std::string_view text, const std::string& origin) {
  Config config;
  try {
    const toml::table file = toml::parse(text, origin);
    Loader{config, origin}.read_file(file);
    config.input.sample_rate_is_set = file["input"]["sample_rate_hz"].is_number();
    config.model.base_is_set = !!file["model"]["base"];
    config.tables = tables_of(file);
  } catch (const toml::parse_error& error) {
    throw UsageError{
        fmt::format("{}:{}: not TOML: {}", origin, error.source().begin.line, error.description())};
  }
  return config;
}

Config load_config(const std::filesystem::path& file) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  const auto text = drivers::read_whole(file.string(), kMostBytes);
  if (!text.ok()) throw UsageError{text.error_text()};
  if (text.value().find('=') == std::string::npos)
    throw UsageError{fmt::format(
        "{}: found no key, expected a configuration as `dampline config show` prints it",
        file.string())};
  Config config = parse_config(text.value(), file.string());
  std::string& dbc = config.input.can.dbc;
  if (!dbc.empty() && std::filesystem::path{dbc}.is_relative())
    dbc = (file.parent_path() / dbc).string();
  for (std::string* path :
       {&config.serve.token_file, &config.serve.cert_file, &config.serve.key_file,
        &config.serve.client_ca_file, &config.alarm.reference, &config.mqtt.password_file,
        &config.mqtt.ca_file, &config.mqtt.cert_file, &config.mqtt.key_file, &config.spool.folder})
    if (!path->empty() && std::filesystem::path{*path}.is_relative())
      *path = (file.parent_path() / *path).string();
  return config;
}

namespace {

/// Shortest text that reads back to the same double, and as a TOML float.
std::string write(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string write(int value) { return fmt::format("{}", value); }

std::string write(const std::string& value) { return toml_string(value); }

template <class T>
std::string write(const std::vector<T>& values) {
  std::string text;
  for (const T& value : values) text += (text.empty() ? "" : ", ") + write(value);
  return "[" + text + "]";
}

/// The value as TOML; empty when the key is to be left out.
template <class Target>
std::string write_value(const Target& target) {
  return write(*target.value);
}

template <>
std::string write_value(const OptionalNumberField& target) {
  if (*target.value) return write(**target.value);
  return target.absent_word.empty() ? "" : write(std::string{target.absent_word});
}

}  // namespace

std::string show_config(const Config& config) {
  Config copy = config;
  std::string out;
  std::string_view table;
  for (const Field& field : fields(copy)) {
    if (field.table != table) out += fmt::format("{}[{}]\n", out.empty() ? "" : "\n", field.table);
    table = field.table;
    const std::string value =
        std::visit([](const auto& target) { return write_value(target); }, field.target);
    const std::string line =
        value.empty() ? fmt::format("# {} =", field.key) : fmt::format("{} = {}", field.key, value);
    out += fmt::format("{:<36} # {}\n", line, field.help);
  }
  return out;
}

}  // namespace dampline::app
