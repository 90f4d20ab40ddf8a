#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# install_test.sh BUILD: installs the library of a build folder into a prefix of its own and builds
# tests/package/consumer against it, which must map its scans and link neither LCM nor GDAL nor a
# library with windows.
set -euo pipefail
build=$(cd "${1:?usage: install_test.sh BUILD}" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$build/package_test
prefix=$work/prefix

fail() { echo "install_test: $*" >&2; exit 1; }
rm -rf "$work"
mkdir -p "$work"
cmake --install "$build" --component dev --prefix "$prefix" >"$work/install.log" 2>&1 ||
  { tail -n 5 "$work/install.log"; fail "cmake --install failed"; }

# A library built with a sanitizer needs its run-time in the program, too.
sanitizers=$(sed -n 's/^ORCHARD_SANITIZE:[A-Z]*=//p' "$build/CMakeCache.txt")
configure() {
  cmake -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_CXX_FLAGS="${sanitizers:+-fsanitize=$sanitizers}"
}
configure "$here/consumer" "$work/consumer" >"$work/configure.log" 2>&1 ||
  { cat "$work/configure.log"; fail "find_package(orchard COMPONENTS laser detection mapping) failed"; }
cmake --build "$work/consumer" >"$work/build.log" 2>&1 || { cat "$work/build.log"; fail "the consumer does not build"; }
"$work/consumer/map_five_scans"

unwanted=$(ldd "$work/consumer/map_five_scans" |
  grep -oE 'lib(lcm|gdal|mrpt-(gui|opengl|vision|hwdrivers|img)|opencv_(highgui|imgcodecs|videoio)|spdlog|yaml-cpp|wx_|Qt)[^ ]*' |
  sort -u | tr '\n' ' ' || true)
[ -z "$unwanted" ] || fail "laser, detection and mapping link $unwanted"
echo "links $(ldd "$work/consumer/map_five_scans" | grep -c '=>') shared libraries, none of LCM, GDAL or windows"

# Nothing of the build or source tree may have got into what is installed.
source=$(cd "$here/../.." && pwd)
if grep -rlF --include='*.cmake' -e "$build/lib" -e "$source/lib" "$prefix"; then fail "the files above name the build or source folder"; fi

# An unknown component is refused by name.
mkdir -p "$work/unknown"
printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' 'project(unknown LANGUAGES CXX)' \
  'find_package(orchard REQUIRED COMPONENTS attic)' >"$work/unknown/CMakeLists.txt"
if configure "$work/unknown" "$work/unknown/build" >"$work/unknown.log" 2>&1; then
  fail "a component that does not exist was found"
fi
grep -q 'no component attic' "$work/unknown.log" || { cat "$work/unknown.log"; fail "the component is not named"; }
echo "install_test: the installed library works outside the tree"
