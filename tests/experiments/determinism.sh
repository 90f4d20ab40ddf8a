#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Shows that a map follows from its log and configuration only: maps the same logs again and again
# with every core kept busy, in one process and in lockstep over multicast with the processes
# started in every order, and compares map.csv and every derived channel; then, as on another
# computer, on one core of an older processor, in another language and time zone, every file.
# Prints a table of SHA-256 and SAME, or says what differs and exits 1.
#   tests/experiments/determinism.sh [--runs N] [--orders N] [--build DIR] [--no-build] [--scenes LIST]
#     --runs N       times that each log is mapped in one process (default 20)
#     --orders N     orders in which the processes of the lockstep are started, 0-6 (default 6)
#     --build DIR    build folder (default build)
#     --no-build     use it as it is
#     --scenes LIST  of tubes, orchard, block, prior_map, pullally (default all; block and pullally
#                    are placed by their trunks, TRAJECTORY included, prior_map by the map of an
#                    earlier day; pullally needs its recording in $ORCHARD_DATA, or in shared/data
#                    beside this checkout)
set -euo pipefail
known_options="--runs --orders --build --no-build --scenes --inside"
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."

runs=20
orders=6
build_dir=build
build=yes
scenes=tubes,orchard,block,prior_map,pullally
inside=no
arguments=("$@")
while [ $# -gt 0 ]; do
  case $1 in
    --runs) runs=${2:?--runs needs a number}; shift ;;
    --orders) orders=${2:?--orders needs a number}; shift ;;
    --build) build_dir=${2:?--build needs a folder}; shift ;;
    --scenes) scenes=${2:?--scenes needs a list}; shift ;;
    --no-build) build=no ;;
    --inside) inside=yes ;;  # how this script calls itself within a namespace
    *) echo "determinism: unknown option $1; see $0 --help" >&2; exit 2 ;;
  esac
  shift
done
fail() { echo "determinism: $*" >&2; exit 1; }

if [ $inside = no ]; then
  if [ $build = yes ]; then scripts/build.sh all tests; fi
  again=(tests/experiments/determinism.sh --inside --no-build "${arguments[@]}")
  if [ "$(id -u)" -eq 0 ] && unshare -n true 2>/dev/null; then exec unshare -n "${again[@]}"; fi
  if unshare -rn true 2>/dev/null; then exec unshare -rn "${again[@]}"; fi
  echo "determinism: SKIPPED: no network namespace is allowed here" >&2
  exit 77
fi
ip link set lo up
ip link set lo multicast on
ip route add 224.0.0.0/4 dev lo

bin=$build_dir/bin
channel_bytes=$build_dir/tests/channel_bytes
[ -x "$bin/orchard" ] && [ -x "$channel_bytes" ] ||
  fail "$build_dir has no programs; run without --no-build"
data=${ORCHARD_DATA:-../shared/data}
out=$(mktemp -d)
started=$SECONDS

# Of the processes that we started, by their ids only.
pids=()
busy=()
player=
cleanup() {
  trap - EXIT INT TERM
  for pid in $player "${pids[@]}" "${busy[@]}"; do kill -KILL "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$out"
}
trap cleanup EXIT
trap 'echo "determinism: interrupted" >&2; exit 130' INT TERM

for ((i = 0; i < $(nproc); ++i)); do
  (renice -n 10 -p $BASHPID >/dev/null; while :; do :; done) &
  busy+=($!)
done

# fingerprint DIR DERIVED_LOG: a line "SHA-256  NAME" of each file and channel.
fingerprint() {
  "$channel_bytes" "$2" "$1/channels"
  (cd "$1" && sha256sum map.csv && cd channels && sha256sum ./*.bytes) |
    sed 's/\.bytes$//; s/\.\///'
}

# compare SCENE HOW DIR DERIVED_LOG: against the first run of the scene.
num_different=0
compare() {
  fingerprint "$3" "$4" >"$3/sums"
  if [ ! -e "$out/$1.sums" ]; then
    cp "$3/sums" "$out/$1.sums"
  elif ! cmp -s "$3/sums" "$out/$1.sums"; then
    num_different=$((num_different + 1))
    echo "DIFFERENT: $1, $2:"
    diff "$out/$1.sums" "$3/sums" || true
  fi
  rm -rf "$3"
}

# lockstep SCENE LOG CONFIG ORDER...: starts the processes in that order, at once.
lockstep() {
  local scene=$1 log=$2 config=$3
  shift 3
  local dir=$out/$scene.lockstep name
  mkdir -p "$dir"
  pids=()
  for name in "$@"; do
    case $name in
      player)
        "$bin/orchard-log-player" --lockstep --config "$config" --out "$dir/derived.lcm" "$log" \
          >"$dir/$name.log" 2>&1 &
        player=$! ;;
      mapper)
        "$bin/orchard-mapper" --lockstep --config "$config" --out "$dir" >"$dir/$name.log" 2>&1 &
        pids+=($!) ;;
      *)
        "$bin/orchard-$name" --lockstep --config "$config" >"$dir/$name.log" 2>&1 &
        pids+=($!) ;;
    esac
  done
  wait "$player" || { tail -n 5 "$dir"/*.log >&2; fail "$scene: orchard-log-player failed"; }
  player=
  for pid in "${pids[@]}"; do kill -INT "$pid"; done
  for pid in "${pids[@]}"; do
    wait "$pid" || { tail -n 5 "$dir"/*.log >&2; fail "$scene: a process of the lockstep failed"; }
  done
  pids=()
  compare "$scene" "lockstep started as $*" "$dir" "$dir/derived.lcm"
}

# elsewhere SCENE LOG CONFIG: compares all files of a map with those of a computer that is not like this one.
elsewhere() {
  if ! nm -D "$bin/orchard" | grep ' T sin$' >/dev/null; then
    echo "skipped: $1 as another computer: built without musl-dev, results differ between processors" >&2
    return
  fi
  local here=$out/$1.here there=$out/$1.there
  "$bin/orchard" map "$2" --config "$3" --out "$here" --quiet
  env "${of_another_computer[@]}" taskset -c 0 "$bin/orchard" map "$2" --config "$3" --out "$there" --quiet
  if ! diff -rq "$here" "$there"; then
    num_different=$((num_different + 1))
    echo "DIFFERENT: $1, on another computer"
  fi
  rm -rf "$here" "$there"
}
# A processor of 2008: no AVX for libc, OpenCV and libjpeg.
of_another_computer=(
  "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable,-AVX512F"
  OPENCV_CPU_DISABLE=SSE4.1,SSE4.2,AVX,FP16,FMA3,AVX2 JSIMD_FORCENONE=1 TZ=Asia/Kathmandu)
if localedef -i de_DE -f UTF-8 "$out/de_DE.UTF-8" 2>/dev/null; then
  of_another_computer+=("LOCPATH=$out" LC_ALL=de_DE.UTF-8)
else
  echo "determinism: in this language only: no sources of locales here (package locales)" >&2
fi

start_orders=(
  "detector pose mapper player" "player mapper pose detector" "pose player detector mapper"
  "mapper detector player pose" "detector mapper pose player" "player pose mapper detector")

for scene in ${scenes//,/ }; do
  log=$out/$scene.lcm
  case $scene in
    tubes)
      config=config/tubes.yaml
      "$bin/orchard" simulate --scene tubes --seed 1 --config $config --out "$log" >/dev/null ;;
    orchard)
      config=config/orchard.yaml
      "$bin/orchard" simulate --scene orchard --seed 1 --config $config --duration 30 \
        --out "$log" >/dev/null ;;
    block)
      config=config/block.yaml
      "$bin/orchard" simulate --scene orchard --seed 1002 --config $config --duration 100 \
        --out "$log" >/dev/null ;;
    prior_map)
      # mapped by fixes; on a later day, some trees changed, found in that map, carried, found again
      sed -e 's/num_rows: 10/num_rows: 4/' -e 's/trees_per_row: 30/trees_per_row: 14/' \
        -e 's/laps: 3/laps: 1/' config/block.yaml >"$out/rows.yaml"
      sed -e 's/mode: slam/mode: fixes/' -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' \
        "$out/rows.yaml" >"$out/day1.yaml"
      config=$out/day2.yaml
      sed -e "s|mode: slam|mode: prior_map\n  prior_map: {map_file: $out/day1}|" \
        "$out/rows.yaml" >"$config"
      printf '  change: {fraction: 0.05}\n  carry: {at_s: 20, for_s: 3, to_alley: 3}\n' >>"$config"
      "$bin/orchard" simulate --scene orchard --seed 1001 --config "$out/day1.yaml" \
        --out "$out/day1.lcm" >/dev/null
      "$bin/orchard" map "$out/day1.lcm" --config "$out/day1.yaml" --out "$out/day1" --quiet
      "$bin/orchard" simulate --scene orchard --seed 1001 --config "$config" --duration 45 \
        --out "$log" >/dev/null ;;
    pullally)
      config=config/pullally.yaml
      if [ ! -d "$data/pullally_drive_1" ]; then
        echo "skipped: pullally (no $data/pullally_drive_1)"
        continue
      fi
      "$bin/orchard" import "$data/pullally_drive_1" --out "$log" >/dev/null ;;
    *) fail "no scene $scene" ;;
  esac
  for ((run = 0; run < runs; ++run)); do
    "$bin/orchard" map "$log" --config $config --out "$out/run" --quiet
    compare "$scene" "run $run in one process" "$out/run" "$out/run/derived.lcm"
  done
  for ((order = 0; order < orders; ++order)); do
    # shellcheck disable=SC2086
    lockstep "$scene" "$log" $config ${start_orders[order % 6]}
  done
  [ -e "$out/$scene.sums" ] || fail "nothing was run"
  elsewhere "$scene" "$log" $config
  echo "$scene: $runs times in one process, $orders times in lockstep, $(nproc) cores kept busy; as another computer"
  while read -r sum name; do printf '  %-12s %s\n' "$name" "$sum"; done <"$out/$scene.sums"
done

if [ $num_different -gt 0 ]; then fail "$num_different runs DIFFER"; fi
echo "SAME ($((SECONDS - started)) s)"
