#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Do probabilities learnt from a map whose trees a person picked judge as well as those learnt from
# the truth of each observation? Over the drives and the guided rigs that automatic_calibration.sh
# left in DRIVES, seeds 1-10 (or FIRST LAST): the weights are learnt from one drive and judge
# another. Prints F1 per observation and per landmark of the rig without probabilities and with
# those learnt from the truth and from the map, and the calibration error: stated by
# `calibrate probability`, and on the judged drive.
#   DRIVES=out/automatic  OUT=out/learnt_probability  BUILD=build
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
drives=${DRIVES:-out/automatic}
out=${OUT:-out/learnt_probability}
mkdir -p "$out"

# learn WAY STEM: the guided rig with probabilities learnt from the drive STEM, decided by them
learn() {
  local source=(--observations "$2.looks.csv") rig=$out/$(basename "$2").$1.yaml
  local program=("${BUILD:-build}/experiments/learn_probability")
  if [ "$1" = map ]; then
    program=("$orchard" calibrate probability)
    source=(--map "$2" --ids "$(python3 tests/experiments/tree_ids.py "$2.truth.csv" "$2/map.csv")")
  fi
  "${program[@]}" "$2.lcm" "${source[@]}" --config "$2.guided.yaml" --out "$rig" \
    >"${rig%.yaml}.log" 2>&1
  sed -i '/^  decision:/d; s/^detector:/&\n  decision: probability/; s/^mapper:/&\n  evidence: probability/' "$rig"
}

for seed in $(seq "${1:-1}" "${2:-10}"); do
  learn=$(ls "$drives"/*k_"$seed".guided.yaml)
  learn=${learn%.guided.yaml} judge=${learn%_*}_$((seed + 100)) name=$(basename "$learn")
  sed '/^  decision:/d' "$learn.guided.yaml" >"$out/$name.none.yaml"  # decides as the paper does
  learn truth "$learn"
  learn map "$learn"
  figures="$seed"
  for way in none truth map; do
    "$orchard" map "$judge.lcm" --config "$out/$name.$way.yaml" --out "$out/$name.$way" --quiet \
      2>"$out/$name.$way.notes"
    "${BUILD:-build}/experiments/evaluate_detections" "$out/$name.$way" --observations "$judge.looks.csv" \
      --truth "$judge.truth.csv" >"$out/$name.$way.txt"
    figures+=$(awk 'index($0, "per observation") == 1 && !look { look = $5 }
                    index($0, "per landmark") == 1 && !mark { mark = $5 }
                    index($0, "probability per observation") == 1 { sub(/.*calibration error /, ""); judged = $1 + 0 }
                    END { printf " %s %s %s", look, mark, judged + 0 }' "$out/$name.$way.txt")
    [ "$way" = none ] ||
      figures+=" $(sed -n 's/.*expected calibration error \([0-9.]*\),.*/\1/p' "$out/$name.$way.log")"
  done
  echo "$figures"
done | tee "$out/figures.txt" |
  awk '{ printf "seed %d: per observation %.4f, by truth %.4f, by map %.4f; per landmark %.4f, %.4f, %.4f\n", $1, $2, $5, $9, $3, $6, $10; fflush() }
       { for (i = 2; i <= NF; ++i) sum[i] += $i
         lost = $5 - $9; squares += lost * lost; if (lost > worst) worst = lost }
       END { n = NR; mean = (sum[5] - sum[9]) / n
             printf "mean: per observation %.4f, by truth %.4f, by map %.4f (lost %+.4f, at worst %+.4f, sd %.4f); per landmark %.4f, %.4f, %.4f\n",
               sum[2] / n, sum[5] / n, sum[9] / n, mean, worst, sqrt(squares / n - mean * mean), sum[3] / n, sum[6] / n, sum[10] / n
             printf "calibration error, stated and on the judged drive: by truth %.4f %.4f, by map %.4f %.4f\n",
               sum[8] / n, sum[7] / n, sum[12] / n, sum[11] / n }'
