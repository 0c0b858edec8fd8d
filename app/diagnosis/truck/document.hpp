// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/truck/explain.hpp"
#include "app/law/document.hpp"

namespace dampline::app {

/// A truck's final law as law.json has it, of its stated parameters: half the moving mass on spring
/// and friction, driven by -m (z_1'' + z_2''). Its numbers are taken as independent of each other.
/// Effects of sensors, modes and free play are no term of it, and named.
[[nodiscard]] law::Document document_of(const Explained& explained,
                                        const std::vector<Parameter>& parameters,
                                        double moving_mass_kg);

}  // namespace dampline::app
