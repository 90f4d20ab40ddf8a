#!/usr/bin/env bash
# Maps the hard orchard over seeds 1-20 (or FIRST LAST) under every light and prints what the detector
# must show: precision, recall and F1 per look within 4 m and per landmark, the centre error, the
# calibration error, and the F1 lost to each light. No model was fitted or chosen on these seeds
# (tests/experiments/calibrate_orchard.sh uses 1001 and up).
#   RIG=config/orchard_hard.yaml  SECONDS_PER_DRIVE=0 (the whole drive)  LIGHTS="neutral dark ..."  JOBS=2
# LIGHTS=posts: in the rig's own light, with a post of trunk width more for every third tree.
# Drives are kept in out/orchard and used again; remove the folder after a change of the simulation.
# A whole drive takes about a minute to simulate. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
. tests/experiments/orchard_lights.sh
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/orchard_hard.yaml}
first=${1:-1} last=${2:-20}
out=${OUT:-out/orchard}
mkdir -p "$out"

one() {  # LIGHT SEED: simulated, mapped
  local stem="$out/$1_$2"
  light_rig "$1" "$rig" >"$stem.yaml"
  drive "$orchard" "$stem.yaml" "$2" "${SECONDS_PER_DRIVE:-0}" "$stem"
  "$orchard" map "$stem.lcm" --config "$stem.yaml" --out "$stem" --quiet
}

# figure REPORT ROW COLUMN: of the first row that begins so
figure() { awk -v row="$2" -v column="$3" 'index($0, row) == 1 { print $column; exit }' "$1"; }
# error_of REPORT WHAT: its expected calibration error
error_of() { sed -n "s/^probability per $2: expected calibration error \([0-9.]*\),.*/\1/p" "$1"; }

neutral_f1=
for light in ${LIGHTS:-$orchard_lights}; do
  recordings=() looks=() truths=()
  for seed in $(seq "$first" "$last"); do
    one "$light" "$seed" &
    [ "$(jobs -rp | wc -l)" -lt "${JOBS:-2}" ] || wait -n
    recordings+=("$out/${light}_$seed")
    looks+=("$out/${light}_$seed.looks.csv")
    truths+=("$out/${light}_$seed.truth.csv")
  done
  wait
  report=$out/$light.txt
  "${BUILD:-build}/experiments/evaluate_detections" "${recordings[@]}" --observations "${looks[@]}" \
    --truth "${truths[@]}" >"$report"
  f1=$(figure "$report" "per observation" 5)
  [ -n "$neutral_f1" ] || neutral_f1=$f1
  printf '%-8s look: precision %s recall %s F1 %s (lost %+.4f)  landmark: F1 %s  ECE: look %s landmark %s\n' \
    "$light" "$(figure "$report" "per observation" 3)" "$(figure "$report" "per observation" 4)" \
    "$f1" "$(awk "BEGIN { print $neutral_f1 - $f1 }")" "$(figure "$report" "per landmark" 5)" \
    "$(error_of "$report" observation)" "$(error_of "$report" landmark)"
  for stretch in "2 to 3 m" "3 to 4 m" "4 to 5 m"; do
    printf '         %s: precision %s recall %s centre %s mm RMS\n' "$stretch" \
      "$(figure "$report" "$stretch" 5)" "$(figure "$report" "$stretch" 6)" \
      "$(figure "$report" "$stretch" 11)"
  done
done
echo "wanted: look precision 0.98, recall 0.95; landmark F1 0.97; centre 30 mm at 4 m; ECE 0.05; F1 lost 0.02"
