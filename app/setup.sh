# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034
# Sourced by app/quickstart, tests/run and .ci/run: what they install and how they build.

# Name and purpose, one package a line.
readonly program_packages="
cmake                the build is described in CMake
ninja-build          runs the build
g++                  compiles it
libeigen3-dev        small matrices (the core's only library)
libcli11-dev         the command line
libtomlplusplus-dev  configuration files
nlohmann-json3-dev   parameters.json
libfmt-dev           text output
nettle-dev           SHA-256 of the input files and of a page's scripts
zlib1g-dev           records compressed by gzip, Vector BLF, NumPy's .npz
libzstd-dev          records compressed by zstd
libmicrohttpd-dev    the page, the metrics and the events of a live run
libgnutls28-dev      their readers' certificates
libmosquitto-dev     a live run told to an MQTT broker
libsqlite3-dev       the states of a fleet
libgpiod-dev         marker lines and the status lamp
pkg-config           finds libgpiod and its version
"
readonly test_packages="
libgtest-dev         the tests' framework
libgmock-dev         its matchers
libgmp-dev           exact arithmetic behind the wavelets' coefficients
binutils             nm, which lists the core's symbols
valgrind             counts instructions per sample
systemd              systemd-analyze, which rates the service's sandbox
mandoc               checks the man page
python3-jsonschema   holds the JSON files of runs against their schema
locales              a language that writes a decimal comma
python3-numpy        reads runs by dampline.py, and writes arrays
dpkg-dev             finds what the Debian package depends on
file                 tells programs from other files for it
can-utils            log2asc and log2long, which write records for the readers
zstd                 compresses records for them
python3-can          writes Vector ASC and BLF and PEAK TRC
chromium             shows the report as people see it
chromium-driver      moves and reads it
poppler-utils        pdftotext, which reads it from paper
python3              drives the browser
libhdf5-dev          reads HDF5, an optional part of the program
python3-h5py         writes it
libmatio-dev         reads MAT files below version 7.3, an optional part of the program
python3-scipy        writes them
libopenmpi-dev       archives by MPI, an optional part of the program
openmpi-bin          starts its ranks
slurm-wlm            runs an archive's tasks
munge                lets its parts know each other
mosquitto            a broker
mosquitto-clients    reads what it was told
openssl              makes certificates
sqlite3              reads the database of a fleet
libpq-dev            keeps them in PostgreSQL, an optional part of the program
postgresql-15        that server
python3-yaml         reads the file of its containers
libnats-dev          states by NATS, an optional part of the program
nats-server          the hub, and the server on a logger
"
readonly bus_packages="
can-utils            candump, cansend, canplayer
iproute2             makes and breaks CAN interfaces
gpiod                gpioget and gpiomon
kmod                 loads vcan and gpio-sim, where the running kernel has them
linux-source-6.1     User-Mode Linux, where it has not
xz-utils             unpacks its source
make                 builds it
flex                 generates scanners in that build
bison                generates parsers in it
bc                   calculates in it
"

fail() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# install_packages LIST: installs what is missing, asks for nothing, says what and why.
install_packages() {
  local name purpose missing=()
  if ! command -v dpkg-query >/dev/null; then
    printf 'No dpkg here, so nothing is installed. On another system than Debian, provide:%s' "$1"
    return
  fi
  while read -r name purpose; do
    [[ -n $name ]] || continue
    # shellcheck disable=SC2016  # a format of dpkg-query, not of the shell
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null) == installed ]] && continue
    ((${#missing[@]})) || printf 'Installing from Debian:\n'
    printf '  %-20s %s\n' "$name" "$purpose"
    missing+=("$name")
  done <<<"$1"
  ((${#missing[@]})) || return 0
  local as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null ||
      fail "installing needs root, and there is no sudo; as root run: apt-get install ${missing[*]}"
    as_root=(sudo)
  fi
  as_root+=(env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 apt-get -q -o Dpkg::Use-Pty=0)
  mkdir -p build
  { "${as_root[@]}" update &&
    "${as_root[@]}" install -y --no-install-recommends "${missing[@]}"; } >build/install.log 2>&1 || {
    tail -n 20 build/install.log >&2
    fail "apt-get failed (all of its output: build/install.log)"
  }
}

# is_configured FOLDER [CMake options]: the folder holds a build of this source tree, so configured.
is_configured() {
  local folder=$1 option
  shift
  [[ -f $folder/build.ninja ]] || return 1
  for option in "CMAKE_HOME_DIRECTORY=$PWD" "${@#-D}"; do
    grep -qs "^${option%%=*}:[A-Z]*=${option#*=}\$" "$folder/CMakeCache.txt" || return 1
  done
}

# configure PRESET FOLDER [CMake options]: only where that was not done yet; later changes of
# CMake files are noticed by the build itself.
configure() {
  local preset=$1 folder=$2
  shift 2
  is_configured "$folder" "$@" && return
  mkdir -p build
  cmake --fresh --preset "$preset" -B "$folder" "$@" >"$folder.log" 2>&1 || {
    cat "$folder.log" >&2
    fail "cmake failed"
  }
}

# start_kernel: builds User-Mode Linux for tests/bus beside whatever follows, unless that was done.
start_kernel() {
  kernel_job=
  sim_hw/virtual_bus/build_kernel --find >/dev/null && return
  mkdir -p build
  echo "Building a kernel for the tests on the CAN bus meanwhile (User-Mode Linux, once) ..."
  sim_hw/virtual_bus/build_kernel >build/kernel.log 2>&1 &
  kernel_job=$!
  trap 'kill "$kernel_job" 2>/dev/null || true' EXIT
}

# await_kernel: without it the tests on the CAN bus are skipped, or fail as they say.
await_kernel() {
  [[ -n $kernel_job ]] || return 0
  if wait "$kernel_job"; then
    grep -o 'built in .*' build/kernel.log | sed 's/^/User-Mode Linux was /' || true
  else
    echo "User-Mode Linux could not be built; the tests on the CAN bus will say so:"
    tail -n 3 build/kernel.log
  fi
  trap - EXIT
}

# run_tests FOLDER [ctest options]: sets passed, failed and skipped; never ends the script. What ctest
# calls a test is a suite of tests, and each of these counts; a suite that ends early has failed once.
run_tests() {
  local report=$PWD/$1/tests.xml folder=$1
  shift
  rm -f "$report"
  passed=0 failed=1 skipped=0
  ctest --test-dir "$folder" --output-on-failure --output-junit "$report" --test-output-size-passed 1000000 \
    --test-output-size-failed 1000000 "$@" || true
  [[ -f $report ]] || return 0
  read -r passed failed skipped < <(awk '
    function add_suite() {
      if (left_out) { skipped += 1; return }
      if (good && ok + skip == 0) ok = 1  # a script
      if (!good && bad == 0) bad = 1
      passed += ok; failed += bad; skipped += skip
    }
    /^[ \t]*<testcase / {
      if (suites++) add_suite()
      ok = bad = skip = left_out = 0
      good = /status="run"/
    }
    /<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/ { left_out = 1 }
    /^\[       OK \] .* ms\)$/ { ok++ }
    /^\[  SKIPPED \] .* ms\)$/ { skip++ }
    /^\[  FAILED  \] .* ms\)$/ { bad++ }
    END {
      if (suites) add_suite()
      print passed + 0, suites ? failed + 0 : 1, skipped + 0
    }' "$report")
}
