// SPDX-License-Identifier: MIT
// The templates of this method, compiled as the core is: what they bring in can be seen in the
// library's symbols.
#include "published/wavelet/coarse_rows.hpp"
#include "published/wavelet/estimates.hpp"
#include "published/wavelet/model_selection.hpp"
#include "published/wavelet/motion_rows.hpp"
#include "published/wavelet/product_rows.hpp"

namespace dampline {
namespace {
using Smooth = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Friction<TanhSign>>;
using Dry = TermList<Viscous, Spring, Friction<>, ProgressiveFriction<>, ExponentialFriction<>,
                     UserTerm<true, true>>;
}  // namespace

template class MotionRows<D8, SingleModel<Smooth>>;
template class MotionRows<D16, ChainModel<Smooth, Dry>>;
template class MotionRows<D12, GroundedFrictionModel<>>;
template class CoarseRows<D12, SingleModel<Smooth>, 2>;
template class CoarseRows<D8, ChainModel<Dry, Dry>, 1>;
template class ProductRows<SingleModel<Smooth>, 3>;
template class SequentialWindows<7>;
template class RecursiveEstimate<7>;
template class RecursiveEstimate<7, float>;
template class FactorRing<7, 4>;
template class FactorRing<7, 4, float>;
template class ModelSelection<SingleModel<Dry>>;
template class ModelSelection<GroundedFrictionModel<>>;

}  // namespace dampline
