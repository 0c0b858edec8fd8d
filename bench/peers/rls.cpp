// SPDX-License-Identifier: MIT
// Recursive least squares by the project and by other libraries, with forgetting and without: the
// same rows, time per row, and whether the answer is that of a batch solution. `peers_rls
// [--json FILE] [--rows FILE]`: --rows writes 32 unknowns' rows and answer for least_squares.py;
// see bench/README.md.
#include <fmt/format.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "bench/peers/estimators.hpp"
#include "bench/peers/rows.hpp"

namespace dampline::bench {
namespace {

constexpr std::size_t kRows = 20'000;
constexpr int kRounds = 9;
constexpr double kSameAnswer = 1e-9;
/// Weight of the past at every row: that of 2,000 rows, 6.7 s at 300 Hz, and of all of them.
constexpr std::array<double, 2> kForgetting{0.9995, 1.0};

enum class Answer : std::uint8_t {
  kExact,       ///< the batch solution's, to kSameAnswer
  kErrorsGrow,  ///< the same without forgetting; with it, rounding errors grow (see peers_robust)
  kSingle       ///< single precision
};

struct Result {
  std::map<int, double> ns;          // by number of unknowns
  std::map<int, double> difference;  // from the batch solution, largest
  Answer answer{Answer::kExact};
};
using Results = std::vector<std::pair<std::string, Result>>;

Result& find(Results& results, const std::string& name) {
  for (auto& [known, result] : results)
    if (known == name) return result;
  return results.emplace_back(name, Result{}).second;
}

/// Of the weighted rows and the prior all at once, by reflections. The prior fades as the rows do;
/// dlib::rls keeps its own alive, but pulls to its latest answer by it and not to zero, so that
/// after kRows the answers are 1.3e-10 apart at most.
template <int N>
Column<N> batch_solution(const Problem<N>& problem, double forgetting) {
  Eigen::MatrixXd rows(kRows + N, N);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kRows + N);
  const double fade = std::sqrt(forgetting);
  double weight = 1.0;
  for (Eigen::Index i = kRows - 1; i >= 0; --i, weight *= fade) {
    rows.row(i) = weight * problem.x[static_cast<std::size_t>(i)].transpose();
    right[i] = weight * problem.y[static_cast<std::size_t>(i)];
  }
  rows.bottomRows(N) = weight / std::sqrt(kPriorVariance) * Eigen::MatrixXd::Identity(N, N);
  return rows.householderQr().solve(right);
}

/// Races all estimators of N unknowns from the same prior.
template <int N>
class Race {
 public:
  Race(Results& results, double forgetting) : results_{results}, forgetting_{forgetting} {}

  void run() {
    enter<Ours<N>>("dampline");
    enter<OursSolved<N>>("dampline, solved after every row");
    enter<EigenCovariance<N>>("Eigen, covariance recursion", Answer::kErrorsGrow);
    enter<EigenSymmetric<N>>("Eigen, one triangle of the covariance");
#ifdef DAMPLINE_HAS_DLIB
    enter<Dlib<N>>("dlib::rls");
    if (forgetting_ < 1.0) enter<DlibForgetful<N>>("dlib::rls, forgetting its prior too");
#endif
#ifdef DAMPLINE_HAS_ARMADILLO
    enter<Armadillo<N>>("Armadillo, covariance recursion", Answer::kErrorsGrow);
#endif
#ifdef DAMPLINE_HAS_LIQUID
    enter<Liquid<N>>("liquid eqrls_rrrf", Answer::kSingle);
#endif
    race(contestants_, kRounds);
    const Column<N> batch = batch_solution(problem_, forgetting_);
    for (std::size_t i = 0; i < contestants_.size(); ++i) {
      Result& result = find(results_, contestants_[i].name);
      result.ns[N] = contestants_[i].best_ns / static_cast<double>(kRows);
      result.difference[N] = (answers_[i] - batch).cwiseAbs().maxCoeff();
      result.answer = kinds_[i];
    }
  }

 private:
  template <class Estimator>
  void enter(const char* name, Answer answer = Answer::kExact) {
    const std::size_t place = contestants_.size();
    answers_.push_back(Column<N>::Zero());
    kinds_.push_back(answer);
    contestants_.push_back({name, [this, place] {
                              Estimator estimator{forgetting_};
                              for (std::size_t i = 0; i < kRows; ++i)
                                estimator.absorb(problem_.x[i], problem_.y[i]);
                              answers_[place] = estimator.answer();
                            }});
  }

  Results& results_;
  double forgetting_;
  Problem<N> problem_{kRows};
  std::vector<Contestant> contestants_;
  std::vector<Column<N>> answers_;
  std::vector<Answer> kinds_;
};

Results race_all(double forgetting) {
  Results results;
  Race<8>{results, forgetting}.run();
  Race<16>{results, forgetting}.run();
  Race<32>{results, forgetting}.run();
  return results;
}

/// Whether `result` is held to the batch solution.
bool is_held(double forgetting, const Result& result) {
  return result.answer == Answer::kExact ||
         (result.answer == Answer::kErrorsGrow && forgetting == 1.0);
}

/// False where an answer that is held to the batch solution is another one.
bool print(double forgetting, const Results& results) {
  bool same = true;
  fmt::print(
      "| least squares, weight of the past {} a row, ns a row | n = 8 | n = 16 | n = 32 | times "
      "dampline | largest difference from the batch solution |\n|--|--|--|--|--|--|\n",
      forgetting);
  const auto& ours = results.front().second.ns;
  for (const auto& [name, result] : results) {
    double difference = 0.0;
    for (const auto& [n, d] : result.difference) difference = std::fmax(difference, d);
    const bool agrees = difference < kSameAnswer;
    same = same && (agrees || !is_held(forgetting, result));
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.1f}, {:.1f}, {:.1f} | {:.1e}{} |\n", name,
               result.ns.at(8), result.ns.at(16), result.ns.at(32), result.ns.at(8) / ours.at(8),
               result.ns.at(16) / ours.at(16), result.ns.at(32) / ours.at(32), difference,
               result.answer == Answer::kSingle ? ", single precision" : (agrees ? "" : " (!)"));
  }
  return same;
}

void write_json(const std::map<double, Results>& races, const std::string& path) {
  nlohmann::json out;
  for (const auto& [forgetting, results] : races)
    for (const auto& [name, result] : results)
      for (const auto& [n, ns] : result.ns)
        out["least_squares"].push_back({{"name", name},
                                        {"forgetting", forgetting},
                                        {"unknowns", n},
                                        {"ns_per_row", ns},
                                        {"difference", result.difference.at(n)},
                                        {"held", is_held(forgetting, result)}});
  std::ofstream{path} << out.dump(2) << '\n';
}

/// Rows [x, y] and then the project's answer, as doubles.
void write_rows(const std::string& path) {
  constexpr int kUnknowns = 32;
  const Problem<kUnknowns> problem{kRows};
  Ours<kUnknowns> estimator{1.0};
  std::ofstream file{path, std::ios::binary};
  const auto put = [&file](const double* first, std::size_t count) {
    file.write(reinterpret_cast<const char*>(first),
               static_cast<std::streamsize>(count * sizeof(double)));
  };
  for (std::size_t i = 0; i < kRows; ++i) {
    estimator.absorb(problem.x[i], problem.y[i]);
    put(problem.x[i].data(), kUnknowns);
    put(&problem.y[i], 1);
  }
  const Column<kUnknowns> answer = estimator.answer();
  put(answer.data(), kUnknowns);
}

int run(int argc, char** argv) {
  std::map<double, Results> races;
  bool same = true;
  for (const double forgetting : kForgetting) {
    races[forgetting] = race_all(forgetting);
    same = print(forgetting, races[forgetting]) && same;
  }
  std::fputs(missing_peers(), stdout);
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--json") write_json(races, argv[i + 1]);
    if (option == "--rows") write_rows(argv[i + 1]);
  }
  return same ? 0 : 1;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
