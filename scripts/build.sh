#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Install the required packages, configure and build the programs into build/bin.
#   scripts/build.sh             all programs, manual pages, types for lcm-spy and Python
#   scripts/build.sh TARGET...   build only these targets of ninja: programs by name, tests,
#                                experiments (those behind tests/RESULTS.md), benchmarks, all
set -euo pipefail
case "${1:-}" in
  -h | --help) sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"; exit 0 ;;
  -*) echo "build: unknown option $1; see $0 --help" >&2; exit 2 ;;
esac
cd "$(dirname "$0")/.."

echo "== 1/3 packages (scripts/install_deps.sh)"
scripts/install_deps.sh

echo "== 2/3 configure: cmake -S . -B build -G Ninja (Release)"
# Options for cmake come last, such as -DORCHARD_WERROR=ON, or -DORCHARD_UNITY=OFF for development.
read -r -a options <<<"-DORCHARD_UNITY=ON ${ORCHARD_CMAKE_OPTIONS:-}"
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
export CCACHE_SLOPPINESS=pch_defines,time_macros  # without it ccache passes over precompiled headers
mkdir -p build
if ! cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release "${launcher[@]}" "${options[@]}" >build/configure.log 2>&1
then
  cat build/configure.log
  echo "build: cmake failed; see the lines above" >&2
  exit 1
fi

jobs=$(nproc)
echo "== 3/3 build: ninja -C build -j$jobs ${*}"
started=$SECONDS
NINJA_STATUS='[%f/%t] ' ninja -C build -j"$jobs" "$@"
echo "build: done in $((SECONDS - started)) s"
