#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# in_namespace.sh COMMAND...: runs a command in a private network namespace whose loopback carries
# multicast, so that tests meet neither each other nor the network. Exit code 77 (skipped) where the
# kernel allows no namespaces.
set -euo pipefail

enter=(unshare -n)
[ "$(id -u)" -eq 0 ] || enter=(unshare -rn)
if ! "${enter[@]}" true 2>/dev/null; then
  echo "skipped: this kernel or container allows no network namespaces (unshare)" >&2
  exit 77
fi
exec "${enter[@]}" bash -c '
  set -e
  ip link set lo up multicast on
  ip route add 224.0.0.0/4 dev lo
  exec "$@"' in_namespace "$@"
