#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Does `calibrate trunks` learn as well by itself as from trees that a person picked? Over seeds 1-10
# (or FIRST LAST) of the hard orchard, each under another colour of light: the model is learnt from
# one drive, automatically and from the landmarks of a first map that are trees in truth, and both
# judge another drive in the same light. Prints F1 per observation and per landmark for both.
#   LIGHTS="8000k 3000k 6500k 4000k 10000k"  SECONDS_PER_DRIVE=40  OUT=out/automatic  BUILD=build
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
. tests/experiments/orchard_lights.sh
orchard=${BUILD:-build}/bin/orchard
out=${OUT:-out/automatic}
read -r -a lights <<<"${LIGHTS:-8000k 3000k 6500k 4000k 10000k}"
mkdir -p "$out"

# A rig nobody has calibrated: the decision needs no truth, and colour is the paper's interval.
python3 - config/orchard_hard.yaml "$out/rig.yaml" <<'PYTHON'
import sys
kept, left_out = [], None
for line in open(sys.argv[1]):
    indent = len(line) - len(line.lstrip())
    if left_out is not None and line.strip() and indent <= left_out:
        left_out = None
    key = line.strip().split(':')[0]
    if line.startswith('  ') and key in ('probability', 'appearance', 'colour'):
        left_out = indent
    if left_out is None and key not in ('colour_model', 'decision') and not key.startswith('evidence'):
        kept.append(line)
open(sys.argv[2], 'w').writelines(kept)
PYTHON

# figure REPORT ROW: F1 of the first row that begins so
figure() { awk -v row="$2" 'index($0, row) == 1 { print $5; exit }' "$1"; }

for seed in $(seq "${1:-1}" "${2:-10}"); do
  light=${lights[$(((seed - 1) % ${#lights[@]}))]}
  learn=$out/${light}_$seed judge=$out/${light}_$((seed + 100))
  light_rig "$light" "$out/rig.yaml" >"$learn.yaml"
  for which in "$seed" "$((seed + 100))"; do
    drive "$orchard" "$learn.yaml" "$which" "${SECONDS_PER_DRIVE:-40}" "$out/${light}_$which"
  done
  "$orchard" map "$learn.lcm" --config "$learn.yaml" --out "$learn" --quiet
  "$orchard" calibrate trunks "$learn.lcm" --config "$learn.yaml" --out "$learn.auto.yaml" \
    >"$learn.auto.log" 2>&1
  # Landmarks that were never seen in full are named by the first try and left out by the second.
  picked=$(python3 tests/experiments/tree_ids.py "$learn.truth.csv" "$learn/map.csv")
  if ! "$orchard" calibrate trunks "$learn.lcm" --config "$learn.yaml" --out "$learn.guided.yaml" \
    --map "$learn" --ids "$picked" >"$learn.guided.log" 2>&1; then
    unseen=$(sed -n 's/.*no complete observation of these landmarks of the map: landmark \(.*\); remove.*/\1/p' "$learn.guided.log" |
      sed -e 's/ at ([^)]*) m//g' -e 's/ //g')
    picked=$(python3 -c "print(','.join(i for i in '$picked'.split(',') if i not in '$unseen'.split(',')))")
    "$orchard" calibrate trunks "$learn.lcm" --config "$learn.yaml" --out "$learn.guided.yaml" \
      --map "$learn" --ids "$picked" >"$learn.guided.log" 2>&1
  fi
  for way in auto guided; do
    "$orchard" map "$judge.lcm" --config "$learn.$way.yaml" --out "$judge.$way" --quiet
    "${BUILD:-build}/experiments/evaluate_detections" "$judge.$way" --observations "$judge.looks.csv" \
      --truth "$judge.truth.csv" >"$judge.$way.txt"
    declare "look_$way=$(figure "$judge.$way.txt" 'per observation')"
    declare "mark_$way=$(figure "$judge.$way.txt" 'per landmark')"
  done
  echo "$seed $light $look_auto $look_guided $mark_auto $mark_guided"
done | tee "$out/figures.txt" |
  awk '{ printf "seed %d, %s: per observation automatic %.4f guided %.4f (lost %+.4f), per landmark %.4f %.4f\n",
           $1, $2, $3, $4, $4 - $3, $5, $6; fflush() }
       { auto += $3; guided += $4; marks += $5; picked += $6; if ($4 - $3 > worst) worst = $4 - $3 }
       END { printf "mean: per observation automatic %.4f guided %.4f (lost %+.4f, at worst %+.4f; 0.01 wanted), per landmark %.4f %.4f\n",
           auto / NR, guided / NR, (guided - auto) / NR, worst, marks / NR, picked / NR }'
