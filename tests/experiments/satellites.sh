#!/usr/bin/env bash
# A car in a park with a receiver of 2.5 m in bursts: gaps of 20 to 180 s, an error that wanders in a
# minute, multipath for a twentieth of the time. Over seeds 1-20 (or FIRST LAST): fixes, gaps, the
# path as told at the time (RMSE outside of gaps, most, inside), the same once smoothed, the worst
# gap's RMSE as percent of the way driven in it and how many gaps keep below one percent, good fixes
# left out and for how long at most, NEES of the last pose (2 expected) told at the time and smoothed;
# then the bound, an estimator that knows the true noise and which fixes are reflected: RMSE outside of
# gaps as told and smoothed, its worst gap and gaps below one percent, NEES of the last pose.
#   MODE=fused (slam: drives are simulated whole and mapped with fixes)  OUT=out/satellites
# last, with the true path for a map without errors: its RMSE outside of gaps, registered to the fixes.
#   RIG=config/park.yaml  SCENE=park  SED='s/a/b/' (another rig)  BUILD=build
#   STATED_M=0 (what the receiver states as its standard deviation; 0: the true one)
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=${BUILD:-build} out=${OUT:-out/satellites} mode=${MODE:-fused} scene=${SCENE:-park}
first=${1:-1} last=${2:-20}
mkdir -p "$out"
rig=$out/$mode.yaml
use=
if [ "$mode" = slam ]; then use=$'  slam:\\\n    use_gnss: true\\\n'; fi
sed -e "s/^  mode: slam\$/  mode: $mode\\
${use}  gnss:\\
    datum: [-27.6040, 151.9320, 690.0]/" \
  -e 's/^    gnss_rate_hz: 0$/    gnss_rate_hz: 5.0\
    gnss_sd_m: 0.5/' -e "${SED:-}" "${RIG:-config/park.yaml}" >"$rig"
cat >>"$rig" <<EOF

  gnss:
    stated_sd_m: ${STATED_M:-0}
    sky:
      wander_sd_m: 1.7
      gap_every_s: 40.0
      burst_s: 8.0
      pause_s: 3.0
      multipath_fraction: 0.05
EOF
if [ "$mode" = fused ]; then
  nice -n 10 "$build/experiments/satellites" "$rig" "$scene" "$first" "$last" | tee "$out/$mode.txt"
  exit
fi
for seed in $(seq "$first" "$last"); do
  if [ ! -s "$out/$seed.lcm" ]; then
    nice -n 10 "$build/bin/orchard" simulate --scene "$scene" --seed "$seed" --config "$rig" \
      --out "$out/$seed.part.lcm" --poses "$out/$seed.poses.csv" >/dev/null
    mv "$out/$seed.part.lcm" "$out/$seed.lcm"
  fi
  nice -n 10 "$build/bin/orchard" map "$out/$seed.lcm" --config "$rig" --out "$out/$seed" --quiet \
    >"$out/$seed.txt" 2>&1
  nice -n 10 "$build/experiments/satellites" "$rig" "$scene" "$seed" "$seed" \
    "$out/$seed/trajectory.csv" | tail -n 1
  tail -n 2 "$out/$seed.txt"
done
