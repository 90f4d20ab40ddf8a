#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tries the Debian packages in a clean Debian: lintian finds no error in them, they install with apt into a new
# minimal bookworm, and there the installed `orchard` simulates, maps and judges the paper's scene, and Python reads
# the map.
#   tests/package/deb_test.sh DEB... [--chroot DIR] [--mirror URL]
#     DEB...        all that this makes: ninja -C build && (cd build && cpack)
#     --chroot DIR  where the clean Debian goes (default: a new folder, deleted afterwards)
#     --mirror URL  where debootstrap takes it from (default: the first of this machine's apt sources)
# Needs root, debootstrap and lintian, and a mirror; takes minutes and a gigabyte of disk.
set -euo pipefail

debs=()
chroot=
mirror=
while [ $# -gt 0 ]; do
  case $1 in
    --chroot) chroot=${2:?--chroot needs a folder}; shift ;;
    --mirror) mirror=${2:?--mirror needs a URL}; shift ;;
    -h | --help) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "deb_test: unknown option $1; see $0 --help" >&2; exit 2 ;;
    *) debs+=("$1") ;;
  esac
  shift
done
fail() { echo "deb_test: $*" >&2; exit 1; }
package() {  # package NAME: its file
  local deb
  for deb in "${debs[@]}"; do
    if [ -f "$deb" ] && [ "$(dpkg-deb --field "$deb" Package)" = "$1" ]; then echo "$deb"; return; fi
  done
  echo "deb_test: no $1 among the packages; see $0 --help" >&2
  exit 2
}
main=$(package orchard-mapper)
python=$(package python3-orchard)
dev=$(package liborchard-dev)
[ "$(id -u)" -eq 0 ] || fail "needs root, for chroot"
for program in debootstrap lintian; do
  command -v $program >/dev/null || fail "$program is missing: apt-get install $program"
done
[ -n "$mirror" ] || mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' | head -n 1)

for deb in "$main" "$python" "$dev"; do
  dpkg-deb --field "$deb" Maintainer | grep -q '@' ||
    fail "the package names no address: fill in scripts/debian/maintainer.cmake, or set DEBFULLNAME and DEBEMAIL"
  echo "== lintian $(basename "$deb")"
  lintian --fail-on error "$deb"
done

[ -n "$chroot" ] || chroot=$(mktemp -d)/debian
cleanup() {
  umount "$chroot/proc" 2>/dev/null || true
  rm -rf --one-file-system "$chroot"
}
trap cleanup EXIT
if [ ! -x "$chroot/usr/bin/apt-get" ]; then
  echo "== debootstrap bookworm from $mirror"
  debootstrap --variant=minbase bookworm "$chroot" "$mirror" >"$chroot.log" 2>&1 ||
    { tail -n 5 "$chroot.log" >&2; fail "debootstrap failed"; }
  rm -f "$chroot.log"
fi
for file in /etc/resolv.conf /etc/hosts; do cp -L $file "$chroot$file"; done  # the network as it is here
mountpoint -q "$chroot/proc" || mount -t proc proc "$chroot/proc"

echo "== apt-get install $(basename "$main") $(basename "$python")"
cp "$main" "$python" "$chroot/tmp/"
inside() { chroot "$chroot" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
inside apt-get update -qq
inside apt-get install -y -qq --no-install-recommends "/tmp/$(basename "$main")" "/tmp/$(basename "$python")" \
  >"$chroot/tmp/apt.log" 2>&1 ||
  { tail -n 5 "$chroot/tmp/apt.log" >&2; fail "the packages do not install"; }

echo "== simulate, map, evaluate"
config=/usr/share/orchard-mapper/config/tubes.yaml
inside orchard --version
inside orchard simulate --scene tubes --seed 1 --config $config --out /tmp/tubes.lcm --truth /tmp/truth.csv
inside orchard map /tmp/tubes.lcm --config $config --out /tmp/map --quiet
inside orchard evaluate /tmp/map --truth /tmp/truth.csv | tee "$chroot/tmp/tables.txt" | tail -n 2
grep -q 'found 16 of 16' "$chroot/tmp/tables.txt" || fail "the map is not right"
# Commands of each companion program: growers' lists and the files of a GIS.
inside orchard tasks /tmp/map --out /tmp/tasks.gpkg
inside orchard export /tmp/map --format gpkg --out /tmp/block.gpkg | tail -n 1
inside orchard import-edits /tmp/map /tmp/block.gpkg --dry-run

echo "== python3"
inside python3 - <<'END' || fail "python3-orchard does not read the map"
import csv
import numpy
import orchard_map
from orchard import scan_t

drive = orchard_map.read("/tmp/map")
with open("/tmp/map/map.csv", newline="") as file:
    rows = list(csv.DictReader(file))
assert drive.landmarks["x_m"].tolist() == [float(row["x_m"]) for row in rows]
assert len(drive.landmarks) == 16 and sum(drive.landmarks["class"] == "tree") == 12
assert drive.path.dtype.names == ("utime_us", "x_m", "y_m", "yaw_rad") and len(drive.path) > 10
assert drive.graph.edges and all(numpy.isfinite(edge.line).all() for edge in drive.graph.edges)
assert scan_t.decode(scan_t().encode()).num_ranges == 0
print(f"{len(drive.landmarks)} landmarks, {len(drive.path)} poses, {len(drive.graph.edges)} edges")
END
contents=$(for deb in "$main" "$python" "$dev"; do dpkg-deb --contents "$deb"; done)
for file in share/man/man1/orchard-map.1.gz share/bash-completion/completions/orchard \
  share/orchard-mapper/lcmtypes/scan_t.lcm include/orchard/scan_t.hpp \
  lib/systemd/system/orchard-mapper@.service lib/sysusers.d/orchard-mapper.conf \
  lib/python3/dist-packages/orchard/scan_t.py share/orchard-mapper/orchard_lcmtypes.jar; do
  # A minimal Debian may be told to leave manual pages out, so the package is asked, not the disk.
  grep -q "/usr/$file\$" <<<"$contents" || fail "$file is in no package"
done
echo "deb_test: the packages work in a clean Debian"
