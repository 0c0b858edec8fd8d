// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>

#include "dampline/guard/pair_spectra.hpp"
#include "dampline/motion/anti_alias.hpp"

namespace dampline {

/// Follows from block to block by how much the frame lags a reference channel, against the transfer
/// of the blocks before, whose own lags are taken out. Bin by bin, in three passes over a band.
class LagTracker {
 public:
  using Complex = std::complex<double>;
  struct Bin {
    Complex cross{};    ///< conj(reference channel) times frame
    double frame{0.0};  ///< powers
    double channel{0.0};
    [[nodiscard]] double coherence() const noexcept;
  };

  explicit LagTracker(double sample_rate_hz) noexcept : rate_hz_{sample_rate_hz} {}
  void start() noexcept;
  /// First pass: the spectrum of the whitened correlation with the reference.
  [[nodiscard]] Complex whitened(std::size_t k, const Bin& bin) noexcept;
  /// Then: the correlation at whole lags round the lag of the block before.
  template <class Correlation>
  void find_peak(const Correlation& at) noexcept {
    const int expected = expected_samples();
    lag_samples_ = expected;
    for (int lag = expected - kReach; lag <= expected + kReach; ++lag) {
      if (at(lag) > at(lag_samples_)) lag_samples_ = lag;
    }
    if (adopts_) lag_samples_ = 0;
  }
  /// Second pass: the slope of what phase is left.
  void add_phase(std::size_t k, const Bin& bin) noexcept;
  void conclude(double bins_in_band) noexcept;
  /// Third pass: the block joins the reference.
  void learn(std::size_t k, const Bin& bin) noexcept;
  /// Begins anew with the next block.
  void forget() noexcept { has_reference_ = false; }

  [[nodiscard]] bool valid() const noexcept { return valid_; }
  [[nodiscard]] double lag_s() const noexcept { return lag_s_; }

 private:
  static constexpr int kReach = 2;  // samples by which the lag may move in a block
  [[nodiscard]] int expected_samples() const noexcept;
  [[nodiscard]] Complex turned(std::size_t k, double lag_s, const Complex& x) const noexcept;
  [[nodiscard]] double hz(std::size_t k) const noexcept {
    return static_cast<double>(k) * rate_hz_ / static_cast<double>(Fourier512::kSize);
  }

  double rate_hz_;
  SpectrumSums::Cross reference_{};
  bool has_reference_{false};
  bool adopts_{false};  // this block becomes the reference
  bool valid_{false};
  int lag_samples_{0};
  double lag_s_{0.0};
  double coherence_{0.0};
  double phase_{0.0};
  double weight_{0.0};
};

/// What the spectra of one block say. Powers are spectral densities, one-sided.
struct BlockFigures {
  std::int64_t first_tick{0};
  std::int64_t last_tick{0};
  double density{0.0};         ///< (m/s^2)^2/Hz of a unit of the block's sums
  int delay{0};                ///< samples by which wheelset 1 was delayed
  double coherent_share{0.0};  ///< of the bins of 4-90 Hz: the wheelsets' coherence is above 0.4
  double match{0.0};        ///< signed peak of the whitened correlation of the wheelsets, 1 at most
  int match_delay{0};       ///< its place: samples by which wheelset 2 is later
  double at_once{0.0};      ///< the largest magnitude of that correlation within two samples of 0
  double delay_s{0.0};      ///< of wheelset 2, where it is coherent and aligned
  double log_gain{0.0};     ///< ln of the gain of wheelset 1 over wheelset 2, 4-90 Hz, mean of bins
  double frame_power{0.0};  ///< power of the frame over that of a wheelset, 40-100 Hz
  double wheelset_mps2{0.0};       ///< rms of the wheelsets, 4-90 Hz
  std::array<double, 2> follow{};  ///< sign: the frame follows this wheelset below resonance
  double following{0.0};           ///< real part of the transfer to the frame below resonance
  /// The frame's fast motion is coherent with the wheelsets'; then by how much it lags, more than
  /// in the blocks before: their mean, wheelset 1, wheelset 2.
  bool has_lag{false};
  std::array<double, 3> lag_s{};
  /// Share of the wheelsets' power at 45-85 Hz that they do not have in common: wheels and contact
  /// that differ, not noise.
  double incoherent_share{0.0};
  std::array<double, kChannels> noise{};  ///< white part, (m/s^2)^2/Hz
  double folded_share{0.0};   ///< of the wheelsets' noise: motion that is folded at half the rate
  double frame_in_band{0.0};  ///< all of the frame where its noise is looked for, (m/s^2)^2/Hz
  /// What a wheelset does not share at 110-126 Hz and is not noise, (m/s^2)^2/Hz.
  double incoherent{0.0};
};

/// Turns the sums of a block into its figures, a few bins a call.
class BlockSurvey {
 public:
  BlockSurvey(double sample_rate_hz, const AntiAliasConfig& anti_alias) noexcept;

  /// `sums` must stay as it is until done.
  void start(const SpectrumSums& sums) noexcept;
  [[nodiscard]] bool busy() const noexcept { return stage_ != Stage::kDone; }
  /// A slice of the work; true when figures() has just become those of the block.
  bool advance() noexcept;
  [[nodiscard]] const BlockFigures& figures() const noexcept { return figures_; }
  /// The block's.
  [[nodiscard]] const SpectrumSums& sums() const noexcept { return *block_; }
  /// How much each bin's phase says of the delay between the wheelsets.
  [[nodiscard]] const PairSpectra::Weights& weights() const noexcept { return weights_; }
  /// The frame's lag is measured against what follows, not against what came before.
  void forget_lag() noexcept {
    for (LagTracker& lag : lags_) lag.forget();
  }

 private:
  static constexpr std::size_t kSlice = 16;
  enum class Stage : std::uint8_t { kDone, kPower, kLoad, kTransform, kPeak, kPhase, kReference };
  struct Sums {
    double coherent{0.0};
    double phase{0.0}, phase_weight{0.0};
    double power1{0.0}, power2{0.0}, log_ratio{0.0};
    double frame_fast{0.0}, wheelset_fast{0.0};
    std::array<double, 2> follow{};
    double follow_weight{0.0};
    WhiteAndFolded frame;
    std::array<double, 2> fast{}, edge{};  // of the wheelsets
    double shared_fast{0.0}, fast_weight{0.0};
    WhiteAndFolded apart;                    // of what the wheelsets do not share
    double middle{0.0}, shared_middle{0.0};  // of both wheelsets
  };

  void power(std::size_t k) noexcept;
  void load(std::size_t k) noexcept;
  void phase(std::size_t k) noexcept;
  void learn(std::size_t k) noexcept;
  void find_peaks() noexcept;
  void conclude_power() noexcept;
  void conclude_noise(double density) noexcept;
  void conclude_lag() noexcept;
  [[nodiscard]] LagTracker::Bin lag_bin(std::size_t which, std::size_t k) const noexcept;
  [[nodiscard]] SpectrumBand band(double low_hz, double high_hz) const noexcept {
    return SpectrumBand::between(low_hz, high_hz, rate_hz_);
  }
  [[nodiscard]] double hz(std::size_t k) const noexcept { return static_cast<double>(k) * bin_hz_; }

  double rate_hz_;
  double bin_hz_;
  bool folds_;  // and it is known how
  SpectrumBand shared_, follow_, fast_, lag_, middle_, noise_, incoherent_, apart_, edge_;
  std::array<double, kSpectrumBins> alias_shape_{};   // of friction's leaps: what is folded, too
  std::array<double, kSpectrumBins> folded_shape_{};  // of the wheelsets' motion
  const SpectrumSums* block_{nullptr};
  Stage stage_{Stage::kDone};
  std::size_t cursor_{0};
  Sums s_{};
  BlockFigures figures_{};
  PairSpectra::Weights weights_{};
  Fourier512 correlation_;
  int round_{0};  // of two: match and mean lag, then the lags behind either wheelset
  std::array<LagTracker, 3> lags_;
};

}  // namespace dampline
