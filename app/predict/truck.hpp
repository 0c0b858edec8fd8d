// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "app/predict/prediction.hpp"
#include "app/record/feed.hpp"

namespace dampline::app {

/// The motion of a truck's frame on its wheelsets: deflection and frame acceleration that the law
/// makes of the record's wheelset accelerations, beside the frame acceleration that was measured,
/// both as means over two sampling intervals. Each stretch without a gap starts at rest, and its
/// first seconds are not judged. Throws RunError, UsageError.
[[nodiscard]] Prediction predict_frame(const law::Document& document, const Config& config,
                                       const SourceOptions& source);

}  // namespace dampline::app
