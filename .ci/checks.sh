# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034
# Sourced by .ci/run and .ci/nightly: checks, and the count of what passed.
source app/setup.sh

readonly ci_packages="
clang-14             the second compiler
libclang-rt-14-dev   its sanitizers and libFuzzer
clang-format-14      the layout of the source
clang-tidy-14        the rules that a compiler does not check
shellcheck           the same for the scripts
python3              hands the files to clang-tidy in groups
libbenchmark-dev     the programs in bench/
"
# For .ci/nightly alone: large.
readonly nightly_packages="
python3-pandas       takes the table that dampline.py makes of many runs
octave               runs loadrun.m
prometheus           promtool, which judges the metrics, and the server that scrapes them
prometheus-node-exporter reads them from a file
"
readonly product=(firmware_core hal drivers sim_hw app tests/published/generate)  # the last writes the core's tables
readonly logs=build/ci
total_passed=0
total_failed=0
total_skipped=0
failures=()

# took SECONDS_AT_START
took() { printf '%d s' $((SECONDS - $1)); }

# check NAME COMMAND...: one check, quiet unless it fails.
check() {
  local name=$1 log=$logs/${1// /-}.log start=$SECONDS
  shift
  if ("$@") >"$log" 2>&1; then
    total_passed=$((total_passed + 1))
    printf 'ok      %s (%s)\n' "$name" "$(took "$start")"
  else
    total_failed=$((total_failed + 1))
    failures+=("$name")
    printf 'FAILED  %s (%s); the end of %s:\n' "$name" "$(took "$start")" "$log"
    tail -n 60 "$log"
    return 1
  fi
}

# tests NAME FOLDER [ctest options]: every test counts.
tests() {
  local name=$1 log=$logs/${1// /-}.log start=$SECONDS
  shift
  run_tests "$@" >"$log" 2>&1
  count "$name" "$start" "$log"
}

# count NAME START LOG: adds passed, failed and skipped to the totals.
count() {
  total_passed=$((total_passed + passed))
  total_failed=$((total_failed + failed))
  total_skipped=$((total_skipped + skipped))
  printf '%-7s %s: %d passed, %d failed, %d skipped (%s)\n' "$( ((failed)) && echo FAILED || echo ok)" \
    "$1" "$passed" "$failed" "$skipped" "$(took "$2")"
  ((failed == 0)) || { failures+=("$1"); tail -n 60 "$3"; }
}

# build NAME PRESET FOLDER TARGETS [CMake options]
build() {
  local name=$1 preset=$2 folder=$3 targets=$4
  shift 4
  # shellcheck disable=SC2086  # targets are words
  check "configure $name" configure "$preset" "$folder" "$@" &&
    check "build $name" cmake --build "$folder" --target $targets
}

sources() { find firmware_core hal drivers sim_hw app bench tests -name "$1" | sort; }

format() { { sources '*.cpp' && sources '*.hpp'; } | xargs clang-format-14 --dry-run -Werror; }

# summary: the last line counts tests and checks together.
summary() {
  ((${#failures[@]})) && printf 'failed: %s\n' "${failures[@]}"
  printf '\n%d passed, %d failed, %d skipped\n' "$total_passed" "$total_failed" "$total_skipped"
  ((total_failed == 0))
}

# What both need: a second compiler's command for every file by itself, and its sanitized build.
configure_separate() { configure separate build/separate -DDAMPLINE_BENCH=ON -DCMAKE_CXX_COMPILER=clang++-14; }
# build_sanitized FOLDER TARGETS [CMake options]
build_sanitized() {
  local folder=$1 targets=$2
  shift 2
  build "asan-ubsan" asan-ubsan "$folder" "$targets" -DDAMPLINE_BENCH=OFF -DCMAKE_CXX_COMPILER=clang++-14 "$@"
}
mkdir -p "$logs"
