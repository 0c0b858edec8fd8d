// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "app/fleet/page/view.hpp"

namespace dampline::app::fleet::page {
namespace {

using Key = std::tuple<std::string, double, std::string_view>;  // load, mass, quantity

Key key_of(const Load& load, std::string_view quantity) {
  return {load.name, load.moving_mass_kg, quantity};
}

/// As views.sql has it.
Norm norm_of(const Key& key, std::string_view unit, std::vector<double> values) {
  constexpr double kStdByQuartiles = 0.7413;  // of what is normally distributed
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const auto at = [&](std::size_t place) { return values[place - 1]; };
  Norm out;
  out.load = {std::get<0>(key), std::get<1>(key)};
  out.quantity = std::get<2>(key);
  out.unit = unit;
  out.trucks = static_cast<std::int64_t>(n);
  out.median = (at((n + 1) / 2) + at((n + 2) / 2)) / 2.0;
  out.scatter = kStdByQuartiles * (at(n + 1 - (n + 3) / 4) - at((n + 3) / 4));
  return out;
}

}  // namespace

std::vector<Norm> norms_of(const std::vector<TruckFigures>& trucks) {
  std::vector<Norm> out;
  for (std::size_t i = 0; i < kQuantities.size(); ++i) {
    std::map<Key, std::vector<double>> values;
    for (const TruckFigures& truck : trucks)
      if (truck.values[i])
        values[key_of(truck.load, kQuantities[i].name)].push_back(truck.values[i]->value);
    for (auto& [key, list] : values)
      out.push_back(norm_of(key, kQuantities[i].unit, std::move(list)));
  }
  std::stable_sort(out.begin(), out.end(), [](const Norm& a, const Norm& b) {
    return std::make_tuple(-a.trucks, std::cref(a.load.name), a.load.moving_mass_kg) <
           std::make_tuple(-b.trucks, std::cref(b.load.name), b.load.moving_mass_kg);
  });
  return out;
}

std::vector<Outlier> outliers_of(const std::vector<TruckFigures>& trucks,
                                 const std::vector<Norm>& norms) {
  std::map<Key, const Norm*> known;
  for (const Norm& norm : norms) known[key_of(norm.load, norm.quantity)] = &norm;
  std::vector<Outlier> out;
  for (const TruckFigures& truck : trucks)
    for (std::size_t i = 0; i < kQuantities.size(); ++i) {
      if (!truck.values[i]) continue;
      const Norm& norm = *known.at(key_of(truck.load, kQuantities[i].name));
      const Estimate value = *truck.values[i];
      const double apart = value.value - norm.median;
      const double std = std::sqrt(value.std * value.std + norm.scatter * norm.scatter);
      if (norm.trucks < kLeastTrucks || !(std::abs(apart) > kOutlierDeviations * std)) continue;
      out.push_back({truck.vehicle, truck.truck, truck.load, norm.quantity, norm.unit, value,
                     norm.median, norm.scatter, apart / std, truck.last_contact_utc});
    }
  std::sort(out.begin(), out.end(), [](const Outlier& a, const Outlier& b) {
    return std::make_tuple(-std::abs(a.deviations), std::cref(a.vehicle), std::cref(a.truck)) <
           std::make_tuple(-std::abs(b.deviations), std::cref(b.vehicle), std::cref(b.truck));
  });
  return out;
}

}  // namespace dampline::app::fleet::page
