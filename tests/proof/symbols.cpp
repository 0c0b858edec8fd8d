// SPDX-License-Identifier: MIT
#include "tests/proof/symbols.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "tests/proof/command.hpp"

namespace dampline::proof {
namespace {

std::set<std::string> names(const std::string& nm_options, const std::string& archive) {
  const CommandResult nm = run_command("nm --just-symbols " + nm_options + " '" + archive + "'");
  if (nm.status != 0) throw std::runtime_error{"nm failed on " + archive};
  std::set<std::string> found;
  std::istringstream lines{nm.output};
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() != ':') found.insert(line);  // "member.o:" is a heading
  }
  return found;
}

/// Everything else is forbidden: a new name has to be looked at before it is added here. The two
/// names of __cpu are of g++'s own library on x86-64: what the processor can do, asked of it by one
/// instruction before main(), for the functions that are compiled for wider vectors too.
constexpr const char* kHarmless =
    "_GLOBAL_OFFSET_TABLE_ __cpu_indicator_init __cpu_model abort __divdc3 __muldc3 memcmp memcpy "
    "memmove memset "
    "acos asin atan atan2 cbrt ceil cos cosh erf erfc exp exp2 expm1 floor fma fmax fmin "
    "fmod frexp hypot ldexp lgamma llround log log10 log1p log2 lround lroundf nearbyint pow "
    "remainder rint round scalbn sin sincos sinh sqrt tan tanh tgamma trunc ";

std::set<std::string> words(const std::string& text) {
  std::istringstream stream{text};
  return {std::istream_iterator<std::string>{stream}, {}};
}

}  // namespace

std::set<std::string> needed_symbols(const std::string& archive) {
  const std::set<std::string> undefined = names("--undefined-only", archive);
  const std::set<std::string> defined = names("--defined-only", archive);
  std::set<std::string> needed;
  std::set_difference(undefined.begin(), undefined.end(), defined.begin(), defined.end(),
                      std::inserter(needed, needed.end()));
  return needed;
}

std::set<std::string> forbidden_symbols(const std::string& archive) {
  const std::set<std::string> needed = needed_symbols(archive);
  const std::set<std::string> harmless = words(kHarmless);
  std::set<std::string> forbidden;
  std::set_difference(needed.begin(), needed.end(), harmless.begin(), harmless.end(),
                      std::inserter(forbidden, forbidden.end()));
  return forbidden;
}

}  // namespace dampline::proof
