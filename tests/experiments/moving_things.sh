#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What people and vehicles leave in the map: simulates the block with PEOPLE walkers and VEHICLES
# that stand in an alley and drive off, maps it over seeds 1-5 (or FIRST LAST), and prints how many
# landmarks stand where nothing of the truth does (ghosts), how many trees are missing, and the same
# for a map that gives nothing up (mapper.existence.enabled: false).
#   RIG=config/block.yaml  PEOPLE=12  VEHICLES=4  LAPS=1  SECONDS_PER_DRIVE=0 (all)
#   HOW="beams off" (which maps)  GHOST_M=0.4 (from every true thing's edge)
# Seeds from 1001 on are for choosing, 1-20 for reporting. Drives are kept in OUT (out/moving) and
# used again; remove the folder after a change of the simulation.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/block.yaml}
first=${1:-1} last=${2:-5}
out=${OUT:-out/moving}
mkdir -p "$out"

# The rig with what moves in it; by fixes the path is known, so that what is counted is this alone.
sed -e "s/^    laps: .*/    laps: ${LAPS:-1}/" -e "s/^    fix_rate_hz: .*/    fix_rate_hz: 10/" \
  -e 's/^  mode: slam$/  mode: fixes/' "$rig" |
  awk -v people="${PEOPLE:-12}" -v vehicles="${VEHICLES:-4}" '
    { print }
    /^  clutter:/ { own = 1 }
    END { if (!own) printf "  clutter:\n    num_people: %d\n    num_vehicles: %d\n", people, vehicles }' \
    >"$out/world.yaml"
sed -i -e "s/^    num_people: .*/    num_people: ${PEOPLE:-12}/" "$out/world.yaml"
grep -q num_vehicles "$out/world.yaml" ||
  sed -i -e "s/^  clutter:/&\n    num_vehicles: ${VEHICLES:-4}/" "$out/world.yaml"

# existence KEY VALUE: the world's rig with that key of mapper.existence
existence() {
  if grep -q '^  existence:' "$out/world.yaml"; then
    sed -e "s/^  existence:.*/&\n    $1: $2/" "$out/world.yaml"
  else
    sed -e "s/^mapper:.*/&\n  existence:\n    $1: $2/" "$out/world.yaml"
  fi
}
cp "$out/world.yaml" "$out/beams.yaml"
existence enabled false >"$out/off.yaml"

# score TRUTH MAP: landmarks, ghosts, trees without a landmark within 0.3 m, trees
score() {
  awk -F, -v far="${GHOST_M:-0.4}" '
    FNR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    NR == FNR { x[++n] = $column["x_m"]; y[n] = $column["y_m"]; w[n] = $column["width_m"]
                tree[n] = $column["class"] == "tree"; next }
    { ++num; own = 0
      for (i = 1; i <= n; ++i) {
        dx = $column["x_m"] - x[i]; dy = $column["y_m"] - y[i]; d = sqrt(dx * dx + dy * dy)
        if (d < far + w[i] / 2) own = 1
        if (tree[i] && d < 0.3) found[i] = 1
      }
      ghosts += !own }
    END { for (i = 1; i <= n; ++i) { trees += tree[i]; missed += tree[i] && !found[i] }
          printf "%d %d %d %d", num, ghosts, missed, trees }' "$1" "$2"
}

how=${HOW:-beams off}
printf '%5s' seed
for one in $how; do printf '  %-38s' "$one: landmarks, ghosts, trees missed"; done
printf '\n'
for seed in $(seq "$first" "$last"); do
  stem=$out/$seed
  if [ ! -s "$stem.lcm" ]; then
    nice -n 15 "$orchard" simulate --scene orchard --seed "$seed" --config "$out/world.yaml" \
      --duration "${SECONDS_PER_DRIVE:-0}" --out "$stem.part.lcm" --truth "$stem.truth.csv" >/dev/null
    mv "$stem.part.lcm" "$stem.lcm"
  fi
  printf '%5d' "$seed"
  for one in $how; do
    nice -n 15 "$orchard" map "$stem.lcm" --config "$out/$one.yaml" --out "$stem.$one" --quiet
    read -r landmarks ghosts missed trees < <(score "$stem.truth.csv" "$stem.$one/map.csv"; echo)
    printf '  %-38s' "$landmarks $ghosts $missed of $trees"
  done
  printf '\n'
done | tee "$out/table.txt"
