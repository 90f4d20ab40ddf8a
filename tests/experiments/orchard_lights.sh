#!/usr/bin/env bash
# Sourced by the scripts that simulate the hard orchard: the same rig under another light.
#   light_rig NAME RIG.yaml > RIG_NAME.yaml
# neutral: as the rig has it; dark, bright: exposure -2 and +2 EV; warm, cold: a sun of 3000 and 8000 K
# while the camera's white balance stays; -1ev, 4500k and the like: that exposure, that sun; low: the sun
# 10 degrees high, across the rows. No light, but a
# stress of its own: posts, one more post of trunk width per three trees.
orchard_lights="neutral dark bright warm cold low"
light_rig() {
  case $1 in
    neutral) cat "$2" ;;
    [-+0-9]*ev) sed "s/^    exposure_ev: .*/    exposure_ev: $(printf '%.1f' "${1%ev}")/" "$2" ;;
    [0-9]*k) sed "s/^    temperature_k: .*/    temperature_k: ${1%k}.0/" "$2" ;;
    dark) sed 's/^    exposure_ev: .*/    exposure_ev: -2.0/' "$2" ;;
    bright) sed 's/^    exposure_ev: .*/    exposure_ev: 2.0/' "$2" ;;
    warm) sed 's/^    temperature_k: .*/    temperature_k: 3000.0/' "$2" ;;
    cold) sed 's/^    temperature_k: .*/    temperature_k: 8000.0/' "$2" ;;
    low)
      sed 's/^  light:.*/&\n    sun_from_seed: false\n    sun_azimuth_deg: 90.0\n    sun_elevation_deg: 10.0/' "$2"
      ;;
    posts) sed 's/^    trunk_post_fraction: .*/    trunk_post_fraction: 0.30/' "$2" ;;
    *)
      echo "no light $1 (there are: $orchard_lights posts)" >&2
      return 2
      ;;
  esac
}

# drive ORCHARD RIG SEED SECONDS STEM: a drive, its truth and its looks, unless they are there.
drive() {
  [ -s "$5.lcm" ] && return 0
  "$1" simulate --scene orchard --seed "$3" --config "$2" --duration "$4" --out "$5.part.lcm" \
    --truth "$5.truth.csv" >/dev/null
  "${BUILD:-build}/experiments/true_observations" --scene orchard --seed "$3" --config "$2" --duration "$4" \
    --out "$5.looks.csv" >/dev/null
  mv "$5.part.lcm" "$5.lcm"
}
