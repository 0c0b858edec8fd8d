// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace dampline::proof {

/// Instructions of each function by itself, by its name.
using Profile = std::map<std::string, std::uint64_t>;

[[nodiscard]] std::uint64_t total_of(const Profile& profile) noexcept;

/// Of what happens inside the function named `function` while `command` runs under callgrind.
/// `path` is where valgrind's file goes. Throws std::runtime_error where either fails.
[[nodiscard]] Profile profile_inside(const std::string& command, const std::string& function,
                                     const std::string& path);

/// The same of the whole of `command`, all its threads together.
[[nodiscard]] Profile profile_of(const std::string& command, const std::string& path);

/// Reads callgrind's file format, written with --dump-line=no. A name that appears in it for
/// several files is one function.
[[nodiscard]] Profile parse_callgrind(const std::string& text);

/// What changed between two profiles, the largest growth first, one function a line; at most
/// `lines` of them.
[[nodiscard]] std::string describe_growth(const Profile& before, const Profile& now,
                                          std::size_t lines);

}  // namespace dampline::proof
