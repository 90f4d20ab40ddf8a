#!/usr/bin/env bash
# Simulates a drive of 21 km past more than 20,000 trees (config/scale.yaml), maps it, and prints
# what it costs: memory per kilometre and per tree, the factor against real time, and the time per
# scan as the drive goes on. SEED (1) as the first argument.
#   RIG=config/scale.yaml  SECONDS_PER_DRIVE=0 (the whole drive)  BUILD=build  OUT=out/scale
# The log takes half a gigabyte, the map's messages as much again. The drive is kept and used again.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/scale.yaml}
seed=${1:-1}
out=${OUT:-out/scale}
stem=$out/$seed
mkdir -p "$out"

# seconds of processor time of a command, which gets the output file first
cost() {
  local to=$1 TIMEFORMAT='%U %S'
  shift
  { time nice -n 15 "$@" >"$to"; } 2>&1 | awk 'NF == 2 { print $1 + $2 }' | tail -1
}

if [ ! -s "$stem.lcm" ]; then
  seconds=$(cost "$stem.sim.txt" "$orchard" simulate --scene orchard --seed "$seed" --config "$rig" \
    --duration "${SECONDS_PER_DRIVE:-0}" --out "$stem.part.lcm" --truth "$stem.truth.csv" \
    --poses "$stem.poses.csv")
  mv "$stem.part.lcm" "$stem.lcm"
  echo "simulated in $seconds s of processor time"
fi
# driven: kilometres and seconds, from the true poses
read -r km seconds < <(awk -F, 'NR == 2 { first = $1 }
  NR > 2 { way += sqrt(($2 - x)^2 + ($3 - y)^2) }
  NR > 1 { x = $2; y = $3; last = $1 }
  END { printf "%.3f %.1f\n", way / 1000, (last - first) / 1e6 }' "$stem.poses.csv")
trees=$(grep -c '^tree,' "$stem.truth.csv")
processor=$(cost "$stem.txt" "$orchard" map "$stem.lcm" --config "$rig" --out "$stem" --timing)
grep -v '^timing:' "$stem.txt" | head -3
awk -v km="$km" -v seconds="$seconds" -v trees="$trees" -v processor="$processor" '
  / landmarks: / { mapped = $3 }
  /^timing: scans/ { n++; ms[n] = $4; mib[n] = $8 }
  /^timing: in all/ { most = $4 }
  END {
    if (n < 2) { print "too few scans to tell"; exit }
    printf "%.2f km in %.0f s past a block of %d trees; mapped in %.1f s of processor time: %.1f times real time (wanted: 50)\n",
      km, seconds, trees, processor, seconds / processor
    printf "ms a scan by tenths of the drive:"
    for (i = 1; i <= 10; ++i) printf " %s", ms[int(1 + (n - 1) * (i - 1) / 9)]
    printf "\nmemory by tenths (MiB):"
    for (i = 1; i <= 10; ++i) printf " %s", mib[int(1 + (n - 1) * (i - 1) / 9)]
    printf "\nmemory beyond the first thousand scans: %.2f MiB per km, %.2f kiB per tree mapped (%d)\n",
      (mib[n] - mib[1]) / km, mapped ? 1024 * (mib[n] - mib[1]) / mapped : 0, mapped
    printf "the same with the files that are written: %.2f MiB per km (most: %.1f MiB)\n", (most - mib[1]) / km, most }' "$stem.txt"
