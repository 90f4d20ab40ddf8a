#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is needed, configures and builds everything into build/. Says what it does.
set -euo pipefail
cd "$(dirname "$0")/.."

echo "== 1/3 packages (scripts/install_deps.sh)"
scripts/install_deps.sh

echo "== 2/3 configure: cmake -S . -B build -G Ninja (Release)"
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
export CCACHE_SLOPPINESS=pch_defines,time_macros  # without it ccache passes over precompiled headers
mkdir -p build
if ! cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release "${launcher[@]}" >build/configure.log 2>&1
then
  cat build/configure.log
  echo "build: cmake failed; the lines above say why" >&2
  exit 1
fi

jobs=$(nproc)
echo "== 3/3 build: ninja -C build -j$jobs ${*}"
started=$SECONDS
NINJA_STATUS='[%f/%t] ' ninja -C build -j"$jobs" "$@"
echo "build: done in $((SECONDS - started)) s"
