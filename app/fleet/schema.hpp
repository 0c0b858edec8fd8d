// SPDX-License-Identifier: MIT
#pragma once

namespace dampline::app::fleet {

/// database.sql.
extern const char* const kSchema;

}  // namespace dampline::app::fleet
