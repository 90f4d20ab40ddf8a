#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# orchard live: starts, watches, restarts, records, stops.
. "$(dirname "$0")/../bus/common.sh"
rig=$2
cd "$work"

wait_for() {  # wait_for WHAT SECONDS COMMAND...: until the command succeeds
  local what=$1 end=$((SECONDS + $2)); shift 2
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $end ] || { cat live.err >&2; fail "$what did not come"; }
    read -rt 0.05 <> <(:) || true
  done
}
pid_of() { pgrep -P "$live" -f "$bin/$1"; }

begin() {  # begin OUT OPTION...
  local out=$1; shift
  "$bin/orchard" live "$rig" --sim tubes --speed 3 --out "$out" "$@" >live.out 2>live.err &
  live=$!
  children+=("$live")
}
# Its exit code is that somebody should look: the sensors are silent then.
is_over() { grep -q "the source has ended" < <("$bin/orchard" status --once --config "$rig"); }
stop() {
  kill -INT "$live"
  local code=0; wait "$live" || code=$?
  [ "$code" -eq 0 ] || { cat live.err >&2; fail "exit code $code after Ctrl-C"; }
}

# The live map is that of the recording, byte for byte; others see how everyone is.
begin map --record rec
wait_for "the drive's end" 40 is_over
"$bin/orchard" status --json --config "$rig" >status.json 2>/dev/null || true
for process in orchard-detector orchard-pose orchard-mapper orchard-recorder orchard-sim-driver; do
  grep -q "\"name\": \"$process\"" status.json || { cat status.json; fail "$process is not in status"; }
done
stop
[ "$(wc -l <map/map.csv)" -eq 17 ] || fail "map.csv has not 16 landmarks"
"$bin/orchard" map rec/drive-*-000.lcm --config "$rig" --out replayed --quiet
cmp map/map.csv replayed/map.csv || fail "the live map is not that of its recording"
echo "ok: started, recorded, stopped; the map is that of the recording"

# A process that is killed comes back by itself, and what it had saved is not lost. The source pauses meanwhile: what is
# sent while nobody listens, and what came after the last save, a second before, a killed mapper does not have.
begin map2
wait_for "a map with ten landmarks" 40 sh -c '[ "$(wc -l <map2/map.csv)" -gt 10 ]'
source=$(pid_of orchard-sim-driver)
mapper=$(pid_of orchard-mapper)
kill -STOP "$source"
size=0 since=$(date +%s%N)
is_saved() {  # the journal, written every second, has not grown for more than two
  local now_size; now_size=$(stat -c %s map2/mapper.journal)
  [ "$now_size" -eq "$size" ] || { size=$now_size since=$(date +%s%N); }
  [ $(($(date +%s%N) - since)) -gt 2200000000 ]
}
wait_for "the last save" 40 is_saved
kill -KILL "$mapper"
wait_for "another mapper" 40 grep -rq "resuming the map in map2" map2/logs
grep -q "orchard-mapper was killed by signal Killed" live.err || fail "nobody says who was killed"
[ "$(pid_of orchard-mapper)" != "$mapper" ] || fail "the same mapper"
kill -CONT "$source"
wait_for "the drive's end" 40 is_over
stop
cut -d, -f1,2 map/map.csv >classes; cut -d, -f1,2 map2/map.csv | diff classes - ||
  fail "ids or classes are not those of the undisturbed map"
echo "ok: a mapper that was killed went on"

# Whoever kills the parent leaves no child behind.
begin map3
wait_for "the processes" 20 pid_of orchard-mapper
group=$(pgrep -P "$live")
kill -KILL "$live"
gone() { for pid in $group; do ! kill -0 "$pid" 2>/dev/null || return 1; done; }
wait_for "the end of all" 20 gone
echo "ok: no process is left"

# Mistakes end all, with their own exit code and words.
echo 'detector: {tree_threshold: 1.9}' >bad.yaml
code=0; "$bin/orchard" live bad.yaml --sim tubes --out map4 2>live.err || code=$?
[ "$code" -eq 3 ] || fail "a bad rig gave exit code $code"
code=0; "$bin/orchard" live "$rig" --sim tubes --only maper --out map4 2>live.err || code=$?
[ "$code" -eq 3 ] && grep -q "did you mean mapper" live.err || fail "a misspelt process"
echo "ok: mistakes"
