// SPDX-License-Identifier: MIT
#pragma once

namespace dampline::app::fleet {

extern const char* const kTables;  ///< tables.sql
extern const char* const kViews;   ///< views.sql, which need `segment`
/// Of both; a database says which one it has.
inline constexpr int kSchemaVersion = 2;

}  // namespace dampline::app::fleet
