#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Simulate the paper's orchard, map it live, compare the map with the truth, and map the recording
# twice more: all three maps must be equal. Builds what is needed first.
#   scripts/demo.sh [--seed N] [--keep] [--out DIR] [--build DIR] [--no-build] [--private]
#     --seed N    seed of the scene (default 1)
#     --keep      keep the files of earlier runs
#     --out DIR   folder for the files (default out/demo)
#     --build DIR use this build folder without building (default: build/, built first)
#     --no-build  use build/ without building
#     --private   exit with code 77 if private network namespaces are not allowed
set -euo pipefail
cd "$(dirname "$0")/.."

seed=1
keep=no
build=yes
build_dir=build
inside=no
private=no
out=out/demo
while [ $# -gt 0 ]; do
  case $1 in
    --seed) seed=${2:?--seed needs a number}; shift ;;
    --keep) keep=yes ;;
    --private) private=yes ;;
    --out) out=${2:?--out needs a folder}; shift ;;
    --build) build_dir=${2:?--build needs a folder}; build=no; shift ;;
    --no-build) build=no ;;
    --inside) inside=$2; shift ;;  # how this script calls itself within a namespace
    -h | --help) sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "demo: unknown option $1; see $0 --help" >&2; exit 2 ;;
  esac
  shift
done
[[ $seed =~ ^[0-9]+$ ]] || { echo "demo: --seed must be a number, not $seed" >&2; exit 2; }

bin=$build_dir/bin
config=config/tubes.yaml
url='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304'
group=239.255.76.67

say() { echo "== $*"; }
fail() { echo "demo: $*" >&2; exit 1; }

# ---- outside: build, then find a network of our own ----------------------------------------------
if [ "$inside" = no ]; then
  programs=(orchard orchard-detector orchard-pose orchard-mapper orchard-sim-driver orchard-log-player)
  if [ $build = yes ]; then scripts/build.sh "${programs[@]}"; fi
  [ -x "$bin/orchard" ] || fail "$build_dir has no programs; run without --no-build"
  mkdir -p "$out"
  [ $keep = yes ] || rm -rf "$out"/live "$out"/in_process "$out"/lockstep "$out"/demo.lcm "$out"/*.log

  again=(scripts/demo.sh --seed "$seed" --out "$out" --build "$build_dir" --inside)
  if [ "$(id -u)" -eq 0 ] && unshare -n true 2>/dev/null; then
    say "network: a private namespace (unshare -n); nothing leaves it and nothing disturbs it"
    exec unshare -n "${again[@]}" namespace
  elif unshare -rn true 2>/dev/null; then
    say "network: a private namespace of a plain user (unshare -rn); nothing leaves it"
    exec unshare -rn "${again[@]}" namespace
  elif [ $private = yes ]; then
    echo "demo: private network namespaces are not allowed on this machine"
    exit 77
  elif ip route get $group >/dev/null 2>&1; then
    say "network: no namespace is allowed here; using the machine's own multicast route with ttl=0"
    say "         (stop other users of LCM on this machine first)"
    exec "${again[@]}" existing
  elif [ "$(id -u)" -eq 0 ]; then
    say "network: no namespace is allowed here; adding a multicast route on lo, removed at the end"
    exec "${again[@]}" route
  fi
  fail "network namespaces are not allowed and there is no multicast route; ask an administrator to run:
  ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo"
fi

# ---- inside: processes on multicast --------------------------------------------------------------
started=$SECONDS
pids=()
# Of the processes that we started, by their ids only.
cleanup() {
  trap - EXIT INT TERM
  for pid in "${pids[@]}"; do kill -INT "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
  [ "$inside" != route ] || ip route del 224.0.0.0/4 dev lo 2>/dev/null || true
}
trap cleanup EXIT
trap 'echo "demo: interrupted" >&2; exit 130' INT TERM

if [ "$inside" != existing ]; then
  ip link set lo up
  ip link set lo multicast on
  ip route add 224.0.0.0/4 dev lo
fi

# start NAME COMMAND...: in the background, its whole log in out/demo/NAME.log, its id in $pid.
start() {
  local name=$1
  shift
  "$@" >"$out/$name.log" 2>&1 &
  pid=$!
  pids+=("$pid")
}

# stop NAME PID: SIGINT, then wait for what it still had to say; its exit code must be 0.
stop() {
  kill -INT "$2" 2>/dev/null || true
  local code=0
  wait "$2" || code=$?
  [ $code -eq 0 ] || { tail -n 5 "$out/$1.log" >&2; fail "$1 ended with exit code $code (see $out/$1.log)"; }
}

# wait_until SECONDS WHAT COMMAND...: polls; a process that died in the meantime ends the demo.
wait_until() {
  local limit=$((SECONDS + $1)) what=$2
  shift 2
  until "$@"; do
    [ $SECONDS -lt $limit ] || fail "waited too long for $what; see $out/*.log"
    for pid in "${pids[@]}"; do
      kill -0 "$pid" 2>/dev/null || fail "a process ended while waiting for $what; see $out/*.log"
    done
    sleep 0.1
  done
}

log="$out/demo.lcm"
rm -f "$log"
say "live: lcm-logger, orchard-detector, orchard-pose, orchard-mapper, then orchard-sim-driver"
start logger lcm-logger --lcm-url="$url" --flush-interval=50 "$log"
logger=$pid
start detector "$bin/orchard-detector" --config $config --lcm-url "$url"
detector=$pid
start pose "$bin/orchard-pose" --config $config --lcm-url "$url"
pose=$pid
start mapper "$bin/orchard-mapper" --config $config --lcm-url "$url" --out "$out/live"
mapper=$pid
# The logger listens when the first STATUS of the others has reached its file.
wait_until 20 "lcm-logger to record" test -s "$log"

say "live: the robot drives (scene tubes, seed $seed)"
start sim_driver "$bin/orchard-sim-driver" --config $config --lcm-url "$url" --scene tubes \
  --seed "$seed" --truth "$out/truth.csv" --wait-for orchard-detector,orchard-pose,orchard-mapper
sim_driver=$pid
code=0
wait "$sim_driver" || code=$?
[ $code -eq 0 ] || fail "orchard-sim-driver ended with exit code $code (see $out/sim_driver.log)"

# Upstream first: each flushes what it still held before the next is asked to stop.
stop detector "$detector"
stop pose "$pose"
stop mapper "$mapper"
stop logger "$logger"
pids=()

echo
"$bin/orchard" evaluate "$out/live" --truth "$out/truth.csv" --check | tee "$out/tables.txt"
cp "$out/live/map.png" "$out/live/map.svg" "$out/"
echo
say "figure 11: $out/map.png and $out/map.svg"

say "replay in one process: orchard map $log"
"$bin/orchard" map "$log" --config $config --out "$out/in_process" >"$out/in_process.log" 2>&1 ||
  { cat "$out/in_process.log" >&2; fail "orchard map failed"; }

say "replay in lockstep: orchard-log-player --lockstep, with fresh processes"
start lockstep_mapper "$bin/orchard-mapper" --config $config --lcm-url "$url" --lockstep --out "$out/lockstep"
mapper=$pid
start lockstep_pose "$bin/orchard-pose" --config $config --lcm-url "$url" --lockstep
pose=$pid
start lockstep_detector "$bin/orchard-detector" --config $config --lcm-url "$url" --lockstep
detector=$pid
start player "$bin/orchard-log-player" --config $config --lcm-url "$url" --lockstep "$log"
player=$pid
code=0
wait "$player" || code=$?
[ $code -eq 0 ] || { tail -n 5 "$out/player.log" >&2; fail "orchard-log-player ended with exit code $code"; }
stop lockstep_detector "$detector"
stop lockstep_pose "$pose"
stop lockstep_mapper "$mapper"
pids=()

echo
sha256sum "$out/live/map.csv" "$out/in_process/map.csv" "$out/lockstep/map.csv"
distinct=$(sha256sum "$out/live/map.csv" "$out/in_process/map.csv" "$out/lockstep/map.csv" |
  cut -d' ' -f1 | sort -u | wc -l)
if [ "$distinct" -ne 1 ]; then
  diff "$out/live/map.csv" "$out/in_process/map.csv" || true
  diff "$out/in_process/map.csv" "$out/lockstep/map.csv" || true
  fail "the three maps DIFFER"
fi
echo "SAME: live, in one process, and in lockstep ($((SECONDS - started)) s)"
