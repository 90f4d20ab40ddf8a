#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# supervisor_test.sh SOURCE_TREE BIN: under config/deploy/supervisord.conf every process runs, one that is
# killed is started again, and at the end the mapper and the recorder have saved what they had.
set -euo pipefail
tree=$1
export PATH=$2:$PATH
command -v supervisord >/dev/null || { echo "skipped: supervisord is missing" >&2; exit 77; }
work=$(mktemp -d)
supervisor=
finish() {
  local code=$?
  if [ -n "$supervisor" ] && kill -TERM "$supervisor" 2>/dev/null; then wait "$supervisor" || true; fi
  rm -rf "$work"
  exit "$code"
}
trap finish EXIT
fail() { echo "FAILED: $*" >&2; tail -n 5 "$work"/*.log >&2; exit 1; }
export ORCHARD_RIG=$tree/config/tubes.yaml ORCHARD_OUT=$work
conf=$tree/config/deploy/supervisord.conf
control() { supervisorctl -c "$conf" "$@"; }
# wait_for SECONDS COMMAND...: until the command succeeds
wait_for() {
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $end ] || return 1
    sleep 0.05
  done
}
running() { [ "$(control status | grep -c ' RUNNING ')" -eq 4 ]; }
is_another() { local now; now=$(control pid detector) && [ "$now" -gt 0 ] && [ "$now" != "$killed" ]; }
saved() { [ -s "$work/map/map.csv" ] && [ "$(wc -l <"$work/map/map.csv")" -gt 3 ]; }

supervisord -c "$conf" >"$work/supervisor.out" 2>&1 &
supervisor=$!
wait_for 20 running || fail "not all four run: $(control status)"
killed=$(control pid detector)
kill -KILL "$killed"
wait_for 20 is_another || fail "the detector is not started again"
orchard-sim-driver --config "$ORCHARD_RIG" --scene tubes --speed 4 --wait-for detector,pose,mapper \
  >"$work/driver.log" 2>&1 || fail "the driver ends with an error"
wait_for 20 saved || fail "no map"
kill -TERM $supervisor
code=0
wait $supervisor || code=$?
supervisor=
[ -s "$work/map/map.gpkg" ] || fail "the mapper has not saved everything at its end"
orchard log info "$work"/recordings/*.lcm | grep -q '^DETECTIONS' || fail "nothing was recorded"
for name in detector pose mapper; do
  grep -q 'stopped: ' "$work/$name.log" || fail "$name was not stopped in order"
done
echo "supervisor: four processes, one killed and started again, all stopped in order"
