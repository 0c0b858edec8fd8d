// SPDX-License-Identifier: MIT
// The diagnosis on simulated trucks: effects of random kind and strength, three conditions, 300 s
// each, through `explain` as a file goes through it, as a confusion matrix and as rates.
// `diagnosis [PER_CELL [FIRST_SEED [STRENGTH [NOISE [KIND]]]]]`: records per kind and condition; a
// strength of 0 draws it from 0.3 to 1.2 of nominal, 0 per cell is clean records only; the sensors'
// noise in units of its nominal value; one kind alone, with the seeds that it has among all.
// `diagnosis pairs [FIRST_SEED [STRENGTH]]`: every pair of ten kinds, laden at 80 km/h, once.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "bench/diagnosis_case.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

struct Share {
  int good{0};
  int all{0};
  void add(bool is_good) {
    good += is_good ? 1 : 0;
    ++all;
  }
  [[nodiscard]] std::string text() const {
    return all == 0 ? "-" : fmt::format("{} of {} ({:.1f} %)", good, all, 100.0 * good / all);
  }
};

std::string median_and_range(std::vector<double> values) {
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return fmt::format("{:.3f} ({:.3f} to {:.3f})", at(0.5), values.front(), values.back());
}

struct Tally {
  double floor_within{0.1};
  std::map<std::string, std::map<std::string, int>> confusion;
  Share right, wrong, alarm, magnitude, repaired, repaired_by_truth, extra, withheld, complete,
      floor, as_true;
  std::vector<double> floors, ratios;  // over what is left: of clean records, of right ones
  std::vector<double> over_true;       // left over what the true model leaves
  std::map<std::string, std::vector<double>> over_true_of;
  std::string misses;

  void add(const std::string& kind, const Condition& condition, const DiagnosedRecord& record) {
    const effect::Explanation& e = record.explanation;
    const std::string verdict =
        e.step_count == 0 ? "none" : effect::name_of(e.step[0].chosen.effect);
    ++confusion[kind][verdict];
    if (record.planted.empty()) {
      alarm.add(e.step_count > 0);
      floors.push_back(e.floor_nmse / e.base.held_out_nmse);
      floor.add(std::abs(floors.back() - 1.0) <= floor_within);
      return;
    }
    const bool named = record.names(0, record.planted[0].effect);
    if (!named) {
      const std::string why = record.withheld       ? " (withheld:" + record.faults + ")"
                              : record.drifts       ? " (drift)"
                              : record.is_untouched ? " (never touched)"
                                                    : "";
      const effect::Step& best = e.step_count == 0 ? e.rejected : e.step[0];
      misses += fmt::format("| {} | {} | {}{} | {} {:.2f} % t {:.1f} |\n", condition.name,
                            record.planted[0].text, verdict, why,
                            effect::name_of(best.chosen.effect), 100.0 * best.gain, best.block_t);
    }
    right.add(named);
    withheld.add(record.withheld || record.drifts);
    if (named) {
      ratios.push_back(effect::floor_ratio(e));
      complete.add(ratios.back() <= effect::kIncompleteAbove);
    }
    wrong.add(e.step_count > 0 && !named);
    extra.add(e.step_count > 1);
    if (named) add_sizes(condition, record);
    if (named && record.by_true_model) {
      over_true.push_back(e.final.held_out_nmse / record.by_true_model->final.held_out_nmse);
      as_true.add(over_true.back() <= 1.1);
      over_true_of[kind].push_back(over_true.back());
    }
  }

 private:
  void add_sizes(const Condition& condition, const DiagnosedRecord& record) {
    const effect::Explanation& e = record.explanation;
    const Planted& planted = record.planted[0];
    for (std::size_t i = 0; i < e.step[0].parameter_count; ++i) {
      const effect::EffectParameter& p = e.step[0].parameter[i];
      if (planted.parameter == p.name)
        magnitude.add(std::abs(p.estimate.value / planted.truth - 1.0) < 0.2);
    }
    const auto off = [](double value, double truth, double limit) {
      return std::abs(value / truth - 1.0) > limit;
    };
    const bool base_off = off(e.base_coulomb_n.value, record.coulomb_n, 0.05) ||
                          off(e.base_stiffness_npm.value, record.stiffness_npm, 0.05);
    if (!base_off) return;
    const auto is_good = [&](const effect::Explanation& by) {
      return !off(by.final_coulomb_n.value, record.coulomb_n, 0.03) &&
             !off(by.final_stiffness_npm.value, record.stiffness_npm, 0.03);
    };
    const bool good = is_good(e);
    repaired.add(good);
    if (record.by_true_model) repaired_by_truth.add(is_good(*record.by_true_model));
    if (!good)
      misses += fmt::format(
          "| {} | {} | not repaired | Fc {:+.1f} -> {:+.1f} %, k {:+.1f} -> {:+.1f} % |\n",
          condition.name, planted.text, 100.0 * (e.base_coulomb_n.value / record.coulomb_n - 1.0),
          100.0 * (e.final_coulomb_n.value / record.coulomb_n - 1.0),
          100.0 * (e.base_stiffness_npm.value / record.stiffness_npm - 1.0),
          100.0 * (e.final_stiffness_npm.value / record.stiffness_npm - 1.0));
  }
};

void print(const Tally& tally) {
  fmt::print("| planted | named first |\n|--|--|\n");
  for (const auto& [kind, verdicts] : tally.confusion) {
    std::string text;
    for (const auto& [verdict, count] : verdicts)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", verdict, count);
    fmt::print("| {} | {} |\n", kind, text);
  }
  fmt::print("\n| figure | reached | wanted |\n|--|--|--|\n");
  fmt::print("| right name | {} | 94 % (98 % at strength 1) |\n", tally.right.text());
  fmt::print("| wrong name | {} | at most 1 % |\n", tally.wrong.text());
  fmt::print("| false alarms on clean records | {} | at most 2 % |\n", tally.alarm.text());
  fmt::print("| more than one effect where one was planted | {} | |\n", tally.extra.text());
  fmt::print("| size within 20 %, of the right ones | {} | 80 % |\n", tally.magnitude.text());
  fmt::print("| Fc and k within 3 % where the base was off by 5 % | {} | 90 % |\n",
             tally.repaired.text());
  fmt::print("| the same, fitted with the true model | {} | |\n", tally.repaired_by_truth.text());
  fmt::print("| effects withheld: faults, or a drift | {} | |\n", tally.withheld.text());
  fmt::print("| floor over what a clean record leaves: median (range) | {} | |\n",
             median_and_range(tally.floors));
  fmt::print("| the same within {:.0f} % | {} | all |\n", 100.0 * tally.floor_within,
             tally.floor.text());
  fmt::print("| left over floor, of the right ones: median (range) | {} | |\n",
             median_and_range(tally.ratios));
  fmt::print("| the same up to 1.5 | {} | |\n", tally.complete.text());
  fmt::print("| left over what the true model leaves: median (range) | {} | |\n",
             median_and_range(tally.over_true));
  fmt::print("| the same up to 1.1 | {} | all |\n", tally.as_true.text());
  for (const auto& [kind, values] : tally.over_true_of)
    fmt::print("| ... {} | {} | |\n", kind, median_and_range(values));
  fmt::print("\n| condition | planted | named | best candidate |\n|--|--|--|--|\n{}", tally.misses);
}

/// Two effects at once: whether the first name, both, and no more than both are found.
void pairs(std::uint64_t seed, double strength) {
  const std::array<std::string, 10> kinds{"viscous",
                                          "stribeck",
                                          "progressive_friction",
                                          "presliding_hysteresis",
                                          "bump_stop",
                                          "cubic_stiffness",
                                          "time_skew",
                                          "gain_error",
                                          "pitch",
                                          "mode"};
  Share first, both, exact;
  std::string rows;
  for (std::size_t a = 0; a < kinds.size(); ++a) {
    for (std::size_t b = a + 1; b < kinds.size(); ++b) {
      sim::Random random{seed, sim::Stream::kShocks};
      const Planted one = plant(kinds[a], strength, random);
      const Planted two = plant(kinds[b], strength, random);
      const DiagnosedRecord found = diagnose(kConditions[0], {one, two}, seed++);
      const auto has = [&](const std::string& effect) {
        return found.names(0, effect) || found.names(1, effect) || found.names(2, effect);
      };
      const std::size_t steps = found.explanation.step_count;
      const std::size_t wanted = one.effect == two.effect ? 1 : 2;
      first.add(found.names(0, one.effect) || found.names(0, two.effect));
      both.add(has(one.effect) && has(two.effect));
      exact.add(has(one.effect) && has(two.effect) && steps == wanted);
      std::string names;
      for (std::size_t i = 0; i < steps; ++i)
        names += fmt::format(" {}", effect::name_of(found.explanation.step[i].chosen.effect));
      rows += fmt::format("| {} + {} |{}{} |\n", kinds[a], kinds[b], names,
                          found.withheld ? " (withheld:" + found.faults + ")" : "");
    }
  }
  fmt::print("| planted | named |\n|--|--|\n{}\n", rows);
  fmt::print("| figure | reached | wanted |\n|--|--|--|\n| first right | {} | 95 % |\n",
             first.text());
  fmt::print("| both found | {} | 90 % |\n| exact set | {} | 85 % |\n", both.text(), exact.text());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string{argv[1]} == "pairs") {
    pairs(argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 7001,
          argc > 3 ? std::atof(argv[3]) : 0.7);
    return EXIT_SUCCESS;
  }
  const int per_cell = argc > 1 ? std::max(0, std::atoi(argv[1])) : 4;
  std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 5001;
  const double fixed = argc > 3 ? std::atof(argv[3]) : 0.0;
  const double noise = argc > 4 ? std::atof(argv[4]) : 1.0;
  const std::string only = argc > 5 ? argv[5] : "";
  const int clean = per_cell == 0 ? 4 : 5 * per_cell;
  Tally tally;
  if (noise > 1.0) tally.floor_within = 0.15;
  for (const Condition& condition : kConditions) {
    for (int i = 0; i < clean; ++i, ++seed) {
      if (only.empty()) tally.add("(clean)", condition, diagnose(condition, {}, seed, noise));
    }
    for (const std::string& kind : planted_kinds()) {
      for (int i = 0; i < per_cell; ++i, ++seed) {
        if (!only.empty() && only != kind) continue;
        sim::Random random{seed, sim::Stream::kShocks};
        const double strength = fixed > 0.0 ? fixed : 0.3 + 0.9 * random.uniform();
        tally.add(kind, condition,
                  diagnose(condition, {plant(kind, strength, random)}, seed, noise));
      }
    }
  }
  print(tally);
  return EXIT_SUCCESS;
}
