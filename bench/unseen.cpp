// SPDX-License-Identifier: MIT
// Trucks of any kind, as nobody has tuned for: what `explain` names, and whether the deviations of
// what it trusts hold. `unseen [RECORDS [FIRST_SEED [EFFECT]]]`; six seconds a record.
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include "tests/app/unseen_truck.hpp"

namespace {

using namespace dampline;
using dampline::test::Coverage;
using dampline::test::PlainExplained;
using dampline::test::UnseenTruck;

struct Row {
  int records{0};
  int right{0};    ///< the effect and nothing else
  int more{0};     ///< another beside it
  int wrong{0};    ///< another in its stead
  int silent{0};   ///< nothing named: complete, or unexplained
  int trusted{0};  ///< numbers that are stated
  Coverage level, spring, size;
};

Coverage& coverage_of(Row& row, const std::string& name) {
  if (name == "coulomb") return row.level;
  return name == "stiffness" ? row.spring : row.size;
}

/// A constant force and none at all are the same.
bool is_none(std::string_view effect) { return effect == "none" || effect == "asymmetric_coulomb"; }

void judge(const UnseenTruck& t, const PlainExplained& found, Row& row) {
  const auto& steps = found.explanation.steps;
  int own = 0, others = 0;
  for (const app::Step& step : steps) ++(step.effect == t.truck.name ? own : others);
  ++row.records;
  if (is_none(t.truck.name) ? others == 0 : own > 0 && others == 0)
    ++row.right;
  else if (own > 0)
    ++row.more;
  else if (others > 0)
    ++row.wrong;
  else
    ++row.silent;
  if (found.result.trust != app::Trust::kTrusted) return;
  ++row.trusted;
  for (const auto& [name, truth] : t.truths) {
    if (const app::Parameter* p = app::find_parameter(found.result.parameters, name))
      coverage_of(row, name).add({p->value, p->std}, truth);
  }
}

std::string text_of(const Coverage& c) {
  if (c.records == 0) return " | | ";
  return fmt::format("{} of {} | {:.2f} | {:+.2f}", c.within, c.records, c.rms(),
                     100.0 * c.mean_error());
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 150;
  const std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 1001;
  const std::size_t only = argc > 3 ? static_cast<std::size_t>(std::atoll(argv[3]))
                                    : std::numeric_limits<std::size_t>::max();
  std::map<std::string, Row> rows;
  for (int i = 0; i < records; ++i) {
    const std::uint64_t at = seed + static_cast<std::uint64_t>(i);
    UnseenTruck t = test::unseen_truck(at, only);
    const PlainExplained found = test::explained_from(t, at);
    judge(t, found, rows[t.truck.name]);
  }
  fmt::print(
      "Within two stated deviations, of records whose numbers are trusted:\n\n"
      "| effect | right | with another | another | nothing named | trusted | Fc | rms z | mean, % "
      "| k | rms z | mean, % | its own size | rms z | mean, % |\n"
      "|--|--|--|--|--|--|--|--|--|--|--|--|--|--|--|\n");
  for (const auto& [effect, r] : rows)
    fmt::print("| {} | {} of {} | {} | {} | {} | {} | {} | {} | {} |\n", effect, r.right, r.records,
               r.more, r.wrong, r.silent, r.trusted, text_of(r.level), text_of(r.spring),
               text_of(r.size));
  return 0;
}
