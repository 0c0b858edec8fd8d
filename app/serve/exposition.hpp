// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dampline::app {

/// Metrics as Prometheus reads them, version 0.0.4 of its text: for each metric HELP, TYPE and its
/// values. Names begin with dampline_; a number that is not finite is left out.
class Exposition {
 public:
  using Labels = std::vector<std::pair<std::string_view, std::string_view>>;
  static constexpr const char* kType = "text/plain; version=0.0.4; charset=utf-8";

  void begin(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    out_ += fmt::format("# HELP dampline_{0} {1}\n# TYPE dampline_{0} {2}\n", name, help, type);
  }
  template <class Number>
  void value(Number number, const Labels& labels = {}, std::string_view suffix = "") {
    if (!std::isfinite(static_cast<double>(number))) return;
    out_ += fmt::format("dampline_{}{}", name_, suffix);
    for (std::size_t i = 0; i < labels.size(); ++i)
      out_ += fmt::format("{}{}=\"{}\"", i == 0 ? "{" : ",", labels[i].first,
                          escaped(labels[i].second));
    out_ += fmt::format("{} {}\n", labels.empty() ? "" : "}", number);
  }
  template <class Number>
  void single(std::string_view name, std::string_view type, std::string_view help, Number number) {
    begin(name, type, help);
    value(number);
  }
  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  static std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
      if (c == '\n') {
        out += "\\n";
        continue;
      }
      if (c == '\\' || c == '"') out += '\\';
      out += c;
    }
    return out;
  }
  std::string out_;
  std::string name_;
};

}  // namespace dampline::app
