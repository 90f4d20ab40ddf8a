#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Run clang-tidy (.clang-tidy) on the source files that changed since a commit, those of this change
# first, until the time limit. Lists the files that were not checked; fails only on findings.
#   .ci/tidy.sh [--since REV] [--all] [--seconds N]
#     --since REV   default: the branch point from origin/main, else the last ten commits
#     --all         the whole tree
#     --seconds N   start no new file after this time (default 600)
set -euo pipefail
cd "$(dirname "$0")/.."
since=
all=no
seconds=600
while [ $# -gt 0 ]; do
  case $1 in
    --since) since=${2:?--since needs a revision}; shift ;;
    --all) all=yes ;;
    --seconds) seconds=${2:?--seconds needs a number}; shift ;;
    -h | --help) sed -n '3,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "tidy: unknown option $1; see $0 --help" >&2; exit 2 ;;
  esac
  shift
done
tidy=$(command -v clang-tidy-14 || command -v clang-tidy || true)
[ -n "$tidy" ] || { echo "tidy: no clang-tidy; apt-get install clang-tidy-14"; exit 77; }

sources=(lib/*.cpp procs/*.cpp tests/unit/*.cpp)
if [ $all = yes ]; then
  mapfile -t files < <(git ls-files "${sources[@]}")
else
  if [ -z "$since" ]; then
    since=$(git merge-base HEAD origin/main 2>/dev/null || true)
    if [ -z "$since" ] || [ "$since" = "$(git rev-parse HEAD)" ]; then
      since=$(git rev-parse --verify --quiet HEAD~10 || git rev-list --max-parents=0 HEAD | tail -1)
    fi
  fi
  mapfile -t files < <(git diff --name-only --diff-filter=d "$since" -- "${sources[@]}")
fi
if [ ${#files[@]} -eq 0 ]; then echo "tidy: no source file changed"; exit 0; fi

# A build folder of its own: clang reads none of GCC's precompiled headers.
build=build-tidy
cmake -S . -B $build -G Ninja -DCMAKE_BUILD_TYPE=Release -DORCHARD_PCH=OFF -DORCHARD_JAVA=OFF \
  -DORCHARD_BENCHMARKS=OFF >$build.log 2>&1 || { cat $build.log; exit 1; }
ninja -C $build orchard_lcmtypes_generate >>$build.log
rm -f $build.log

export tidy build
check() {
  local now
  now=$(date +%s)
  [ "$now" -lt "$1" ] || { echo "tidy: no time left for $2"; exit 0; }
  "$tidy" --quiet -p "$build" "$2" 2>/dev/null || { echo "tidy: $2"; exit 1; }
}
export -f check
echo "tidy: ${#files[@]} files"
printf '%s\n' "${files[@]}" |
  xargs -P "$(nproc)" -I{} bash -c "check $(($(date +%s) + seconds)) {}" ||
  { echo "tidy: the files above are not clean" >&2; exit 1; }
echo "tidy: clean"
