// SPDX-License-Identifier: MIT
// Recursive least squares as each library's users call it, behind one shape: a class template over
// the number of unknowns with absorb(x, y) and answer().
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <memory>

#include "bench/peers/rows.hpp"
#include "published/wavelet/estimates.hpp"

#ifdef DAMPLINE_HAS_DLIB
#include <dlib/svm.h>
#endif
#ifdef DAMPLINE_HAS_LIQUID
#include <liquid/liquid.h>
#endif
#ifdef DAMPLINE_HAS_ARMADILLO
#include <armadillo>
#endif

namespace dampline::bench {

/// The project's: square-root information. `forgetting`: weight of the past at every row, 1: none.
template <int N>
class Ours {
 public:
  explicit Ours(double forgetting)
      : estimate_{forgetting < 1.0 ? -1.0 / std::log(forgetting) : 0.0} {
    for (int i = 0; i < N; ++i) {
      typename RecursiveEstimate<N>::Factor::Row prior;
      prior.setZero();
      prior[i] = 1.0 / std::sqrt(kPriorVariance);
      estimate_.absorb(prior);
    }
  }
  void absorb(const Column<N>& x, double y) noexcept {
    typename RecursiveEstimate<N>::Factor::Row row;
    row << x, y;
    estimate_.absorb(row);
  }
  [[nodiscard]] Column<N> answer() const noexcept {
    Column<N> theta = Column<N>::Constant(std::nan(""));
    static_cast<void>(estimate_.information().solve(theta));
    return theta;
  }

 private:
  mutable RecursiveEstimate<N> estimate_;  // rows wait in it until somebody asks
};

/// The same, fed as the Estimator feeds it: rows of a standstill are left out, and with them the
/// forgetting.
template <int N>
class OursGated : public Ours<N> {
 public:
  using Ours<N>::Ours;
  void absorb(const Column<N>& x, double y) noexcept {
    if (x.squaredNorm() > 1e-12) Ours<N>::absorb(x, y);
  }
};

/// The same, with the parameters known after every row.
template <int N>
class OursSolved : public Ours<N> {
 public:
  using Ours<N>::Ours;
  void absorb(const Column<N>& x, double y) noexcept {
    Ours<N>::absorb(x, y);
    theta_ = Ours<N>::answer();
  }
  [[nodiscard]] Column<N> answer() const noexcept { return theta_; }

 private:
  Column<N> theta_;
};

/// The textbook's covariance recursion on fixed-size matrices.
template <int N>
class EigenCovariance {
 public:
  explicit EigenCovariance(double forgetting) : forgetting_{forgetting} {}
  void absorb(const Column<N>& x, double y) noexcept {
    const Column<N> px = p_ * x;
    const double denominator = forgetting_ + x.dot(px);
    theta_ += px * ((y - x.dot(theta_)) / denominator);
    p_.noalias() -= px * (px.transpose() / denominator);
    if (forgetting_ < 1.0) p_ *= per_forgetting_;
  }
  [[nodiscard]] Column<N> answer() const noexcept { return theta_; }

 private:
  double forgetting_;
  double per_forgetting_{1.0 / forgetting_};
  Eigen::Matrix<double, N, N> p_ = kPriorVariance * Eigen::Matrix<double, N, N>::Identity();
  Column<N> theta_ = Column<N>::Zero();
};

/// The same, but only one triangle is updated and read, so that the matrix cannot lose its
/// symmetry.
template <int N>
class EigenSymmetric {
 public:
  explicit EigenSymmetric(double forgetting) : forgetting_{forgetting} {}
  void absorb(const Column<N>& x, double y) noexcept {
    const Column<N> px = p_.template selfadjointView<Eigen::Lower>() * x;
    const double denominator = forgetting_ + x.dot(px);
    theta_ += px * ((y - x.dot(theta_)) / denominator);
#ifndef __clang_analyzer__  // which takes the stack memory in there for memory of the heap
    p_.template selfadjointView<Eigen::Lower>().rankUpdate(px, -1.0 / denominator);
#endif
    if (forgetting_ < 1.0) p_ *= per_forgetting_;
  }
  [[nodiscard]] Column<N> answer() const noexcept { return theta_; }

 private:
  double forgetting_;
  double per_forgetting_{1.0 / forgetting_};
  Eigen::Matrix<double, N, N> p_ = kPriorVariance * Eigen::Matrix<double, N, N>::Identity();
  Column<N> theta_ = Column<N>::Zero();
};

#ifdef DAMPLINE_HAS_DLIB
/// `kForgetPrior`: dlib's third argument; its default keeps the prior alive.
template <int N, bool kForgetPrior>
class DlibBase {
 public:
  explicit DlibBase(double forgetting) : rls_{forgetting, kPriorVariance, kForgetPrior} {}
  void absorb(const Column<N>& x, double y) {
    for (int i = 0; i < N; ++i) x_(i) = x[i];
    rls_.train(x_, y);
  }
  [[nodiscard]] Column<N> answer() const {
    Column<N> out;
    for (int i = 0; i < N; ++i) out[i] = rls_.get_w()(i);
    return out;
  }

 private:
  dlib::rls rls_;
  dlib::matrix<double, N, 1> x_;
};
template <int N>
using Dlib = DlibBase<N, false>;
template <int N>
using DlibForgetful = DlibBase<N, true>;
#endif

#ifdef DAMPLINE_HAS_LIQUID
/// Single precision; made for filters, so that a row is pushed value by value.
template <int N>
class Liquid {
 public:
  explicit Liquid(double forgetting) : rls_{eqrls_rrrf_create(nullptr, N), eqrls_rrrf_destroy} {
    eqrls_rrrf_set_bw(rls_.get(), static_cast<float>(forgetting));
  }
  void absorb(const Column<N>& x, double y) {
    for (int i = 0; i < N; ++i) eqrls_rrrf_push(rls_.get(), static_cast<float>(x[i]));
    float predicted = 0.0F;
    eqrls_rrrf_execute(rls_.get(), &predicted);
    eqrls_rrrf_step(rls_.get(), static_cast<float>(y), predicted);
  }
  [[nodiscard]] Column<N> answer() const {
    Eigen::Matrix<float, N, 1> newest_first;
    eqrls_rrrf_get_weights(rls_.get(), newest_first.data());
    return newest_first.reverse().template cast<double>();
  }

 private:
  std::unique_ptr<eqrls_rrrf_s, decltype(&eqrls_rrrf_destroy)> rls_;
};
#endif

#ifdef DAMPLINE_HAS_ARMADILLO
/// The same recursion as EigenCovariance; Armadillo has none of its own.
template <int N>
class Armadillo {
 public:
  explicit Armadillo(double forgetting) : forgetting_{forgetting} {}
  void absorb(const Column<N>& x, double y) {
    for (int i = 0; i < N; ++i) x_(static_cast<arma::uword>(i)) = x[i];
    const arma::vec px = p_ * x_;
    const double denominator = forgetting_ + arma::dot(x_, px);
    theta_ += px * ((y - arma::dot(x_, theta_)) / denominator);
    p_ -= px * (px.t() / denominator);
    if (forgetting_ < 1.0) p_ *= per_forgetting_;
  }
  [[nodiscard]] Column<N> answer() const { return Eigen::Map<const Column<N>>(theta_.memptr()); }

 private:
  double forgetting_;
  double per_forgetting_{1.0 / forgetting_};
  arma::mat p_ = kPriorVariance * arma::eye(N, N);
  arma::vec theta_ = arma::zeros(N);
  arma::vec x_ = arma::zeros(N);
};
#endif

/// One line for each library that was not there when this was built.
inline const char* missing_peers() noexcept {
  return ""
#ifndef DAMPLINE_HAS_DLIB
         "dlib::rls skipped: libdlib-dev is not installed\n"
#endif
#ifndef DAMPLINE_HAS_LIQUID
         "liquid-dsp skipped: libliquid-dev is not installed\n"
#endif
#ifndef DAMPLINE_HAS_ARMADILLO
         "Armadillo skipped: libarmadillo-dev is not installed\n"
#endif
#ifndef DAMPLINE_HAS_GSL
         "GSL skipped: libgsl-dev is not installed\n"
#endif
      ;
}

}  // namespace dampline::bench
