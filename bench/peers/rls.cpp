// SPDX-License-Identifier: MIT
// Recursive least squares by the project and by other libraries: the same rows, time per row, and
// whether the answer is the same. `peers_rls [--json FILE] [--rows FILE]`: --rows writes 32
// unknowns' rows and answer for least_squares.py; see bench/README.md.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "bench/peers/estimators.hpp"
#include "bench/peers/timing.hpp"

namespace dampline::bench {
namespace {

constexpr std::size_t kRows = 20'000;
constexpr int kRounds = 9;
constexpr double kSameAnswer = 1e-9;

struct Result {
  std::map<int, double> ns;          // by number of unknowns
  std::map<int, double> difference;  // from the project's answer, largest
  bool single{false};                // single precision
};
using Results = std::vector<std::pair<std::string, Result>>;

Result& find(Results& results, const std::string& name) {
  for (auto& [known, result] : results)
    if (known == name) return result;
  return results.emplace_back(name, Result{}).second;
}

/// Races all estimators of N unknowns, without forgetting, from the same prior.
template <int N>
class Race {
 public:
  explicit Race(Results& results) : results_{results} {}

  void run() {
    enter<Ours<N>>("dampline");
    enter<OursSolved<N>>("dampline, solved after every row");
    enter<EigenCovariance<N>>("Eigen, covariance recursion");
    enter<EigenSymmetric<N>>("Eigen, one triangle of the covariance");
#ifdef DAMPLINE_HAS_DLIB
    enter<Dlib<N>>("dlib::rls");
#endif
#ifdef DAMPLINE_HAS_ARMADILLO
    enter<Armadillo<N>>("Armadillo, covariance recursion");
#endif
#ifdef DAMPLINE_HAS_LIQUID
    enter<Liquid<N>>("liquid eqrls_rrrf", true);
#endif
    race(contestants_, kRounds);
    for (std::size_t i = 0; i < contestants_.size(); ++i) {
      Result& result = find(results_, contestants_[i].name);
      result.ns[N] = contestants_[i].best_ns / static_cast<double>(kRows);
      result.difference[N] = (answers_[i] - answers_[0]).cwiseAbs().maxCoeff();
      result.single = single_[i];
    }
  }

 private:
  template <class Estimator>
  void enter(const char* name, bool single = false) {
    const std::size_t place = contestants_.size();
    answers_.push_back(Column<N>::Zero());
    single_.push_back(single);
    contestants_.push_back({name, [this, place] {
                              Estimator estimator{1.0};
                              for (std::size_t i = 0; i < kRows; ++i)
                                estimator.absorb(problem_.x[i], problem_.y[i]);
                              answers_[place] = estimator.answer();
                            }});
  }

  Results& results_;
  Problem<N> problem_{kRows};
  std::vector<Contestant> contestants_;
  std::vector<Column<N>> answers_;
  std::vector<bool> single_;
};

/// False where a peer in double precision has another answer.
bool print(const Results& results) {
  bool same = true;
  fmt::print(
      "| least squares, ns per row | n = 8 | n = 16 | n = 32 | times dampline | "
      "largest difference of the answer |\n|--|--|--|--|--|--|\n");
  const auto& ours = results.front().second.ns;
  for (const auto& [name, result] : results) {
    double difference = 0.0;
    for (const auto& [n, d] : result.difference) difference = std::fmax(difference, d);
    const bool agrees = result.single || difference < kSameAnswer;
    same = same && agrees;
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.1f}, {:.1f}, {:.1f} | {:.1e}{} |\n", name,
               result.ns.at(8), result.ns.at(16), result.ns.at(32), result.ns.at(8) / ours.at(8),
               result.ns.at(16) / ours.at(16), result.ns.at(32) / ours.at(32), difference,
               result.single ? ", single precision" : (agrees ? "" : " (!)"));
  }
  return same;
}

void write_json(const Results& results, const std::string& path) {
  nlohmann::json out;
  for (const auto& [name, result] : results)
    for (const auto& [n, ns] : result.ns)
      out["least_squares"].push_back({{"name", name},
                                      {"unknowns", n},
                                      {"ns_per_row", ns},
                                      {"difference", result.difference.at(n)}});
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
  Results results;
  Race<8>{results}.run();
  Race<16>{results}.run();
  Race<32>{results}.run();
  const bool same = print(results);
  std::fputs(missing_peers(), stdout);
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--json") write_json(results, argv[i + 1]);
    if (option == "--rows") write_rows(argv[i + 1]);
  }
  return same ? 0 : 1;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
