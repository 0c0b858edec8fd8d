// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "app/report/svg/figure.hpp"
#include "app/verify/printed/printed.hpp"
#include "dampline/density/paper_form.hpp"

namespace dampline::app {

/// One figure of Kisilowski and Urbanski (1987), or one that decides about their method, beside
/// what this program finds.
struct FokkerPlanckFigure {
  std::string quantity;   ///< with its unit
  std::string published;  ///< "-" where the publication gives none
  std::string computed;
  std::string remark;    ///< why the published figure is not met, or what the computed one shows
  bool promised{false};  ///< the program promises it, and ...
  bool met{true};        ///< ... keeps it
};

/// Mean over the runs of a load and their standard deviation.
struct OverRuns {
  double mean{0.0};
  double std{0.0};
};

/// A line of the publication's tables beside this program's; the last is the jump at v = 0.
struct PaperLine {
  double from_mps{0.0}, to_mps{0.0};
  OverRuns slope_nspm, force_n;
  const PrintedRow* published{nullptr};
};

/// The publication's 18 examples are nine a load.
inline constexpr std::uint64_t kRunsOfTable = 9;

/// A table in the form of the publication's Tables 1 and 2, of nine simulated runs with the forces
/// of its own jump at v = 0. `whole` and `excluded` are of one run.
struct PaperTable {
  std::string name;  ///< "1" laden, "2" empty
  std::string caption;
  double half_mass_kg{0.0};                       ///< force = half_mass_kg alpha
  std::array<double, 2> simulated_n{};            ///< magnitudes, [0]: v < 0
  PaperForm whole;                                ///< as published: v = 0 left in
  PaperForm excluded;                             ///< without the region around v = 0
  std::array<std::vector<PaperLine>, 2> lines{};  ///< [0]: v < 0
};

struct FokkerPlanckCases {
  std::vector<FokkerPlanckFigure> figures;
  std::array<PaperTable, 2> tables;
};

/// Simulates and estimates; some twenty seconds.
[[nodiscard]] FokkerPlanckCases fokker_planck_cases();

/// The publication's figures 2 and 3: damping force over velocity, what its table prints over what
/// is found, with the band of a run.
[[nodiscard]] Plot plot_table(const PaperTable& table);

}  // namespace dampline::app
