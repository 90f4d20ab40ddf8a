#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# orchard-laser-driver as a program: a log played as a Hokuyo and as a SICK scanner comes out of it,
# its raw bytes give the same SCANs again, and what is wrong is said.
. "$(dirname "$0")/../bus/common.sh"
driver=$bin/orchard-laser-driver
for program in "$driver" "$bin/orchard"; do
  [ -x "$program" ] || { echo "skipped: $program is not built" >&2; exit 77; }
done

sed 's/^  enabled: true/  enabled: false/' "$2/config/orchard.yaml" >"$work/rig.yaml"
"$bin/orchard" simulate --scene orchard --seed 3 --config "$work/rig.yaml" --out "$work/drive.lcm" \
  >"$work/simulate.out" 2>&1 || { cat "$work/simulate.out" >&2; fail "no log"; }

# run NAME COUNT OPTIONS...: COUNT SCANs of the driver into NAME.scans; then Ctrl-C, or its own end,
# which must give 0
run() {
  local name=$1 count=$2 code=0; shift 2
  start "$work/$name.scans" timeout 60 "$bin/orchard" echo SCAN --json --count "$count" --lcm-url "$url"
  local listener=$started
  start "$work/$name.log" "$driver" --lcm-url "$url" "$@"
  local process=$started
  wait "$listener" || { cat "$work/$name.log" >&2; fail "$name: no SCANs"; }
  kill -INT "$process" 2>/dev/null || true
  wait "$process" || code=$?
  [ "$code" -eq 0 ] || { cat "$work/$name.log" >&2; fail "$name: exit code $code at Ctrl-C"; }
}

for protocol in scip cola; do
  { cat "$work/rig.yaml"; printf 'drivers:\n  laser:\n    protocol: %s\n' "$protocol"; } >"$work/$protocol.yaml"
  run "$protocol" 40 --config "$work/$protocol.yaml" --emulate "$work/drive.lcm" --raw-out "$work/$protocol.raw"
  run "${protocol}_again" 30 --config "$work/$protocol.yaml" --raw-in "$work/$protocol.raw"
  # Who listens may miss some, of either: those of the times that both heard are the same, seq too.
  both='NR == FNR { line[$2] = $0; next }
        $2 in line { ++num; wrong += (line[$2] != $0) }
        END { print num + 0, wrong + 0 }'
  read -r num wrong < <(awk -F '[:,]' "$both" "$work/$protocol.scans" "$work/${protocol}_again.scans")
  [ "$num" -ge 5 ] && [ "$wrong" -eq 0 ] ||
    fail "$protocol: $wrong of $num SCANs are not those of the raw bytes"
done
echo "ok: SCANs of both protocols, and of their raw bytes"

code=0; timeout 10 "$driver" --config "$work/rig.yaml" --lcm-url "$url" >"$work/none.log" 2>&1 || code=$?
[ "$code" -eq 3 ] || fail "exit code $code without a device, wanted 3"
grep -q "no device is given" "$work/none.log" || fail "nothing said of the missing device"
code=0; timeout 10 "$driver" --config "$work/rig.yaml" --lcm-url "$url" --device usb0 >"$work/bad.log" 2>&1 || code=$?
[ "$code" -eq 3 ] || fail "exit code $code for a device that is none, wanted 3"
echo "ok: what cannot be is refused"

start "$work/status" "$bin/orchard" echo STATUS --count 2 --lcm-url "$url"
listener=$started
start "$work/silent.log" "$driver" --config "$work/rig.yaml" --lcm-url "$url" --device tcp:127.0.0.1:9
process=$started
wait "$listener"
grep -q 'level="error".*cannot open tcp:127.0.0.1:9' "$work/status" || { cat "$work/status" >&2; fail "STATUS does not say what is wrong"; }
kill -TERM "$process"
code=0; wait "$process" || code=$?
[ "$code" -eq 0 ] || fail "exit code $code at SIGTERM"
echo "ok: a scanner that is not there is said in STATUS"
