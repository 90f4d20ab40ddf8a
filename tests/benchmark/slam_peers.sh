#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Trunk SLAM beside what a user of MRPT would pick, kf-slam and rbpf-slam, on the same simulated
# drives: bearings and ranges of trees at 10 Hz within 5.6 m, one in ten missed, one false sighting
# a second, wheels off by some 3 %, two rounds through blocks of about 50, 100, 200 and 400 trees.
#   tests/benchmark/slam_peers.sh [TREES...]
#   SEEDS="1 2 3"  LIMIT_S=120 (a run that takes longer is given up)  BUILD=build  OUT=out/slam_peers
#   WHO="ours identified nearest joint rbpf" (who takes part)
# Prints medians over the seeds: processor time per scan, RMS error of the path as told on the way
# (aligned), RMS error of the landmarks (aligned on the trees), trees missed, and landmarks beyond
# one per tree. kf-slam runs three times: told each tree's identity (and spared the false
# sightings), and finding out by nearest neighbour or by joint compatibility. rbpf-slam has no map
# of landmarks seen by bearing: it gets each sighting as an arc in a laser scan and maps a grid, so
# that only its path is judged. The competitors' time holds the reading of their log and start.
# Needs the Debian package mrpt-apps. An hour and more; the machine should be quiet.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=$(realpath "${BUILD:-build}")
peers=$build/benchmark/slam_peers
out=${OUT:-out/slam_peers}
read -r -a seeds <<<"${SEEDS:-1 2 3}"
sizes=("$@")
[ ${#sizes[@]} -gt 0 ] || sizes=(50 100 200 400)
inis=$PWD/tests/benchmark/slam_peers
for program in kf-slam rbpf-slam; do
  command -v $program >/dev/null || {
    echo "slam_peers: no $program; install it with: sudo apt-get install mrpt-apps" >&2
    exit 3
  }
done
[ -x "$peers" ] || { echo "slam_peers: no $peers; build it with scripts/build.sh benchmarks" >&2; exit 3; }

# seconds LOG COMMAND...: processor time of a command, "over" when it was given up, "failed"
seconds() {
  local log=$1 TIMEFORMAT='%U %S' status
  shift
  set +e
  { time timeout "${LIMIT_S:-120}" "$@" >"$log" 2>&1 </dev/null; } 2>time.txt
  status=$?
  set -e
  case $status in
    0) awk 'NF == 2 { print $1 + $2 }' time.txt | tail -1 ;;
    124) echo over ;;
    *) echo failed ;;
  esac
}

# kf METHOD RAWLOG LAST: time of a run of kf-slam; its path and landmarks are left for the judge
kf() {
  sed "s/@METHOD@/$1/;s/@LAST@/$3/" "$inis/kf_slam.ini" >kf.ini
  seconds kf.log kf-slam kf.ini "../$2.rawlog"
  awk -F'[(,]' '/Mean pose:/ { print $2, $3 }' kf.log >path.txt
  "$peers" landmarks "kf_out/kf_state_$(printf %05d "$3").3Dscene" . 2>/dev/null || : >landmarks.txt
}

rbpf() {
  seconds rbpf.log rbpf-slam "$inis/rbpf_slam.ini" ../scan.rawlog
  awk '!/^%/ { print $2, $3 }' rbpf_out/log_estimated_path.txt >path.txt 2>/dev/null || : >path.txt
  : >landmarks.txt
}

mkdir -p "$out"
: >"$out/runs.txt"
for size in "${sizes[@]}"; do
  for seed in "${seeds[@]}"; do
    folder=$out/$size-$seed
    rm -rf "$folder"
    mkdir -p "$folder"/{ours,identified,nearest,joint,rbpf}
    read -r trees _ steps _ < <("$peers" write "$seed" "$size" "$folder")
    for who in ${WHO:-ours identified nearest joint rbpf}; do
      time_s=$(
        cd "$folder/$who"
        case $who in
          ours) "$peers" ours "$seed" "$size" . ;;
          identified) kf assocNN identified $((steps - 1)) ;;
          nearest) kf assocNN unknown $((steps - 1)) ;;
          joint) kf assocJCBB unknown $((steps - 1)) ;;
          rbpf) rbpf ;;
        esac
      )
      verdict='- - - -'
      case $time_s in over | failed) ;; *) verdict=$("$peers" judge "$seed" "$size" "$folder/$who") ;; esac
      echo "$size $trees $steps $who $time_s $verdict" >>"$out/runs.txt"
    done
    rm -f "$folder"/*.rawlog
  done
done
awk '
  function median(key, what,   n, i, j, t, v, m) {
    n = split(all[key, what], v, " "); m = 0
    for (i = 1; i <= n; ++i) if (v[i] != "-" && v[i] != "over" && v[i] != "failed") sorted[++m] = v[i]
    if (m < n / 2 || m == 0) return what == "time" ? v[1] : "-"
    for (i = 2; i <= m; ++i) for (j = i; j > 1 && sorted[j - 1] + 0 > sorted[j] + 0; --j) {
      t = sorted[j]; sorted[j] = sorted[j - 1]; sorted[j - 1] = t }
    return sorted[int((m + 1) / 2)]
  }
  BEGIN {
    name["ours"] = "trunk SLAM"; name["identified"] = "kf-slam, identities told"
    name["nearest"] = "kf-slam, nearest neighbour"; name["joint"] = "kf-slam, joint compatibility"
    name["rbpf"] = "rbpf-slam, grid"
    printf "%5s %-30s %12s %9s %9s %7s %7s\n", "trees", "", "ms per scan", "path (m)", "map (m)", "missed", "beyond"
  }
  { key = $1 " " $4
    if (!((key, "time") in all)) order[++num] = key
    per = $5 ~ /^[0-9.]+$/ ? 1000 * $5 / $3 : $5
    all[key, "time"] = all[key, "time"] " " per; all[key, "path"] = all[key, "path"] " " $6
    all[key, "map"] = all[key, "map"] " " $7; all[key, "missed"] = all[key, "missed"] " " $8
    all[key, "beyond"] = all[key, "beyond"] " " $9 }
  END {
    for (k = 1; k <= num; ++k) {
      split(order[k], w, " "); t = median(order[k], "time")
      if (t ~ /^[0-9]/) t = sprintf("%.2f", t)
      printf "%5d %-30s %12s %9s %9s %7s %7s\n", w[1], name[w[2]], t, median(order[k], "path"),
        median(order[k], "map"), median(order[k], "missed"), median(order[k], "beyond") }
  }' "$out/runs.txt" | tee "$out/table.txt"
