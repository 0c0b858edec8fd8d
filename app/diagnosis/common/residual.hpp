// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/run/result.hpp"
#include "dampline/numeric/fourier.hpp"

namespace dampline::app {

/// Signals beside the force with which a residual may be coherent.
inline constexpr std::size_t kEvidenceChannels = 3;

/// One instant of a record that was explained.
struct EvidencePoint : LoopRow {
  std::array<double, kEvidenceChannels> channel{};

  [[nodiscard]] double before_n() const noexcept { return measured_n - base_n; }
  [[nodiscard]] double after_n() const noexcept { return measured_n - final_n; }
};

/// What is left of the force after everything that was found: what it looks like and where it is.
/// Shares are of the residual's energy, each from a map that was filled on the other half of the
/// record, so that noise gives none.
struct Signature {
  double rms_n{0.0};
  double surface_share{0.0};  ///< a function of y and v explains it
  double odd_share{0.0};      ///< of that surface's energy, under (y, v) -> (-y, -v); else even
  double travel_share{0.0};   ///< a function of direction and travel since the reversal explains it
  double low_hz{0.0};         ///< a tenth of the energy lies below
  double peak_hz{0.0};
  double high_hz{0.0};       ///< a tenth of the energy lies above
  double worst_time_s{0.0};  ///< where in the record most of it is
  double worst_share{0.0};   ///< that stretch's energy over the median stretch's
  std::array<double, kEvidenceChannels> coherence{};  ///< with each channel, by energy

  /// A function of the instant rather than of what was before.
  [[nodiscard]] bool memoryless() const noexcept {
    return surface_share > kClear && surface_share >= travel_share;
  }
  [[nodiscard]] bool has_memory() const noexcept {
    return travel_share > kClear && travel_share > surface_share;
  }
  static constexpr double kClear = 0.2;
  static constexpr double kMostly = 0.8;
};

/// "memoryless, odd; 3 to 11 Hz" and the like.
[[nodiscard]] std::string describe(const Signature& signature);

/// Mean and rms of what two models leave, over bins of one quantity.
class ResidualBins {
 public:
  /// Equal bins from `low` to `high`; what lies outside is not counted.
  ResidualBins(std::string over, double low, double high, std::size_t bins);
  void add(double place, const EvidencePoint& point);
  /// Bins with enough samples.
  [[nodiscard]] std::vector<ResidualRow> rows() const;

 private:
  struct Sums {
    std::uint64_t samples{0};
    double before{0.0};
    double before_squares{0.0};
    double after{0.0};
    double after_squares{0.0};
  };
  std::string over_;
  double low_;
  double width_;
  std::vector<Sums> sums_;
};

/// Free-form maps of what is left: over (y, v), and over direction and travel since the last
/// reversal. Each half of the record is explained by the map of the other half.
class ResidualMaps {
 public:
  /// `deflection_m`, `velocity_mps`: the size of the motion; `noise_m`: smaller turns are none.
  ResidualMaps(double deflection_m, double velocity_mps, double noise_m, double half_s)
      : deflection_m_{deflection_m},
        velocity_mps_{velocity_mps},
        turn_m_{noise_m},
        half_s_{half_s} {}
  void add(const EvidencePoint& point);
  void gap() {
    moving_ = false;
    waiting_.clear();
  }
  void describe(Signature& out) const;

 private:
  static constexpr std::size_t kSide = 9;  // odd: a cell about zero
  static constexpr std::size_t kTravels = 12;
  struct Cell {
    double count{0.0};
    double sum{0.0};
    double squares{0.0};
    void absorb(double x) {
      count += 1.0;
      sum += x;
      squares += x * x;
    }
  };
  template <std::size_t N>
  using Map = std::array<std::array<Cell, N>, 2>;  // by half

  [[nodiscard]] std::size_t surface_cell(const EvidencePoint& point) const;
  /// A point since the farthest: of the way there, or of the way back once that is clear.
  struct Waiting {
    double deflection_m;
    double left_n;
    std::size_t half;
  };
  void settle();

  double deflection_m_, velocity_mps_, turn_m_, half_s_;
  Map<kSide * kSide> surface_{};
  Map<2 * kTravels> travel_{};
  bool moving_{false};
  bool up_{false};
  std::vector<Waiting> waiting_;
  double extreme_m_{0.0};  // farthest in the present direction
  double turned_m_{0.0};   // where the last reversal was
};

/// Spectra of what two models leave, and the coherence of the rest with the channels: segments of
/// 512 points with a Hann window, half overlapping (Welch 1967).
class ResidualSpectrum {
 public:
  explicit ResidualSpectrum(double rate_hz) : rate_hz_{rate_hz} {}
  void add(const EvidencePoint& point);
  /// The next point does not follow the last one.
  void gap() { fill_ = 0; }
  /// The rms in bands of a third of an octave.
  [[nodiscard]] std::vector<ResidualRow> rows() const;
  void describe(Signature& out) const;

 private:
  static constexpr std::size_t kSize = Fourier512::kSize;
  static constexpr std::size_t kBins = kSize / 2;
  /// Before, after, channels.
  static constexpr std::size_t kSignals = 2 + kEvidenceChannels;
  using Spectra = std::array<std::array<std::complex<double>, kBins>, kSignals>;

  void transform();
  void two(std::size_t first, Spectra& out);
  [[nodiscard]] double bin_hz() const { return rate_hz_ / static_cast<double>(kSize); }

  double rate_hz_;
  std::size_t fill_{0};
  std::array<std::array<double, kSize>, kSignals + 1> held_{};
  Fourier512 fourier_;
  std::uint64_t segments_{0};
  std::array<std::array<double, kBins>, kSignals> power_{};  // N^2 or channel units squared per bin
  std::array<std::array<std::complex<double>, kBins>, kEvidenceChannels> cross_{};
};

}  // namespace dampline::app
