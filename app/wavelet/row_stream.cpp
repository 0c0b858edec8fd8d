// SPDX-License-Identifier: MIT
#include "app/wavelet/row_stream.hpp"

#include <utility>

#include "published/wavelet/coarse_rows.hpp"
#include "published/wavelet/daubechies.hpp"

namespace dampline::app::wavelet {
namespace {

template <class Rows, int Dof>
class StreamOf final : public RowStream<Dof> {
 public:
  StreamOf(const MotionRowsConfig<Dof>& config, const TermsModel<Dof>& model)
      : rows_{Rows::make(config, model).value()} {}
  bool push(const MotionSample<Dof>& sample, TermsRow<Dof>& row) override {
    return rows_.push(sample, row);
  }
  void restart() override { rows_.restart(); }

 private:
  Rows rows_;
};

template <class W, int Dof, std::size_t... Deeper>
std::unique_ptr<RowStream<Dof>> of_level(int level, const MotionRowsConfig<Dof>& config,
                                         const TermsModel<Dof>& model,
                                         std::index_sequence<Deeper...> /*unused*/) {
  using M = TermsModel<Dof>;
  std::unique_ptr<RowStream<Dof>> out;
  if (level == 0) out = std::make_unique<StreamOf<MotionRows<W, M>, Dof>>(config, model);
  ((level == static_cast<int>(Deeper) + 1
        ? void(out =
                   std::make_unique<StreamOf<CoarseRows<W, M, static_cast<int>(Deeper) + 1>, Dof>>(
                       config, model))
        : void()),
   ...);
  return out;
}

}  // namespace

template <int Dof>
std::unique_ptr<RowStream<Dof>> make_row_stream(Wavelet wavelet, int level,
                                                const MotionRowsConfig<Dof>& config,
                                                const TermsModel<Dof>& model) {
  constexpr auto kLevels = std::make_index_sequence<static_cast<std::size_t>(kDeepestLevel)>{};
  switch (wavelet) {
    case Wavelet::kD6:
      return of_level<D6, Dof>(level, config, model, kLevels);
    case Wavelet::kD8:
      return of_level<D8, Dof>(level, config, model, kLevels);
    case Wavelet::kD12:
      return of_level<D12, Dof>(level, config, model, kLevels);
    case Wavelet::kD16:
      return of_level<D16, Dof>(level, config, model, kLevels);
  }
  return nullptr;
}

template std::unique_ptr<RowStream<1>> make_row_stream(Wavelet, int, const MotionRowsConfig<1>&,
                                                       const TermsModel<1>&);
template std::unique_ptr<RowStream<2>> make_row_stream(Wavelet, int, const MotionRowsConfig<2>&,
                                                       const TermsModel<2>&);

}  // namespace dampline::app::wavelet
