#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# units_test.sh SOURCE_TREE BIN: systemd reads every unit of config/deploy without a complaint, each
# names a program that is built, all share the hardening and the watchdog.
set -euo pipefail
units=$1/config/deploy/systemd
bin=$2
fail() { echo "FAILED: $*" >&2; exit 1; }
command -v systemd-analyze >/dev/null || { echo "skipped: systemd-analyze is missing" >&2; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$units/." "$work"
# the programs as they are here, not as a package would install them
sed -i "s,^ExecStart=orchard,ExecStart=$bin/orchard," "$work"/*.service
export SYSTEMD_UNIT_PATH=$work:  # and then the system's own

for file in "$work"/*.service "$work"/*.target; do
  unit=$(basename "$file" | sed 's/@\./@koala./')
  said=$(systemd-analyze verify --man=no "$unit" 2>&1 | grep -F "$work" || true)
  said+=$(systemd-analyze verify --man=no "$unit" 2>&1 | grep -E 'orchard|lcm-' || true)
  [ -z "$said" ] || fail "$unit: $said"
done

for file in "$work"/orchard-*@.service; do
  unit=$(basename "$file" | sed 's/@\./@koala./')
  all=$(systemd-analyze security --offline=true --no-pager "$unit" 2>/dev/null) || true
  exposure=$(sed -n 's/.*Overall exposure level for .*: \([0-9.]*\) .*/\1/p' <<<"$all")
  [ -n "$exposure" ] || fail "$unit: systemd-analyze security says nothing"
  awk -v exposure="$exposure" 'BEGIN { exit !(exposure <= 2.5) }' || fail "$unit: exposure $exposure"
  for right in NoNewPrivileges= ProtectSystem= ProtectHome= 'CapabilityBoundingSet=~CAP_SYS_ADMIN'; do
    grep -F -- "$right" <<<"$all" | head -n 1 | grep -q '✓' || fail "$unit: $right is not set"
  done
done

[ "$(grep -rl '^WatchdogSec=' "$work")" = "$work/orchard-.service.d/10-common.conf" ] || fail "who has no watchdog?"
grep -q '^WatchdogSec=[1-9]' "$work/orchard-.service.d/10-common.conf" || fail "no watchdog"
echo "units: $(find "$work" -name '*.service' | wc -l) services and a target are as systemd wants them"
