// SPDX-License-Identifier: MIT
#include "app/explain/residual_maps.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::app {
namespace {

constexpr double kMapReach = 2.5;      // of the motion's size: cells beyond take what lies outside
constexpr double kFirstTravel = 0.05;  // of the size; each further cell half as long again
constexpr double kTravelRatio = 1.5;
constexpr std::size_t kMostWaiting = 2000;

std::size_t cell_of(double x, std::size_t side) {
  const double u = 0.5 * (std::clamp(x / kMapReach, -1.0, 1.0) + 1.0) * static_cast<double>(side);
  return std::min(static_cast<std::size_t>(u), side - 1);
}

/// Share of the energy that each half's cell means explain of the other half.
template <class Map>
double share_of(const Map& map) {
  double energy = 0.0;
  double left = 0.0;
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t c = 0; c < map[half].size(); ++c) {
      const auto& here = map[half][c];
      const auto& other = map[1 - half][c];
      const double mean = other.count > 0.0 ? other.sum / other.count : 0.0;
      energy += here.squares;
      left += here.squares - 2.0 * mean * here.sum + here.count * mean * mean;
    }
  }
  return energy > 0.0 ? std::max(1.0 - left / energy, 0.0) : 0.0;
}

}  // namespace

std::size_t ResidualMaps::surface_cell(const EvidencePoint& point) const {
  return kSide * cell_of(point.deflection_m / deflection_m_, kSide) +
         cell_of(point.velocity_mps / velocity_mps_, kSide);
}

/// Gives the waiting points to the present direction.
void ResidualMaps::settle() {
  for (const Waiting& w : waiting_) {
    const double travel = std::abs(w.deflection_m - turned_m_) / (kFirstTravel * deflection_m_);
    const double steps = travel > 1.0 ? 1.0 + std::log(travel) / std::log(kTravelRatio) : 0.0;
    const auto cell = std::min(static_cast<std::size_t>(steps), kTravels - 1);
    travel_[w.half][cell + (up_ ? kTravels : 0)].absorb(w.left_n);
  }
  waiting_.clear();
}

void ResidualMaps::add(const EvidencePoint& point) {
  const double y = point.deflection_m;
  if (!moving_) {
    moving_ = true;
    extreme_m_ = turned_m_ = y;
  }
  const auto half = static_cast<std::size_t>(std::fmod(std::floor(point.time_s / half_s_), 2.0));
  surface_[half][surface_cell(point)].absorb(point.after_n());
  waiting_.push_back({y, point.after_n(), half});
  if (up_ ? y > extreme_m_ : y < extreme_m_) {
    extreme_m_ = y;
    settle();
  } else if (std::abs(y - extreme_m_) > turn_m_) {
    turned_m_ = extreme_m_;
    extreme_m_ = y;
    up_ = !up_;
    settle();
  } else if (waiting_.size() >= kMostWaiting) {
    settle();
  }
}

void ResidualMaps::describe(Signature& out) const {
  out.surface_share = share_of(surface_);
  out.travel_share = share_of(travel_);
  double odd = 0.0;
  double even = 0.0;
  for (std::size_t c = 0; c < surface_[0].size(); ++c) {
    const std::size_t m = surface_[0].size() - 1 - c;
    const double n = surface_[0][c].count + surface_[1][c].count;
    const double opposite_n = surface_[0][m].count + surface_[1][m].count;
    if (n == 0.0 || opposite_n == 0.0) continue;
    const double here = (surface_[0][c].sum + surface_[1][c].sum) / n;
    const double opposite = (surface_[0][m].sum + surface_[1][m].sum) / opposite_n;
    odd += n * (here - opposite) * (here - opposite);
    even += n * (here + opposite) * (here + opposite);
  }
  if (odd + even > 0.0) out.odd_share = odd / (odd + even);
}

}  // namespace dampline::app
