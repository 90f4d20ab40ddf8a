#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# scripts/record.sh: a second recording stands beside the first, and NAME.lcm leads to the newest.
record=$2
. "$(dirname "$0")/common.sh"
command -v lcm-logger >/dev/null || { echo "skipped: no lcm-logger here"; exit 77; }
cd "$work"

# record_some LOG: records until the node's first STATUS is in the file; its name is in $newest. Each
# has a LOG of its own: the words of the one before would name the recording before.
record_some() {
  local words=$1
  : >"$words"
  start "$words" "$record" drive "$url"
  local recorder=$started
  until newest=$(sed -n 's/^record: writing \(.*\) from .*/\1/p' "$words") && [ -s "$newest" ]; do
    kill -0 "$recorder" || { cat "$words" >&2; fail "record.sh ended"; }
    sleep 0.1  # between two checks
  done
  kill -TERM "$recorder"  # not INT: a job in the background ignores it until it has a handler
  wait "$recorder" || true
}

start node.log "$bin/fake_node" --role pose
record_some first.log
first=$newest
record_some second.log
[ "$newest" != "$first" ] || fail "the second recording has the first one's name"
[ -s "$first" ] || fail "the first recording is gone"
[ "$(realpath out/recordings/drive.lcm)" = "$(realpath "$newest")" ] || fail "drive.lcm is not the newest"
echo "ok: two recordings, and a name for the newest"
