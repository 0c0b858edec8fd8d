// SPDX-License-Identifier: MIT
#pragma once
#include "app/verify/subject.hpp"

namespace dampline::app {

/// `dampline verify fokker-planck`: 0 when every promised figure is met, otherwise 1. Throws
/// UsageError for a table that the publication does not have.
int verify_fokker_planck(const VerifyOptions& options);

}  // namespace dampline::app
