#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds unit tests with the address and undefined-behaviour sanitizers and runs them.
#   .ci/sanitize.sh [PROGRAM...]   default: the quick tests of the rooms that compute
# Not optimised more than -O1: what is slow here is compiling.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h | --help) sed -n '3,5s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
programs=("$@")
[ ${#programs[@]} -gt 0 ] || programs=(geometry_test segment_test detection_test)

launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
export CCACHE_SLOPPINESS=pch_defines,time_macros
mkdir -p build-asan
cmake --preset asan-ubsan -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" -DORCHARD_JAVA=OFF "${launcher[@]}" \
  >build-asan/configure.log 2>&1 || { cat build-asan/configure.log; exit 1; }
ninja -C build-asan "${programs[@]}"
for program in "${programs[@]}"; do
  echo "== sanitizers: $program"
  build-asan/tests/"$program" --gtest_brief=1
done
