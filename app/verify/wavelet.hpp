// SPDX-License-Identifier: MIT
#pragma once
#include "app/verify/subject.hpp"

namespace dampline::app {

/// `dampline verify wavelet`: the cases of Ghanem and Romeo (2001), see VerifySubject::run.
[[nodiscard]] int verify_wavelet(const VerifyOptions& options);

}  // namespace dampline::app
