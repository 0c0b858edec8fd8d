// SPDX-License-Identifier: MIT
// In place of postgresql.cpp where libpq is not there.
#include "app/error.hpp"
#include "app/fleet/store/store.hpp"

namespace dampline::app::fleet::store {

std::unique_ptr<Connection> open_postgresql(const std::string& uri, Access /*access*/) {
  throw UsageError{without_password(uri) +
                   ": this program was built without PostgreSQL (Debian: libpq-dev); expected a "
                   "file of SQLite"};
}

}  // namespace dampline::app::fleet::store
