#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Exit codes, signals, and hostile datagrams.
. "$(dirname "$0")/common.sh"
node="$bin/fake_node"

expect_code() {  # expect_code CODE COMMAND...
  local want=$1 code=0; shift
  "$@" >"$work/out" 2>"$work/err" || code=$?
  [ "$code" -eq "$want" ] || { cat "$work/err" >&2; fail "exit code $code, wanted $want: $*"; }
}

expect_code 0 "$node" --help
grep -q "Exit codes" "$work/out" || fail "--help says nothing of exit codes"
expect_code 0 "$node" --version
expect_code 0 "$node" --print-config
expect_code 2 "$node" --no-such-option
expect_code 2 "$node" --log-level loud
expect_code 3 "$node" --config "$work/absent.yaml"
cat >"$work/bad.yaml" <<YAML
lcm:
  ulr: "udpm://239.255.76.67:7667"
detector:
  tree_threshold: 1.9
mapper:
  gate_m: wide
YAML
expect_code 3 "$node" --config "$work/bad.yaml"
for mistake in "bad.yaml:2" "bad.yaml:4" "bad.yaml:6"; do
  grep -q "$mistake" "$work/err" || { cat "$work/err" >&2; fail "$mistake is not named"; }
done
expect_code 0 "$node" --print-config --all
grep -q "seed: " "$work/out" || fail "--all does not show all keys"
expect_code 1 "$node" --lcm-url "udpm://1.2.3.4.5:1"
expect_code 1 "$node" --lcm-url "file:///tmp/log"
echo "ok: exit codes"

for signal in INT TERM HUP; do
  start "$work/node.out" "$node" --role pose --lcm-url "$url" --saved "$work/saved.$signal"
  process=$started
  "$bin/status_watch" "$url" orchard-fake 0 >/dev/null || fail "no STATUS"
  kill -"$signal" "$process"
  code=0; wait "$process" || code=$?
  [ "$code" -eq 0 ] || { cat "$work/node.out" >&2; fail "SIG$signal gave exit code $code"; }
  [ -e "$work/saved.$signal" ] || fail "SIG$signal: no last save"
done
# "| tee" with a tee that ends: the next line of the log finds nobody to read it.
mkfifo "$work/pipe"
cat "$work/pipe" >/dev/null &
reader=$!
children+=("$reader")
"$node" --role pose --lcm-url "$url" --saved "$work/saved.PIPE" 2>"$work/pipe" &
process=$!
children+=("$process")
"$bin/status_watch" "$url" orchard-fake 0 >/dev/null || fail "no STATUS"
kill "$reader"; wait "$reader" || true
"$bin/fake_driver" --speed 20 --lcm-url "$url" 2>/dev/null  # "all inputs are arriving"
code=0; timeout 10 tail --pid="$process" -f /dev/null || fail "SIGPIPE: goes on"
wait "$process" || code=$?
[ "$code" -eq 0 ] || fail "SIGPIPE gave exit code $code"
[ -e "$work/saved.PIPE" ] || fail "SIGPIPE: no last save"
code=0
start "$work/node.out" nohup "$node" --role pose --lcm-url "$url"
process=$started
"$bin/status_watch" "$url" orchard-fake 0 >/dev/null || fail "no STATUS"
kill -HUP "$process"
"$bin/status_watch" "$url" orchard-fake 0 >/dev/null || fail "nohup: SIGHUP ended it"
kill -TERM "$process"; wait "$process" || fail "nohup: bad exit"
echo "ok: signals"

# A node says what it waits for and who should send it; a full disk is an ERROR, not an end.
start "$work/node.out" "$node" --role pose --full-disk --lcm-url "$url"
process=$started
"$bin/status_watch" "$url" orchard-fake 0 "no ODOMETRY since the start" || fail "does not say what it waits for"
start "$work/driver.out" "$bin/fake_driver" --speed 20 --lcm-url "$url"
driver=$started
"$bin/status_watch" "$url" orchard-fake 0 "not saved: map.csv" || fail "the full disk is not shown"
code=0; wait "$driver" || code=$?
[ "$code" -eq 0 ] || { cat "$work/driver.out" >&2; fail "driver: exit code $code"; }
kill -INT "$process"
code=0; wait "$process" || code=$?
[ "$code" -eq 1 ] || fail "full disk: exit code $code, wanted 1: the last save failed"
grep -q "50 messages used, 50 sent, 0 refused, 0 lost" "$work/node.out" || { cat "$work/node.out" >&2; fail "not every message was used"; }
echo "ok: waiting and a full disk"

expect_code 2 "$bin/fake_driver" --speed 0
start "$work/driver.out" "$bin/fake_driver" --speed 20 --wait-for fake --lcm-url "$url"
driver=$started
start "$work/node.out" "$node" --role pose --lcm-url "$url"
process=$started
code=0; wait "$driver" || code=$?
[ "$code" -eq 0 ] || fail "driver with --wait-for: exit code $code"
grep -q "waits for orchard-fake" "$work/driver.out" || fail "the driver does not say what it waits for"
kill -TERM "$process"; wait "$process" || fail "node after a driver"
grep -q "50 messages used" "$work/node.out" || { cat "$work/node.out" >&2; fail "--wait-for began too early"; }
start "$work/driver.out" "$bin/fake_driver" --wait-for nobody --lcm-url "$url"
driver=$started
"$bin/status_watch" "$url" orchard-fake-driver 0 "waits for orchard-nobody" || fail "STATUS does not say what the driver waits for"
kill -TERM "$driver"
code=0; wait "$driver" || code=$?
[ "$code" -eq 0 ] || fail "a waiting driver: exit code $code"
echo "ok: drivers"

start "$work/node.out" "$node" --role detector --lcm-url "$url"
process=$started
"$bin/status_watch" "$url" orchard-fake 0 >/dev/null || fail "no STATUS"
"$bin/hostile_sender" 7667 6000 1
"$bin/status_watch" "$url" orchard-fake 500 || { cat "$work/node.out" >&2; fail "refusals are not counted"; }
kill -0 "$process" || fail "the process died of a datagram"
[ "$(wc -l <"$work/node.out")" -lt 200 ] || fail "a flood of log lines"
kill -TERM "$process"
code=0; wait "$process" || code=$?
[ "$code" -eq 0 ] || { cat "$work/node.out" >&2; fail "exit code $code after hostile datagrams"; }
echo "ok: hostile datagrams"
