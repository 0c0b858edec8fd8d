// SPDX-License-Identifier: MIT
#include "app/predict/prediction.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/run/json.hpp"
#include "app/verbs/output.hpp"

namespace dampline::app {
namespace {

PredictionError error_of(const std::string& name, const std::string& unit,
                         const Eigen::VectorXd& values, const Eigen::VectorXd& std,
                         const Eigen::VectorXd& measured, Eigen::Index from) {
  PredictionError out{name, unit};
  double sum = 0.0;
  double squares = 0.0;
  double left = 0.0;
  double within = 0.0;
  for (Eigen::Index i = from; i < values.size(); ++i) {
    if (!std::isfinite(measured[i]) || !std::isfinite(values[i])) continue;
    const double apart = measured[i] - values[i];
    ++out.samples;
    sum += measured[i];
    squares += measured[i] * measured[i];
    left += apart * apart;
    within += std::abs(apart) <= 2.0 * std[i] ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(out.samples);
  if (out.samples == 0) return out;
  out.rms = std::sqrt(left / count);
  out.nmse = left / (squares - sum * sum / count);
  out.within_share = within / count;
  return out;
}

}  // namespace

Eigen::VectorXd deviation_of(const law::Document& document, const LawOutcome& outcome,
                             Eigen::Index size) {
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(size);
  const Eigen::Index n = document.covariance.rows();
  if (n == 0) return variance;
  const Eigen::VectorXd std = document.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd size_of = std.cwiseMax(1e-300);
  const Eigen::MatrixXd correlation = size_of.cwiseInverse().asDiagonal() * document.covariance *
                                      size_of.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes{correlation};
  const Eigen::VectorXd centre = document.values();
  for (Eigen::Index k = 0; k < n; ++k) {
    const double share = axes.eigenvalues()[k];
    if (!(share > 1e-12)) continue;
    const Eigen::VectorXd by =
        std::sqrt(share) * std.cwiseProduct(axes.eigenvectors().col(k)).eval();
    const Eigen::VectorXd up = outcome(document.with(centre + by));
    const Eigen::VectorXd down = outcome(document.with(centre - by));
    if (up.size() != size || down.size() != size)
      return Eigen::VectorXd::Constant(size, std::numeric_limits<double>::infinity());
    variance += (0.5 * (up - down)).cwiseAbs2();
  }
  return variance.cwiseSqrt();
}

void add_quantity(const std::string& name, const std::string& unit, const Eigen::VectorXd& values,
                  const Eigen::VectorXd& std, double left, const Eigen::VectorXd& measured,
                  Eigen::Index from, Prediction& out) {
  const Eigen::VectorXd all = (std.array().square() + left * left).sqrt();
  out.columns.push_back({name, values});
  out.columns.push_back({name + "_std", all});
  if (measured.size() != values.size()) return;
  out.columns.push_back({name + "_measured", measured});
  const PredictionError error = error_of(name, unit, values, all, measured, from);
  if (error.samples > 0) out.errors.push_back(error);
}

void write_prediction(const Prediction& prediction, const std::string& file, bool replace) {
  TextFile out{file, replace};
  const auto separator = [](std::size_t c) { return c == 0 ? "" : ","; };
  for (std::size_t c = 0; c < prediction.columns.size(); ++c)
    fmt::format_to(std::back_inserter(out.buffer()), "{}{}", separator(c),
                   prediction.columns[c].name);
  out.buffer().push_back('\n');
  for (Eigen::Index i = 0; i < prediction.columns.front().values.size(); ++i) {
    for (std::size_t c = 0; c < prediction.columns.size(); ++c) {
      const double value = prediction.columns[c].values[i];
      if (std::isfinite(value))
        fmt::format_to(std::back_inserter(out.buffer()), "{}{}", separator(c), value);
      else
        fmt::format_to(std::back_inserter(out.buffer()), "{}", separator(c));
    }
    out.buffer().push_back('\n');
    out.tick();
  }
  out.close();
}

std::string prediction_text(const Prediction& p) {
  std::string out = fmt::format("predicted: {}, {} samples at {:.6g} Hz, of {}\n", p.what,
                                p.columns.front().values.size(), p.sample_rate_hz, p.record);
  for (const PredictionError& e : p.errors)
    out += fmt::format(
        "error:     {} {:.3g} {} rms, nmse {:.3g}, rrse {:.3g}; {:.0f} % of {} samples within two "
        "deviations\n",
        e.quantity, e.rms, e.unit, e.nmse, std::sqrt(e.nmse), 100.0 * e.within_share, e.samples);
  if (p.errors.empty()) out += "error:     unknown, since the record does not hold the output\n";
  for (const std::string& note : p.notes) out += "note:      " + note + "\n";
  return out;
}

std::string prediction_json(const Prediction& p) {
  nlohmann::ordered_json errors = nlohmann::ordered_json::array();
  for (const PredictionError& e : p.errors)
    errors.push_back({{"quantity", e.quantity},
                      {"unit", e.unit},
                      {"samples", e.samples},
                      {"rms", e.rms},
                      {"nmse", e.nmse},
                      {"rrse", std::sqrt(e.nmse)},
                      {"within_two_deviations", e.within_share}});
  return json_text({{"predicted", p.what},
                    {"record", p.record},
                    {"sample_rate_hz", p.sample_rate_hz},
                    {"samples", p.columns.front().values.size()},
                    {"errors", std::move(errors)},
                    {"notes", p.notes}});
}

}  // namespace dampline::app
