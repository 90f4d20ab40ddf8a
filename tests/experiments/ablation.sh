#!/usr/bin/env bash
# The ablation table of tests/RESULTS.md: the paper's rules in the hard orchard, then each
# improvement on top of those before it. Every step learns its own models from drives of seeds 1001
# and up (each under another light) and is judged on the same drives of seeds 1-20 (or FIRST LAST)
# under the rig's own light. Prints the table; with --write it replaces the one of that page.
#   RIG=config/orchard_hard.yaml DRIVES=12 SECONDS_PER_DRIVE=0 (the whole drive)
# Drives are kept in out/orchard and out/orchard_fit. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
known_options="--write"
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
. tests/experiments/orchard_lights.sh
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/orchard_hard.yaml}
page=tests/RESULTS.md
write=0
if [ "${1:-}" = --write ]; then write=1 && shift; fi
first=${1:-1} last=${2:-20} seconds=${SECONDS_PER_DRIVE:-0} drives=${DRIVES:-12}
out=out/orchard fit=out/orchard_fit work=out/ablation
mkdir -p "$out" "$fit" "$work"
read -r -a lights <<<"$orchard_lights"

for seed in $(seq "$first" "$last"); do
  drive "$orchard" "$rig" "$seed" "$seconds" "$out/neutral_$seed" &
  [ "$(jobs -rp | wc -l)" -lt 2 ] || wait -n
done
fit_logs=() fit_looks=()
for ((i = 0; i < drives; ++i)); do
  light=${lights[$((i % ${#lights[@]}))]}
  stem="$fit/${light}_$((1001 + i))"
  light_rig "$light" "$rig" >"$stem.yaml"
  drive "$orchard" "$stem.yaml" $((1001 + i)) "$seconds" "$stem" &
  [ "$(jobs -rp | wc -l)" -lt 2 ] || wait -n
  fit_logs+=("$stem.lcm") fit_looks+=("$stem.looks.csv")
done
wait

# set_key FILE SECTION KEY VALUE: SECTION is detector, mapper or one of detector's own sections
set_key() {
  awk -v section="$2" -v key="$3" -v value="$4" '
    function indent(line) { match(line, /^ */); return RLENGTH }
    BEGIN { n = split(section, path, "."); want = 2 * n }
    {
      if ($0 !~ /^ *(#|$)/) {
        level = indent($0) / 2
        name = $1; sub(/:.*/, "", name)
        inside = 0
        if (level == 0) at0 = name
        if (level == 1) at1 = name
        if (n == 1 && level == 1 && at0 == path[1]) inside = 1
        if (n == 2 && level == 2 && at0 == path[1] && at1 == path[2]) inside = 1
        if (inside && name == key) next
      }
      lines[++count] = $0
    }
    END {
      for (i = 1; i <= count; ++i) if (n == 2 && lines[i] ~ "^  " path[2] ":") has_sub = 1
      for (i = 1; i <= count; ++i) {
        print lines[i]
        if (n == 1 && lines[i] ~ "^" path[1] ":") { print "  " key ": " value; done = 1 }
        if (n == 2 && has_sub && lines[i] ~ "^  " path[2] ":") print "    " key ": " value
        if (n == 2 && !has_sub && lines[i] ~ "^" path[1] ":")
          print "  " path[2] ":\n    " key ": " value
      }
      if (n == 1 && !done) print path[1] ":\n  " key ": " value
    }' "$1" >"$1.new"
  mv "$1.new" "$1"
}

step=0
rows=
appearance=0 probability=0
# judge NAME: learns, maps and evaluates $work/rig.yaml; one row of the table
judge() {
  step=$((step + 1))
  local dir="$work/$step"
  mkdir -p "$dir"
  "$orchard" calibrate trunks "${fit_logs[@]}" --config "$work/rig.yaml" --out "$work/rig.yaml" \
    --colour-model hue_interval --quiet
  if [ "$appearance" = 1 ]; then
    "${BUILD:-build}/experiments/learn_appearance" "${fit_logs[@]}" --observations "${fit_looks[@]}" \
      --config "$work/rig.yaml" --out "$work/rig.yaml" --stride 1 --quiet
    # a look then counts by its probability, not by a gate before it
    if [ "$probability" = 1 ]; then
      set_key "$work/rig.yaml" detector.appearance confidence_min 0.0
    fi
  fi
  if [ "$probability" = 1 ]; then
    "${BUILD:-build}/experiments/learn_probability" "${fit_logs[@]}" --observations "${fit_looks[@]}" \
      --config "$work/rig.yaml" --out "$work/rig.yaml" --quiet
    set_key "$work/rig.yaml" detector decision probability
    set_key "$work/rig.yaml" mapper evidence probability
  fi
  cp "$work/rig.yaml" "$dir/rig.yaml"
  local recordings=() looks=() truths=()
  for seed in $(seq "$first" "$last"); do
    "$orchard" map "$out/neutral_$seed.lcm" --config "$dir/rig.yaml" --out "$dir/$seed" --quiet
    recordings+=("$dir/$seed") looks+=("$out/neutral_$seed.looks.csv")
    truths+=("$out/neutral_$seed.truth.csv")
  done
  "${BUILD:-build}/experiments/evaluate_detections" "${recordings[@]}" --observations "${looks[@]}" \
    --truth "${truths[@]}" >"$dir/report.txt"
  rows+=$(awk -v name="$1" '
    index($0, "per observation ") == 1 && !p { p = $3; r = $4; f = $5 }
    index($0, "per landmark ") == 1 && !l { l = $5 }
    index($0, "3 to 4 m") == 1 && !c { c = $11 }
    END { printf "| %s | %s | %s | %s | %s | %s |", name, p, r, f, l, c == "" ? "-" : c }' \
    "$dir/report.txt")$'\n'
  echo "$rows" | tail -n 2 | head -n 1 >&2
}

cp "$rig" "$work/rig.yaml"
set_key "$work/rig.yaml" detector.width mode paper
set_key "$work/rig.yaml" detector colour_model hue_interval
set_key "$work/rig.yaml" detector use_odometry false
set_key "$work/rig.yaml" detector decision roc
set_key "$work/rig.yaml" detector visible_fraction_min 1.0
set_key "$work/rig.yaml" mapper evidence labels
set_key "$work/rig.yaml" mapper min_observations 1
set_key "$work/rig.yaml" mapper merge_m 0.10
set_key "$work/rig.yaml" mapper deskew_pose_gap_max_s 0
set_key "$work/rig.yaml" detector.segmentation split_touching false
set_key "$work/rig.yaml" detector.segmentation min_beams_circle 1000
judge "the paper's rules"
set_key "$work/rig.yaml" detector.width mode compensated
judge "compensated width"
set_key "$work/rig.yaml" detector.segmentation split_touching true
set_key "$work/rig.yaml" detector.segmentation min_beams_circle 3
set_key "$work/rig.yaml" detector visible_fraction_min 0.7
judge "segmentation"
appearance=1
judge "appearance"
set_key "$work/rig.yaml" detector use_odometry true
set_key "$work/rig.yaml" detector pairing_tolerance_s 0.1
set_key "$work/rig.yaml" mapper deskew_pose_gap_max_s 0.25
judge "motion within the scan and to the picture"
probability=1
judge "probability"
set_key "$work/rig.yaml" mapper min_observations 4
set_key "$work/rig.yaml" mapper merge_m 0.05
judge "landmarks seen four times, and 5 cm apart"

how="seeds $first-$last, $([ "$seconds" = 0 ] && echo "whole drives" || echo "the first $seconds s of each drive"); models from $drives drives of seeds 1001 and up, as long"
text="| rules so far, and | precision | recall | F1 per observation | F1 per landmark | centre at 3-4 m (mm RMS) |
|---|---|---|---|---|---|
${rows}
$how"
echo "$text"
if [ "$write" = 1 ]; then
  echo "$text" >"$work/table.md"
  awk -v file="$work/table.md" '
    index($0, "<!-- ablation: ") == 1 {
      print; print "";
      while ((getline line < file) > 0) print line;
      print ""; skip = 1; next
    }
    index($0, "<!-- end of ablation -->") == 1 { skip = 0 }
    !skip' "$page" >"$page.new"
  mv "$page.new" "$page"
fi
