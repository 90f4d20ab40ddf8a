#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# orchard-gnss-driver behind a real gpsd whose receiver is played by gpsfake.
#   gpsfake_test.sh BIN WATCH_BIN
. "$(dirname "$0")/../bus/common.sh"
bin=$(realpath "$1")
watch_bin=$2
here=$(cd "$(dirname "$0")" && pwd)
for tool in gpsfake gpsd python3; do
  PATH=$PATH:/usr/sbin command -v $tool >/dev/null || { echo "skipped: no $tool here (gpsd, gpsd-clients)"; exit 77; }
done
export PATH=$PATH:/usr/sbin
python3 "$here/make_nmea.py" >"$work/receiver.nmea"
port=22947

# Nobody there yet: said, and no reason to end.
start "$work/driver.log" "$bin/orchard-gnss-driver" --device tcp:127.0.0.1:$port --lcm-url "$url"
driver=$started
"$watch_bin/status_watch" "$url" orchard-gnss-driver 0 "tcp:127.0.0.1:$port" ||
  { cat "$work/driver.log" >&2; fail "does not say that gpsd is missing"; }
echo "ok: without gpsd"

start "$work/gpsfake.log" gpsfake -q -c 0.066 -P $port "$work/receiver.nmea"
timeout 60 "$bin/orchard" echo GNSS --count 5 --json --lcm-url "$url" >"$work/fixes" ||
  { tail "$work/gpsfake.log" "$work/driver.log" >&2; fail "no GNSS"; }
python3 - "$work/fixes" <<'PY' || fail "the fixes are not those of the receiver"
import json, sys
for line in open(sys.argv[1]):
    fix = json.loads(line)
    assert abs(fix["latitude_deg"] + 32.4) < 1e-6, fix
    assert abs(fix["longitude_deg"] + 71.3) < 1e-6, fix
    assert fix["fix_quality"] in (4, 5), fix
PY
kill -0 "$driver" || fail "the driver ended"
echo "ok: gpsd and a receiver of RTK quality"
