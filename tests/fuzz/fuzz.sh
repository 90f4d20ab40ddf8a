#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Run every fuzzer with libFuzzer and the address and undefined-behaviour sanitizers.
# usage: tests/fuzz/fuzz.sh [SECONDS_EACH]   (default 60). Findings are left in build-fuzz/findings.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
seconds=${1:-60}

as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
if ! command -v clang++ >/dev/null ||
   ! ls /usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.fuzzer-*.a >/dev/null 2>&1; then
  echo "fuzz: installing clang and its fuzzer library"
  runtime=libclang-rt-14-dev   # Debian 12's clang; elsewhere the one of its clang
  apt-cache show clang 2>/dev/null | grep -q '^Depends:.*clang-14' ||
    runtime=$(apt-cache depends clang | sed -nE 's/.*Depends: clang-([0-9]+)$/libclang-rt-\1-dev/p' | head -n 1)
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends clang "$runtime" >/dev/null
fi

cmake --preset fuzz -DORCHARD_JAVA=OFF >/dev/null
targets=$(ninja -C build-fuzz -t targets all | sed -nE 's/^(fuzz_[a-z_]+): phony$/\1/p' | sort -u)
# shellcheck disable=SC2086  # a list of words
ninja -C build-fuzz $targets
mkdir -p build-fuzz/findings
for target in $targets; do
  echo "fuzz: $target for $seconds s"
  mkdir -p "build-fuzz/corpus/$target"
  "build-fuzz/fuzz/$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 \
    -max_len=16384 -print_final_stats=1 -verbosity=0 \
    -artifact_prefix="build-fuzz/findings/$target-" "build-fuzz/corpus/$target"
done
echo "fuzz: no finding"
