#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A small farm: 2 blocks, 2 dates, 2 robots, and what goes wrong. Killed twice and resumed it gives the
# bytes of one that was never killed; what was set aside is named; one more log makes only what depends
# on it. Exit code 77: skipped without Snakemake.
# usage: farm_test.sh SOURCE_TREE BIN
set -euo pipefail
source=${1:?usage: farm_test.sh SOURCE_TREE BIN}
orchard=${2:?usage: farm_test.sh SOURCE_TREE BIN}/orchard
command -v snakemake >/dev/null || { echo "skipped: snakemake is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
. "$(dirname "$0")/season.sh"
fail() { echo "FAILED: $*"; [ ! -f "$work/farm/work/snakemake.txt" ] || tail -n 15 "$work/farm/work/snakemake.txt"; exit 1; }

farm=$work/farm
farm_rigs "$source"
make_season "$farm" 2 2 2
cp -r "$farm" "$work/killed"

"$orchard" farm run "$farm" --cores 2 >"$work/said" || fail "a run ended with $?"
cat "$work/said"
# 9 drives: a map for each of 8 pairs of log and rig; 4 dates, a report of
# each, and 2 comparisons with the date before
grep -q '^18 steps made$' "$work/said" || fail "not 18 steps"
grep -q '^set aside (map): block_2/2026-01-01/robot_2/drive: ' "$work/said" || fail "junk is not named"
grep -q '^left out: block_1/2026-02-01/robot_wrong/drive: ' "$work/said" || fail "a wrong rig is not named"
grep -q '^left out: block_2/2026-02-01/robot_2/drive: ' "$work/said" || fail "a log of another block is not named"
grep -q '^damaged: block_1/2026-02-01/robot_1/drive: ' "$work/said" || fail "a damaged log is not named"
[ "$(grep -cE '^(set aside|left out|damaged)' "$work/said")" = 4 ] || fail "more is named than went wrong"

run_and_kill "$work/killed" 5 all || fail "nothing was made"
run_and_kill "$work/killed" 12 engine || fail "nothing more was made"
num=$(num_made "$work/killed")
[ "$num" -lt 18 ] || echo "note: nothing was left to resume"
"$orchard" farm run "$work/killed" --cores 2 >"$work/said" || fail "a resumed run ended with $?"
echo "killed with $num results there, resumed: $(head -n 1 "$work/said")"
wait_until 60 eval '! ls -d "$work"/killed/results/.making-* 2>/dev/null | grep -q .' || true
[ "$(digest_of "$farm")" = "$(digest_of "$work/killed")" ] || {
  diff -rq "$farm/results" "$work/killed/results"
  fail "killed and resumed it gives other bytes"
}

"$orchard" farm run "$farm" | grep -q '^0 steps made$' || fail "what is made was made again"
sed 's/rate_hz: 6.8/rate_hz: 7.3/' "$work/rig_1_2.yaml" >"$work/rig_1_late.yaml"
drive 2 1 late "$work/more.lcm"
farm=$farm add "$work/more.lcm" 2 1 late # a map, both dates of the block, their reports and comparison
"$orchard" farm run "$farm" --cores 2 >"$work/said" || fail "with one more log the run ended with $?"
grep -q '^6 steps made$' "$work/said" || fail "one more log: $(head -n 1 "$work/said")"
"$orchard" farm publish "$farm"
[ "$(find "$farm/maps/" -mindepth 2 -name '2026-0*-01' | wc -l)" = 4 ] || fail "not every date is published"
[ -s "$farm/maps/block_2/2026-02-01/map.csv" ] || fail "a published map cannot be read"
[ -s "$farm/reports/block_2/2026-01-01/report.html" ] || fail "a published report cannot be read"
grep -q 'block_2 2026-01-01' "$farm/reports/block_2/2026-01-01/report.html" || fail "a report does not say of what it is"
[ -s "$farm/changes/block_1/2026-02-01/compare.csv" ] || fail "a published comparison cannot be read"
echo "PASSED"
