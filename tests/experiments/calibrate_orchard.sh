#!/usr/bin/env bash
# Learns every model of config/orchard_hard.yaml anew, from simulated drives of seeds 1001 and up
# that no reported figure uses, each under another light: trunk width and hue (`orchard calibrate
# trunks`), what trunks look like (`learn_appearance`), then what probability all that
# stands for (`orchard calibrate probability`).
#   tests/experiments/calibrate_orchard.sh [OUT.yaml]    RIG=config/orchard_hard.yaml DRIVES=12
# Without OUT.yaml the rig itself is rewritten (the old one kept as .bak). Drives are kept in
# out/orchard_fit. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
. tests/experiments/orchard_lights.sh
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/orchard_hard.yaml}
result=${1:-$rig}
out=${OUT:-out/orchard_fit}
mkdir -p "$out"
read -r -a lights <<<"$orchard_lights"

logs=() looks=()
for ((i = 0; i < ${DRIVES:-12}; ++i)); do
  seed=$((1001 + i)) light=${lights[$((i % ${#lights[@]}))]}
  stem="$out/${light}_$seed"
  light_rig "$light" "$rig" >"$stem.yaml"
  drive "$orchard" "$stem.yaml" "$seed" "${SECONDS_PER_DRIVE:-0}" "$stem" &
  [ "$(jobs -rp | wc -l)" -lt 2 ] || wait -n
  logs+=("$stem.lcm")
  looks+=("$stem.looks.csv")
done
wait
if [ "${TRUNKS:-1}" = 1 ]; then
  "$orchard" calibrate trunks "${logs[@]}" --config "$rig" --out "$result" \
    --colour-model hue_interval | tail -n 4
  rig=$result
fi
"${BUILD:-build}/experiments/learn_appearance" "${logs[@]}" --observations "${looks[@]}" --config "$rig" \
  --out "$result" --stride 1
rig=$result
"${BUILD:-build}/experiments/learn_probability" "${logs[@]}" --observations "${looks[@]}" --config "$rig" \
  --out "$result"
