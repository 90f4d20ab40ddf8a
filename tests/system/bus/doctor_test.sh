#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# `orchard doctor` and `orchard echo` in networks that are well and in one that is not.
orchard=$2
. "$(dirname "$0")/common.sh"
enter=(unshare -n)
[ "$(id -u)" -eq 0 ] || enter=(unshare -rn)
"${enter[@]}" true 2>/dev/null || { echo "skipped: no network namespaces here"; exit 77; }
in_namespace="$(dirname "$0")/../in_namespace.sh"

code=0
"${enter[@]}" "$orchard" doctor >"$work/sick" 2>&1 || code=$?
cat "$work/sick"
[ "$code" -eq 1 ] || fail "no network at all: exit code $code"
grep -q "FAIL.*loopback" "$work/sick" || fail "loopback down is not found"
grep -q "FAIL.*no route" "$work/sick" || fail "the missing route is not found"
grep -q "fix: .*ip route add 224.0.0.0/4 dev lo" "$work/sick" || fail "no command that mends it"

"$in_namespace" "$orchard" doctor >"$work/well" 2>&1 || { cat "$work/well" >&2; fail "a good network: not 0"; }
grep -q "OK .*was received" "$work/well" || { cat "$work/well" >&2; fail "no self test"; }

"$in_namespace" "$orchard" doctor --json >"$work/json" || fail "doctor --json: not 0"
grep -q '"worst": "\(ok\|warn\)"' "$work/json" && grep -q '"level": "ok"' "$work/json" ||
  { cat "$work/json" >&2; fail "doctor --json says something else"; }

cat >"$work/echo.sh" <<'SCRIPT'
"$1/fake_node" --role pose >/dev/null 2>&1 &
node=$!
"$2" echo STATUS --json --count 1
"$2" echo STATUS --count 1
kill "$node"; wait "$node"
SCRIPT
timeout 20 "$in_namespace" bash "$work/echo.sh" "$bin" "$orchard" >"$work/echo" || fail "orchard echo"
cat "$work/echo"
head -1 "$work/echo" | grep -q '"name":"orchard-fake"' || fail "echo --json"
tail -1 "$work/echo" | grep -q 'name="orchard-fake"' || fail "echo in words"
echo "ok: doctor and echo"
