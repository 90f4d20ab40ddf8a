#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Two robots drive at once on one network: each has the map of its own drive, byte for byte, and a log of both, as
# lcm-logger writes it at a base station, is refused as one drive and split into two.
. "$(dirname "$0")/../bus/common.sh"
rig=$2
cd "$work"

wait_for() {  # wait_for WHAT SECONDS COMMAND...: until the command succeeds
  local what=$1 end=$((SECONDS + $2)); shift 2
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $end ] || { cat ./*.err >&2; fail "$what did not come"; }
    read -rt 0.05 <> <(:) || true
  done
}

# The truth: each drive alone, in one process, without a network.
declare -A seed=([koala]=1 [heron]=2)
for robot in koala heron; do
  "$bin/orchard" simulate --scene tubes --seed "${seed[$robot]}" --out "$robot-alone.lcm" >/dev/null
  "$bin/orchard" map "$robot-alone.lcm" --config "$rig" --out "$robot-alone" --quiet
done
cmp -s koala-alone/map.csv heron-alone/map.csv && fail "the two drives are the same"

if command -v lcm-logger >/dev/null; then
  start logger.err lcm-logger --lcm-url="$url" --flush-interval=100 both.lcm
else
  start logger.err "$bin/orchard" record --lcm-url "$url" --out . --name both
fi
logger=$started
wait_for "the recorder at the base station" 20 test -e both.lcm -o -e both-*-000.lcm
for robot in koala heron; do
  "$bin/orchard" live "$rig" --robot "$robot" --sim tubes --seed "${seed[$robot]}" --speed 3 --out "$robot" \
    --record "$robot-rec" --without viewer >"$robot.out" 2>"$robot.err" &
  declare "$robot=$!"
  children+=("$!")
done
for robot in koala heron; do
  # the base station's page of each robot
  start "$robot-page.err" "$bin/orchard-viewer" --config "$rig" --robot "$robot"
  wait_for "the page of $robot" 20 grep -q "the page is at" "$robot-page.err"
  page=$(sed -n 's/.*the page is at \(http[^ ]*\).*/\1/p' "$robot-page.err")
  grep -q "<title>[^<]*$robot" < <(/usr/bin/python3 -c "import sys, urllib.request
sys.stdout.write(urllib.request.urlopen('$page').read().decode())") || fail "the page of $robot does not name it"
done
is_over() { grep -q "the source has ended" < <("$bin/orchard" status --once --config "$rig" --robot "$1"); }
for robot in koala heron; do wait_for "the end of $robot's drive" 60 is_over "$robot"; done
for robot in koala heron; do
  kill -INT "${!robot}"
  code=0; wait "${!robot}" || code=$?
  [ "$code" -eq 0 ] || { cat "$robot.err" >&2; fail "$robot: exit code $code after Ctrl-C"; }
done
kill -INT "$logger"
wait "$logger" || true
[ -e both.lcm ] || mv both-*-000.lcm both.lcm
for robot in koala heron; do
  cmp "$robot-alone/map.csv" "$robot/map.csv" || fail "the map of $robot is not that of its drive alone"
  "$bin/orchard" map "$robot-rec"/*-000.lcm --config "$rig" --out replayed --quiet
  cmp "$robot/map.csv" replayed/map.csv || fail "the map of $robot is not that of its recording"
done
echo "ok: two robots at once, each with the map of its own drive"

code=0; "$bin/orchard" map both.lcm --config "$rig" --out mixed 2>error || code=$?
[ "$code" -eq 3 ] && grep -q "robot .*orchard log split" error || { cat error; fail "a log of two robots was mapped"; }
[ ! -e mixed/map.csv ] || fail "a map of two robots"
"$bin/orchard" log info both.lcm | grep -q "the robots heron, koala" || fail "log info does not name the robots"
"$bin/orchard" log split both.lcm --out split
for robot in koala heron; do
  "$bin/orchard" map split/$robot.lcm --config "$rig" --out split/$robot --quiet
  cmp "$robot/map.csv" split/$robot/map.csv || fail "the split log of $robot gives another map"
done
code=0; "$bin/orchard" log split split/koala.lcm --out again 2>error || code=$?
[ "$code" -eq 3 ] && [ -z "$(ls -A again)" ] || fail "a log of one robot was split"
echo "ok: the log of both is refused, and split"

# The player plays both at once, each in lockstep with its own robot's processes.
for robot in koala heron; do
  for name in detector pose mapper; do
    more=(); [ $name != mapper ] || more=(--out "$robot-lockstep")
    start "$robot-$name.err" "$bin/orchard-$name" --config "$rig" --robot "$robot" --lockstep "${more[@]}"
  done
  start "$robot-player.err" "$bin/orchard-log-player" --config "$rig" --robot "$robot" --lockstep \
    --out "$robot-derived.lcm" "split/$robot.lcm"
  declare "$robot=$started"
done
for robot in koala heron; do
  wait "${!robot}" || { cat "$robot-player.err"; fail "the player of $robot"; }
  "$bin/orchard-log-player" --config "$rig" --out alone-derived.lcm "split/$robot.lcm" >/dev/null
  cmp "$robot-derived.lcm" alone-derived.lcm || fail "$robot: the lockstep replay differs from that of its log alone"
done
echo "ok: both played at once"
