// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/memory_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/diagnosis/rig/steps.hpp"
#include "app/diagnosis/rig/thresholds.hpp"

namespace dampline::app::rig {
namespace {

constexpr Eigen::Index kMostRowsOfTwo = 20000;
constexpr std::size_t kEveryTravel = 2;  // travels of the library
constexpr int kPlacesOfChange = 10;
constexpr int kTurns = 2;
constexpr double kOtherTravel = 1.5;  // times the other one: a change

/// A memory in its smallest form, by its columns among those of the record.
struct PlainMemory {
  std::string effect;
  double travel_m{0.0};
  ColumnSet columns;
};

/// Columns that stand beside the memory, and the memory's own.
struct PlainMemories {
  std::vector<Regressor> columns;
  Eigen::Index base{0};
  std::vector<PlainMemory> all;
  [[nodiscard]] Eigen::Index own() const {
    return static_cast<Eigen::Index>(columns.size()) - base;
  }
};

PlainMemories forms_of(const Library& library, const std::vector<Regressor>& base) {
  PlainMemories out{base, static_cast<Eigen::Index>(base.size()), {}};
  std::vector<double> travels;
  for (const Candidate& c : library.candidates)
    if (is_memory(c.effect)) travels.push_back(c.place);
  std::sort(travels.begin(), travels.end());
  travels.erase(std::unique(travels.begin(), travels.end()), travels.end());
  for (const Candidate& c : library.candidates) {
    if (!is_memory(c.effect)) continue;
    const auto number = static_cast<std::size_t>(
        std::lower_bound(travels.begin(), travels.end(), c.place) - travels.begin());
    if (number % kEveryTravel != 0) continue;
    PlainMemory form{c.effect, c.place, {}};
    for (const Eigen::Index i : c.columns) {
      form.columns.push_back(out.own());
      out.columns.push_back(library.at(i));
    }
    out.all.push_back(std::move(form));
  }
  return out;
}

/// No more rows than are needed.
Equations equations_of_one(const PlainMemories& forms, const Series& record) {
  Equations all = std::move(equations_of(forms.columns, {record}).front());
  const Eigen::Index stride = all.values.rows() / kMostRowsOfTwo + 1;
  Equations out;
  for (Eigen::Index i = 0; i < all.values.rows(); i += stride)
    out.sample.push_back(all.sample[static_cast<std::size_t>(i)]);
  out.values = all.values(Eigen::seq(0, all.values.rows() - 1, stride), Eigen::all);
  const Eigen::VectorXd force = out.values.rightCols<1>();
  out.weight = 1.0 / (force.array() - force.mean()).square().sum();
  return out;
}

/// Every memory before a moment and after it, each by itself.
class MemoryInTwoParts {
 public:
  MemoryInTwoParts(const PlainMemories& forms, const Equations& whole, const Series& record,
                   double at_share)
      : forms_{forms}, regression_{{parted(forms, whole, record, at_share)}} {}

  [[nodiscard]] Fit fit(const PlainMemory& before, const PlainMemory& after) const {
    ColumnSet set;
    for (Eigen::Index i = 0; i < forms_.base; ++i) set.push_back(i);
    for (const Eigen::Index i : before.columns) set.push_back(forms_.base + i);
    for (const Eigen::Index i : after.columns) set.push_back(forms_.base + forms_.own() + i);
    Fit out = regression_.fit(set, 0.0);
    // Friction that drives is none.
    const Eigen::Index first = forms_.base;
    const auto second = first + static_cast<Eigen::Index>(before.columns.size());
    out.ok = out.ok && out.theta[first] > 0.0 && out.theta[second] > 0.0;
    return out;
  }

 private:
  static Equations parted(const PlainMemories& forms, const Equations& whole, const Series& record,
                          double at_share) {
    Equations out{{}, whole.sample, whole.weight};
    const Eigen::Index own = forms.own();
    out.values.resize(whole.values.rows(), forms.base + 2 * own + 1);
    out.values.leftCols(forms.base) = whole.values.leftCols(forms.base);
    out.values.rightCols<1>() = whole.values.rightCols<1>();
    for (Eigen::Index i = 0; i < whole.values.rows(); ++i) {
      const auto sample = static_cast<double>(whole.sample[static_cast<std::size_t>(i)]);
      const bool after = sample > at_share * static_cast<double>(record.size() - 1);
      const auto memory = whole.values.row(i).segment(forms.base, own);
      out.values.row(i).segment(forms.base, own) = (after ? 0.0 : 1.0) * memory;
      out.values.row(i).segment(forms.base + own, own) = (after ? 1.0 : 0.0) * memory;
    }
    return out;
  }

  const PlainMemories& forms_;
  Regression regression_;
};

/// What leaves least: with one travel, and with two.
struct BestOfEffect {
  Fit one;
  MemoryChange two;
};

/// One effect, changing at one moment.
void try_effect(const PlainMemories& forms, const MemoryInTwoParts& parts,
                const std::string& effect, double at_share, BestOfEffect& found) {
  std::vector<const PlainMemory*> of_effect;
  for (const PlainMemory& form : forms.all)
    if (form.effect == effect) of_effect.push_back(&form);
  if (of_effect.empty()) return;
  std::array<const PlainMemory*, 2> best{of_effect.front(), of_effect.front()};
  Fit least;
  for (const PlainMemory* form : of_effect) {
    Fit fit = parts.fit(*form, *form);
    if (!fit.beats(least)) continue;
    least = std::move(fit);
    best = {form, form};
  }
  if (least.beats(found.one)) found.one = least;
  for (int n = 0; n < 2 * kTurns; ++n) {
    const auto side = static_cast<std::size_t>(n % 2);
    for (const PlainMemory* form : of_effect) {
      std::array<const PlainMemory*, 2> now = best;
      now[side] = form;
      Fit fit = parts.fit(*now[0], *now[1]);
      if (!fit.beats(least)) continue;
      least = std::move(fit);
      best = now;
    }
  }
  if (least.beats(found.two.fit))
    found.two = {effect, best[0]->travel_m, best[1]->travel_m, at_share, std::move(least)};
}

bool travels_differ(double one_m, double other_m) {
  return std::max(one_m, other_m) > kOtherTravel * std::min(one_m, other_m);
}

}  // namespace

std::optional<MemoryChange> change_of_memory(const Library& library,
                                             const std::vector<Regressor>& base,
                                             const Series& record, const Fit& known) {
  const PlainMemories forms = forms_of(library, base);
  if (forms.all.empty()) return std::nullopt;
  const Equations whole = equations_of_one(forms, record);
  std::array<BestOfEffect, 2> found;
  const std::array<std::string, 2> effects{"backlash", "presliding_hysteresis"};
  for (int place = 1; place < kPlacesOfChange; ++place) {
    const double at_share = static_cast<double>(place) / kPlacesOfChange;
    const MemoryInTwoParts parts{forms, whole, record, at_share};
    for (std::size_t e = 0; e < effects.size(); ++e)
      try_effect(forms, parts, effects[e], at_share, found[e]);
  }
  MemoryChange out = found[found[1].two.fit.beats(found[0].two.fit) ? 1 : 0].two;
  const Fit& one = found[0].one.beats(found[1].one) ? found[0].one : found[1].one;
  if (!out.fit.ok || !one.ok || !travels_differ(out.before_m, out.after_m)) return std::nullopt;
  if (!is_clearly_better(out.fit, one)) return std::nullopt;
  if (out.fit.held_out_nmse > kBetter * known.held_out_nmse ||
      block_t(known, out.fit) < kSignificant)
    return std::nullopt;
  return out;
}

}  // namespace dampline::app::rig
