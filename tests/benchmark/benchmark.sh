#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Build and run every benchmark of tests/benchmark and print a table of the results and their targets.
# Takes about 5 minutes after the build; the machine should be idle.
#   tests/benchmark/benchmark.sh [--build DIR] [--no-build]
#     --build DIR  build folder (default build)
#     --no-build   use it without building
# Exit code 1 if a target was missed; the output of each benchmark is in out/benchmark.
set -euo pipefail
known_options="--build --no-build"
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."

build_dir=build
build=yes
while [ $# -gt 0 ]; do
  case $1 in
    --build) build_dir=${2:?--build needs a folder}; shift ;;
    --no-build) build=no ;;
    *) echo "benchmark: unknown option $1; see $0 --help" >&2; exit 2 ;;
  esac
  shift
done
if [ $build = yes ]; then scripts/build.sh all benchmarks; fi

mkdir -p out/benchmark
rows=out/benchmark/results.txt
: >$rows
failed=()
for name in bench_detector bench_mapper bench_replay bench_latency bench_cpu bench_viewers; do
  program=$build_dir/benchmark/$name
  if [ ! -x "$program" ]; then
    echo "benchmark: no $program" >&2
    failed+=("$name")
    continue
  fi
  echo "== $name"
  "$program" 2>&1 | tee out/benchmark/$name.txt || failed+=("$name")
  grep '^result | ' out/benchmark/$name.txt >>$rows || true
done

echo
awk -F' [|] ' '
  { what[NR] = $2; measured[NR] = $3; target[NR] = $4; verdict[NR] = $5
    if (length($2) > w) w = length($2); if (length($3) > m) m = length($3)
    if (length($4) > t) t = length($4) }
  END {
    printf "%-*s | %-*s | %-*s |\n", w, "what", m, "measured", t, "target"
    for (i = 1; i <= NR; ++i)
      printf "%-*s | %-*s | %-*s | %s\n", w, what[i], m, measured[i], t, target[i], verdict[i]
  }' $rows | tee out/benchmark/summary.txt
if [ ${#failed[@]} -gt 0 ] || grep -q '| MISSED$' $rows; then
  echo "benchmark: not all as wanted: ${failed[*]:-}" >&2
  exit 1
fi
