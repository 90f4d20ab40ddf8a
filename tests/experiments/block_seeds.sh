#!/usr/bin/env bash
# Maps the simulated block over seeds 1-20 (or FIRST LAST) and prints what a map must show there:
# the trees' error after rigid alignment on the trees themselves and without it, trees mapped twice
# and missed, the path's error, and processor time per scan in the first, the middle and the last
# thousand. Missed: no landmark of any class within --gate (GATE, 0.3 m) after the alignment.
#   RIG=config/block.yaml  SECONDS_PER_DRIVE=0 (the whole drive)  BUILD=build  OUT=out/block
#   SIM_RIG=$RIG (simulate with another rig's world)
#   RTK=yes (with satellite fixes of 2 cm five times a second, used by slam: what is printed as raw,
#   without alignment, is what counts then; OUT=out/block_rtk)
# Drives are kept in OUT and used again; remove the folder after a change of the simulation.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/block.yaml}
first=${1:-1} last=${2:-20}
out=${OUT:-out/block}
if [ "${RTK:-no}" = yes ]; then
  out=${OUT:-out/block_rtk}
  mkdir -p "$out"
  sed -e 's/^    gnss_rate_hz: 0$/    gnss_rate_hz: 5.0\n    gnss_sd_m: 0.02/' \
    -e 's/^  mode: slam$/&\n  slam:\n    use_gnss: true\n  gnss:\n    datum: [-27.6040, 151.9320, 690.0]/' \
    "$rig" >"$out/rig.yaml"
  rig=$out/rig.yaml
fi
mkdir -p "$out"

# number JSON KEY [AFTER]: the first number of that key, behind the first line that has AFTER
number() {
  awk -v key="\"$2\":" -v after="${3:-}" '
    after != "" && index($0, "\"" after "\":") { seen = 1 }
    (after == "" || seen) && index($0, key) { sub(/.*: /, ""); sub(/,.*/, ""); print; exit }' "$1"
}

printf '%5s %6s %9s %9s %6s %6s %6s %9s %8s %9s  %s\n' seed trees 'RMS (m)' 'raw (m)' 'twice%' \
  'miss%' 'class%' 'path (m)' 'yaw (d)' 'largest' 'ms a scan: first, middle, last thousand'
for seed in $(seq "$first" "$last"); do
  stem=$out/$seed
  if [ ! -s "$stem.lcm" ]; then
    nice -n 15 "$orchard" simulate --scene orchard --seed "$seed" --config "${SIM_RIG:-$rig}" \
      --duration "${SECONDS_PER_DRIVE:-0}" --out "$stem.part.lcm" --truth "$stem.truth.csv" \
      --poses "$stem.poses.csv" >/dev/null
    mv "$stem.part.lcm" "$stem.lcm"
  fi
  nice -n 15 "$orchard" map "$stem.lcm" --config "$rig" --out "$stem" --quiet --timing >"$stem.txt"
  "$orchard" evaluate map "$stem" --truth "$stem.truth.csv" --poses "$stem.poses.csv" --align \
    --gate "${GATE:-0.3}" --json >"$stem.map.json"
  "$orchard" evaluate trajectory "$stem" --truth "$stem.poses.csv" --align --json >"$stem.path.json"
  trees=$(number "$stem.map.json" num_trees)
  wrong=$(number "$stem.map.json" object tree)
  timing=$(awk '/^timing: scans/ { t[++n] = $4 } END { if (n) printf "%s %s %s", t[1], t[int((n + 1) / 2)], t[n] }' \
    "$stem.txt")
  awk -v seed="$seed" -v trees="$trees" -v rms="$(number "$stem.map.json" rms_m error_trees)" \
    -v raw="$(number "$stem.map.json" rms_m error_trees_unaligned)" \
    -v twice="$(number "$stem.map.json" num_duplicates)" \
    -v missed="$(number "$stem.map.json" num_trees_missed)" -v wrong="$wrong" \
    -v path="$(number "$stem.path.json" rmse ape_position_m)" \
    -v far="$(number "$stem.path.json" max ape_position_m)" \
    -v yaw="$(number "$stem.path.json" rmse ape_yaw_rad)" -v timing="$timing" 'BEGIN {
      printf "%5d %6d %9.4f %9.4f %6.2f %6.2f %6.2f %9.4f %8.3f %9.3f  %s\n", seed, trees, rms, raw,
        100 * twice / trees, 100 * missed / trees, 100 * wrong / trees, path, yaw * 57.29578, far,
        timing }'
done | tee "$out/table.txt"
awk '{ n++; for (i = 3; i <= 10; ++i) { sum[i] += $i; if ($i > most[i]) most[i] = $i }
       if ($3 <= 0.10 && $5 <= 1 && $6 <= 1) good++ }
  END { if (!n) exit
    printf "%5s %6s", "mean", ""
    printf " %9.4f %9.4f %6.2f %6.2f %6.2f %9.4f %8.3f %9.3f\n", sum[3] / n, sum[4] / n, sum[5] / n,
      sum[6] / n, sum[7] / n, sum[8] / n, sum[9] / n, sum[10] / n
    printf "%5s %6s", "most", ""
    printf " %9.4f %9.4f %6.2f %6.2f %6.2f %9.4f %8.3f %9.3f\n", most[3], most[4], most[5], most[6],
      most[7], most[8], most[9], most[10]
    printf "%d of %d seeds with RMS <= 0.10 m, twice <= 1 %%, missed <= 1 %%\n", good, n }' \
  "$out/table.txt"
