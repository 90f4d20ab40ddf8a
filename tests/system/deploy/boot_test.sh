#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# boot_test.sh SOURCE_TREE BIN: a systemd of its own, on a copy of this machine's files that is thrown away,
# starts the units of config/deploy. All of them run as hardened, a drive is mapped and recorded, a
# killed process and one that hangs are started again, and stopping the target saves the map.
# Exit code 77 where no such systemd can be started (not root, no namespaces, no overlay).
set -euo pipefail
tree=$1
bin=$2
fail() { echo "FAILED: $*" >&2; [ ! -f "$work/said.txt" ] || tail -n 60 "$work/said.txt" >&2; exit 1; }
skip() { echo "skipped: $*" >&2; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "needs root"
[ -x /lib/systemd/systemd ] || skip "systemd is missing"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# What runs inside, as commands of somebody who has just installed the package.
cat >"$work/inside.sh" <<'INSIDE'
exec >/results/said.txt 2>&1
nodes="detector pose mapper record"
pid() { systemctl show -P MainPID "orchard-$1@tubes"; }
# wait_for SECONDS COMMAND...: until the command succeeds
wait_for() {
  end=$(($(date +%s) + $1)); shift
  until "$@"; do [ "$(date +%s)" -lt "$end" ] || return 1; sleep 0.1; done
}
all_run() {
  for node in $nodes; do systemctl is-active -q "orchard-$node@tubes" || return 1; done
}
another() { [ "$(pid "$1")" -gt 0 ] && [ "$(pid "$1")" != "$2" ] && all_run; }
step() { echo "ok: $1" >>/results/steps.txt; }
for node in $nodes; do units="$units orchard-$node@tubes.service"; done
systemctl enable -q orchard.target $units && systemctl start orchard.target
wait_for 30 all_run && step "all run"
old=$(pid detector); kill -KILL "$old"
wait_for 20 another detector "$old" && step "killed and started again"
old=$(pid pose); kill -STOP "$old"
wait_for 40 another pose "$old" && step "hung and started again"
orchard-sim-driver --config /etc/orchard-mapper/tubes.yaml --scene tubes --speed 4 \
  --wait-for detector,pose,mapper && step "drive"
systemctl stop orchard.target
[ -s /var/lib/orchard-mapper/tubes/map/map.gpkg ] && step "map saved"
[ "$(stat -c %U /var/lib/orchard-mapper/tubes/map/map.csv)" = orchard ] && step "by the user orchard"
[ "$(wc -l </var/lib/orchard-mapper/tubes/map/map.csv)" -ge 15 ] && step "of the whole scene"
orchard log info /var/lib/orchard-mapper/tubes/recordings/*.lcm | grep -q '^DETECTIONS' && step "recorded"
systemctl --no-pager -n0 status 'orchard-*'
journalctl --no-pager -o short-monotonic | tail -n 100
systemctl exit 0
INSIDE

# A file system of its own: this machine's below, memory above.
cat >"$work/boot.sh" <<'BOOT'
set -e
work=$1 tree=$2 bin=$3
mount --make-rprivate /
mkdir "$work/memory"
mount -t tmpfs tmpfs "$work/memory"
mkdir "$work/memory/up" "$work/memory/work" "$work/memory/root"
mount -t overlay overlay -o "lowerdir=/,upperdir=$work/memory/up,workdir=$work/memory/work" "$work/memory/root"
root=$work/memory/root
mount -t proc proc "$root/proc"
mount -t sysfs -o ro sysfs "$root/sys"
mount -t cgroup2 cgroup2 "$root/sys/fs/cgroup"
for folder in run tmp dev; do mount -t tmpfs tmpfs "$root/$folder"; done
for device in null zero full random urandom tty; do
  touch "$root/dev/$device"
  mount --bind "/dev/$device" "$root/dev/$device"
done
mkdir "$root/dev/shm" "$root/dev/pts" "$root/results"
mount -t tmpfs tmpfs "$root/dev/shm"
mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
ln -s pts/ptmx "$root/dev/ptmx"
mount --bind "$work" "$root/results"
# what the package installs
units=$root/etc/systemd/system
cp -r "$tree/config/deploy/systemd/." "$units"
mv "$units/orchard-mapper.sysusers" "$root/usr/lib/sysusers.d/orchard-mapper.conf"
mkdir -p "$root/etc/orchard-mapper"
cp "$tree/config/tubes.yaml" "$root/etc/orchard-mapper"
cp "$bin"/orchard* "$root/usr/bin"
chroot "$root" systemd-sysusers orchard-mapper.conf
# of the machine's own services none
for unit in systemd-udevd systemd-journal-flush systemd-networkd systemd-resolved systemd-logind; do
  ln -sf /dev/null "$units/$unit.service"
done
printf '[Unit]\nWants=inside.service\nAllowIsolate=yes\n' >"$units/boot.target"
printf '[Service]\nType=exec\nExecStart=/bin/bash /results/inside.sh\n' >"$units/inside.service"
ip link set lo up multicast on
ip route add 224.0.0.0/4 dev lo
cd "$root"
pivot_root . mnt
umount -l /mnt
echo started >/results/steps.txt
exec env -i container=other PATH=/usr/sbin:/usr/bin:/sbin:/bin /lib/systemd/systemd --system \
  --unit=boot.target --log-target=journal --show-status=no
BOOT
timeout -s KILL 120 unshare --pid --fork --kill-child --mount --uts --ipc --cgroup --net \
  bash "$work/boot.sh" "$work" "$tree" "$bin" >"$work/boot.txt" 2>&1 </dev/null || true
[ -f "$work/steps.txt" ] || { cat "$work/boot.txt" >&2; skip "no systemd of its own can be started here"; }
for step in "all run" "killed and started again" "hung and started again" "drive" "map saved" \
  "by the user orchard" "of the whole scene" "recorded"; do
  grep -qx "ok: $step" "$work/steps.txt" || fail "$step"
done
echo "boot: every unit runs hardened, is started again, and saves at its end"
