#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Build tests with sanitizers and run them.
#   .ci/sanitize.sh [OPTIONS] [TEST_PROGRAM...]   default: the quick tests of the computing modules
#     --thread         the thread sanitizer (build-tsan), not those for addresses and undefined
#                      behaviour (build-asan)
#     --all            every test of ctest, including those with real processes (hours of CPU time)
#     --matching REGEX with --all: only tests whose name matches
#     --jobs N         number of compilers (default 2); tests run one after another
# Compiled with -O1: compiling takes most of the time.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=asan-ubsan folder=build-asan
all=no
matching=.
jobs=2
programs=()
while [ $# -gt 0 ]; do
  case $1 in
    --thread) preset=tsan folder=build-tsan ;;
    --all) all=yes ;;
    --matching) matching=${2:?--matching needs a regular expression}; shift ;;
    --jobs) jobs=${2:?--jobs needs a number}; shift ;;
    -h | --help) sed -n '3,11s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "sanitize: unknown option $1; see $0 --help" >&2; exit 2 ;;
    *) programs+=("$1") ;;
  esac
  shift
done
[ ${#programs[@]} -gt 0 ] || programs=(geometry_test segment_test detection_test)

launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
export CCACHE_SLOPPINESS=pch_defines,time_macros
mkdir -p "$folder"
cmake --preset "$preset" -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" -DORCHARD_JAVA=OFF -DORCHARD_UNITY=ON \
  "${launcher[@]}" >"$folder/configure.log" 2>&1 || { cat "$folder/configure.log"; exit 1; }

export TSAN_OPTIONS="halt_on_error=1 second_deadlock_stack=1 suppressions=$PWD/.ci/tsan_suppressions.txt"
export LSAN_OPTIONS="suppressions=$PWD/.ci/lsan_suppressions.txt print_suppressions=0"
export UBSAN_OPTIONS=print_stacktrace=1
export ORCHARD_SANITIZED=yes  # tests leave out limits on memory and processor
if [ $all = yes ]; then
  ninja -C "$folder" -j "$jobs" all tests
  # Ten times as long: sanitizers are that slow.
  find "$folder" \( -name CTestTestfile.cmake -o -name '*_suites.cmake' \) -exec sed -i -E 's/(TIMEOUT "[0-9]+)"/\10"/' {} +
  ctest --test-dir "$folder" --output-on-failure -R "$matching"
  exit
fi
ninja -C "$folder" -j "$jobs" "${programs[@]}"
for program in "${programs[@]}"; do
  echo "== sanitizers: $program"
  "$folder/tests/$program" --gtest_brief=1
done
