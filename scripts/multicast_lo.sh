#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Set up LCM on a machine without network: multicast through the loopback interface.
# Does nothing if multicast already has a route. Lasts until the next boot.
#   scripts/multicast_lo.sh
set -euo pipefail
case "${1:-}" in
  -h | --help) sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"; exit 0 ;;
  ?*) echo "multicast_lo: unknown argument $1; see $0 --help" >&2; exit 2 ;;
esac

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "multicast_lo: needs root or sudo" >&2; exit 1; }
  as_root=(sudo)
fi
run() {
  echo "multicast_lo: $*"
  "${as_root[@]}" "$@"
}

if ! ip link show lo | grep -q "[<,]UP[,>]"; then run ip link set lo up; fi
if ip route get 239.255.76.67 >/dev/null 2>&1; then
  echo "multicast_lo: multicast already has a route: $(ip route get 239.255.76.67 | head -1)"
  echo "multicast_lo: nothing to do (with ttl=0 no message leaves this machine)"
  exit 0
fi
ip link show lo | grep -q "MULTICAST" || run ip link set lo multicast on
run ip route add 224.0.0.0/4 dev lo
echo "multicast_lo: done; LCM connects all programs on this machine, and no other machine"
