#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Lockstep over multicast: equal to the in-process replay whatever the start order, also over a link
# that loses datagrams, and twice in a row through the same processes; a stuck node and a stranger are named.
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
grep -q "no answer from orchard-mapper to [A-Z]* seq" "$work/error" || fail "stuck node: not named"
[ ! -e "$work/none" ] || fail "stuck node: a derived.lcm was left behind"
stop_all

# The mapper waits for what a stuck detector should send: only the detector is blamed.
node detector "$url" --mute-after 40; node pose "$url"; node mapper "$url"
"$bin/fake_player" "$work/log" "$url" "$work/none" 100 2>"$work/error" && fail "stuck detector: no error"
cat "$work/error"
grep -q "no answer from orchard-detector to [A-Z]* seq [0-9]*; orchard-mapper waits at" "$work/error" ||
  fail "stuck detector: not named"
echo "ok: a stuck node is named"
stop_all

# Strangers on the replay's network: a driver, then another player. A replay is what it is alone, or is refused.
right_or_refused() {  # right_or_refused CODE OUT ERROR
  if [ "$1" -eq 0 ]; then cmp "$work/expected" "$2" || fail "a stranger changed the replay, and nobody says so"; return; fi
  [ "$1" -eq 1 ] && grep -q "another program publishes\|lockstep replay is stuck" "$3" ||
    { cat "$3"; fail "a stranger: exit code $1"; }
  [ ! -e "$2" ] || fail "a derived.lcm was left behind"
}
for role in detector pose mapper; do node "$role" "$url"; done
start "$work/error" "$bin/fake_player" "$work/log" "$url" "$work/strange" 3000
player=$started
while kill -0 "$player" 2>/dev/null; do "$bin/fake_driver" --speed 50 --lcm-url "${url/:7667/:17667}" 2>/dev/null; done
code=0; wait "$player" || code=$?
[ "$code" -ne 0 ] || "$bin/fake_player" "$work/log" in-process "$work/alone" 3000
if [ "$code" -eq 0 ]; then
  cmp "$work/alone" "$work/strange" || fail "a driver changed the replay, and nobody says so"
else
  grep -q "another program publishes" "$work"/*.out "$work/error" || { cat "$work/error"; fail "a driver beside the replay: not named"; }
  [ ! -e "$work/strange" ] || fail "a driver beside the replay: a derived.lcm was left behind"
fi
echo "ok: a driver beside the replay changes nothing, or is named"
"$bin/fake_player" "$work/log" "$url" "$work/after" 100
cmp "$work/expected" "$work/after" || fail "the replay after a stranger differs"
for one in a b; do
  start "$work/error.$one" "$bin/fake_player" "$work/log.$one" "$url" "$work/both.$one" 100
  eval "$one=$started"
done
for one in a b; do
  code=0; wait "${!one}" || code=$?
  right_or_refused "$code" "$work/both.$one" "$work/error.$one"
done
echo "ok: two players at once do not spoil each other unnoticed"
