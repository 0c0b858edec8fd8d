// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "app/law/regressor.hpp"

namespace dampline::app::law {

/// A coefficient times a function of the motion. A sharp term has no width of its own: at
/// standstill it takes any value up to its level, so that the mass can stick.
struct Term {
  Regressor column;
  double coefficient{0.0};
  bool sharp{false};
};

/// m x'' + sum of terms = f. A law without a mass gives a force for a motion, and does not move.
struct Law {
  double mass_kg{0.0};
  std::vector<Term> terms;
};

/// A force between its samples, band-limited: eight times as many by a windowed sinc, a cubic
/// between those. Up to 0.3 of the sample rate to 1e-5 of it.
class Input {
 public:
  static constexpr Eigen::Index kFine = 8;

  /// At least two samples.
  Input(const Eigen::VectorXd& force_n, double interval_s);
  /// At `share` of the way from sample i to the next; precondition: 0 <= i < size() - 1.
  [[nodiscard]] double at(Eigen::Index i, double share) const noexcept;
  [[nodiscard]] double interval_s() const noexcept { return interval_s_; }
  [[nodiscard]] Eigen::Index size() const noexcept { return size_; }

 private:
  Eigen::Index size_;
  Eigen::VectorXd fine_n_;
  Eigen::VectorXd step_n_;  ///< slope times the fine interval
  double interval_s_;
};

inline constexpr std::size_t kMostMemories = 6;

/// Where the mass is, and what its terms remember.
struct State {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  std::array<double, kMostMemories> memory_m{};  ///< z of each stop, in the order of the terms
  std::array<double, kMostMemories> slip_m{};    ///< way since it slips
};

/// The stops and hysteresis that a law remembers by, each once.
[[nodiscard]] std::vector<Regressor> memories_of(const Law& law);

/// Moves the mass by the force alone. Classical Runge-Kutta steps between the instants at which the
/// velocity passes zero; there the mass sticks while the sharp terms hold it, and breaks away at
/// the instant at which they no longer do.
class FreeRun {
 public:
  /// Whether all terms can be moved: none that changes with time, and no mass on the mass.
  [[nodiscard]] static bool can(const Law& law) noexcept;
  /// Whether the samples see the law's own motion, a fourth of a turn each at most; the mass of a
  /// faster one follows its force at once.
  [[nodiscard]] static bool is_seen(const Law& law, double interval_s) noexcept;
  /// Precondition: can(law). `refinement`: times as many steps as are thought enough.
  FreeRun(const Law& law, const Input& input, int refinement = 1);
  /// From sample i to the next.
  void advance(Eigen::Index i, State& state) const noexcept;

 private:
  struct Rate {
    double x{0.0};
    double v{0.0};
    std::array<double, kMostMemories> z{};
  };
  struct Level {
    Kind kind;
    double coefficient;
    double per_speed;  ///< 1 / b
  };
  enum class Mode : std::int8_t { kBack = -1, kStuck = 0, kForth = 1 };

  [[nodiscard]] double level(double x, double v) const noexcept;
  [[nodiscard]] double smooth_force(double x, double v, const State& state) const noexcept;
  [[nodiscard]] double accel(const State& state, double force_n, Mode mode) const noexcept;
  [[nodiscard]] Rate rate(const State& state, double force_n, Mode mode) const noexcept;
  void place(const State& from, double dt_s, const Rate& rate, State& out) const noexcept;
  [[nodiscard]] State step(const State& from, double force_n, Eigen::Index i, double share,
                           double length, Mode mode) const noexcept;
  [[nodiscard]] State step_without_memory(const State& from, double force_n, double middle_n,
                                          double end_n, double dt_s, Mode mode) const noexcept;
  [[nodiscard]] Mode mode_of(const State& state, double force_n) const noexcept;
  [[nodiscard]] double until_turned(const State& from, double force_n, Eigen::Index i, double share,
                                    double length, Mode mode, State& at) const noexcept;
  [[nodiscard]] double until_free(const State& stuck, Eigen::Index i, double share,
                                  double length) const noexcept;

  const Law& law_;
  const Input& input_;
  double per_mass_;
  // Terms that ask for no function are summed; the others by their places.
  double held_n_{0.0};  ///< level of friction that depends on nothing
  double constant_n_{0.0};
  double spring_npm_{0.0};
  double damper_nspm_{0.0};
  std::vector<Level> sharp_;
  std::vector<std::size_t> smooth_;
  std::vector<Regressor> memories_;     ///< what the terms remember; like terms share one
  std::vector<std::size_t> memory_of_;  ///< of each term, where it has one
  bool turns_{false};                   ///< a term cares at which instant the velocity passes zero
  int steps_{1};
};

/// How a law moves.
struct Course {
  bool whole{false};  ///< otherwise it ran away, and what follows the last sample is missing
  Eigen::VectorXd deflection_m;
  Eigen::VectorXd velocity_mps;
};

/// From the first sample of the input to its last. Precondition: FreeRun::can(law).
[[nodiscard]] Course move(const Law& law, const Input& input, State state, int refinement = 1);

}  // namespace dampline::app::law
