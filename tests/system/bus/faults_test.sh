#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What goes wrong live is said, and does not spread: a silent sensor, a second process, a flood, one
# message of another time, strangers beside a lockstep replay.
. "$(dirname "$0")/common.sh"
node="$bin/fake_node"
watch() { "$bin/status_watch" "$url" "$@"; }
stop() { kill -INT "$1"; code=0; wait "$1" || code=$?; }

# A driver that ends after a second: its channel was there and is gone.
start "$work/node.out" "$node" --role detector --lcm-url "$url"
process=$started
watch orchard-fake 0 "no SCAN since the start" >/dev/null || fail "does not wait"
"$bin/fake_driver" --lcm-url "$url" 2>/dev/null
before=$(date +%s%N)
watch orchard-fake 0 "SCAN is STALE" || fail "a silent SCAN is not said"
echo "said $((($(date +%s%N) - before) / 1000000)) ms after the last scan"
# It begins again with its seq and time of before: after a moment it is believed.
"$bin/fake_driver" --lcm-url "$url" 2>/dev/null
watch orchard-fake 0 "SCAN" >/dev/null || fail "says nothing of SCAN"
stop "$process"
[ "$code" -eq 0 ] || fail "exit code $code"
echo "ok: a silent sensor"

# Two of a name: each says so, with the other's host and process.
start "$work/a.out" "$node" --role pose --lcm-url "$url"
first=$started
watch orchard-fake 0 >/dev/null || fail "no STATUS"
start "$work/b.out" "$node" --role pose --lcm-url "$url"
second=$started
watch orchard-fake 0 "orchard-fake on $(hostname):$second runs beside" || fail "the second is not named"
watch orchard-fake 0 "orchard-fake on $(hostname):$first runs beside" || fail "the first is not named"
stop "$second"; stop "$first"
FAKE_NODE_ALONE=1 start "$work/a.out" "$node" --role pose --lcm-url "$url"
first=$started
watch orchard-fake 0 >/dev/null || fail "no STATUS"
code=0
FAKE_NODE_ALONE=1 "$node" --role pose --lcm-url "$url" 2>"$work/b.out" || code=$?
cat "$work/b.out"
[ "$code" -eq 1 ] || fail "a second one that may not: exit code $code"
grep -q "orchard-fake on $(hostname):$first is already running on" "$work/b.out" || fail "does not name the first"
kill -0 "$first" || fail "the first one ended"
# Another configuration.
printf 'mapper:\n  gate_m: 0.29\n' >"$work/other.yaml"
start "$work/b.out" "$node" --role pose --config "$work/other.yaml" --lcm-url "$url"
second=$started
watch orchard-fake 0 "another configuration is used by" || fail "another configuration is not said"
stop "$second"; stop "$first"
echo "ok: two of a kind"

# A flood: the memory stays, and a stop is obeyed.
start "$work/node.out" "$node" --role detector --lcm-url "$url"
process=$started
watch orchard-fake 0 >/dev/null || fail "no STATUS"
start "$work/flood.out" "$bin/flood_sender" 7667 600
flood=$started
watch orchard-fake 0 "SCAN" >/dev/null || fail "no STATUS in a flood"
most_kb=0
for _ in $(seq 6); do
  watch orchard-fake 0 "SCAN" >/dev/null || fail "no STATUS in a flood"
  kb=$(awk '/VmRSS/ {print $2}' "/proc/$process/status")
  [ "$kb" -le "$most_kb" ] || most_kb=$kb
done
before=$(date +%s%N)
stop "$process"
took_ms=$((($(date +%s%N) - before) / 1000000))
[ "$code" -eq 0 ] || fail "flood: exit code $code"
echo "flood: at most $most_kb kB, stopped in $took_ms ms"
if [ -n "${ORCHARD_SANITIZED:-}" ]; then
  echo "skipped: the limit on memory, as a sanitizer keeps notes of its own"
else
  [ "$most_kb" -lt 300000 ] || fail "a flood took $most_kb kB"
fi
kill "$flood" 2>/dev/null || true
wait "$flood" 2>/dev/null || true
echo "ok: a flood"

# Strangers beside a lockstep replay: a live system, and broken messages on its very port.
for role in detector pose mapper; do
  start "$work/$role.out" "$node" --role "$role" --lockstep --lcm-url "$url"
done
start "$work/live.out" "$node" --role pose --lcm-url "$url"
live=$started
start "$work/driver.out" "$bin/fake_driver" --lcm-url "$url"
"$bin/fake_player" "$work/log" in-process "$work/expected" 100
three_bytes() {
  local channel
  while sleep 0.01; do
    for channel in ACK SCAN POSE REPLAY; do
      printf 'LC02\0\0\0\1%s\0abc' "$channel" >/dev/udp/239.255.76.67/17667
    done
  done
}
start "$work/three_bytes.out" three_bytes
"$bin/fake_player" "$work/log" "$url" "$work/out" 100 || fail "strangers ended the replay"
cmp "$work/expected" "$work/out" || fail "strangers: derived.lcm differs"
stop "$live"
echo "ok: strangers beside a lockstep replay"
