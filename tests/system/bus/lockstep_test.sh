#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Lockstep over multicast: equal to the in-process replay whatever the start order, also over a link
# that loses datagrams, and twice in a row through the same processes; a stuck node is named.
. "$(dirname "$0")/common.sh"

node() { start "$work/$1.out" "$bin/fake_node" --role "$1" --lockstep --lcm-url "$2" "${@:3}"; }
stop_all() {
  for child in "${children[@]}"; do
    kill -KILL "$child" 2>/dev/null || true
    wait "$child" 2>/dev/null || true
  done
  children=()
}

"$bin/fake_player" "$work/log" in-process "$work/expected" 100

for order in "detector pose mapper" "mapper pose detector" "pose mapper detector"; do
  for role in $order; do node "$role" "$url"; done
  "$bin/fake_player" "$work/log" "$url" "$work/out" 100
  cmp "$work/expected" "$work/out" || fail "order $order: derived.lcm differs"
  "$bin/fake_player" "$work/log" "$url" "$work/again" 100
  cmp "$work/expected" "$work/again" || fail "order $order: the second replay differs"
  stop_all
done
echo "ok: three start orders, twice each"

# The player first, the nodes later.
start "$work/player.out" "$bin/fake_player" "$work/log" "$url" "$work/out" 100
player=$started
for role in mapper detector pose; do node "$role" "$url"; done
"$bin/status_watch" "${url/:7667/:17667}" orchard-fake 0 "in a lockstep replay" || fail "no STATUS in a replay"
wait "$player" || fail "player first: $(cat "$work/player.out")"
cmp "$work/expected" "$work/out" || fail "player first: derived.lcm differs"
stop_all
echo "ok: player first"

# The detector behind a link that loses every 29th datagram.
other="udpm://239.255.76.67:7668?ttl=0&recv_buf_size=4194304"
start "$work/bridge.out" "$bin/lossy_bridge" 17667 17668 29
node detector "$other"; node pose "$url"; node mapper "$url"
"$bin/fake_player" "$work/log" "$url" "$work/out" 100 | tee "$work/player.out"
cmp "$work/expected" "$work/out" || fail "lossy link: derived.lcm differs"
grep -q "resent 0 " "$work/player.out" && fail "lossy link: nothing was lost"
stop_all
echo "ok: lost messages were sent again"

node detector "$url"; node pose "$url"; node mapper "$url" --mute-after 40
code=0
"$bin/fake_player" "$work/log" "$url" "$work/none" 100 2>"$work/error" || code=$?
cat "$work/error"
[ "$code" -eq 1 ] || fail "stuck node: exit code $code"
grep -q "no answer from orchard-mapper to \(POSE\|DETECTIONS\) seq" "$work/error" || fail "stuck node: not named"
[ ! -e "$work/none" ] || fail "stuck node: a derived.lcm was left behind"
echo "ok: a stuck node is named"
