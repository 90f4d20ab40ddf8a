#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Record every LCM message with lcm-logger until Ctrl-C.
#   scripts/record.sh [NAME] [LCM_URL]   writes out/recordings/NAME-YYYYmmdd-HHMMSS.lcm (NAME: drive)
# out/recordings/NAME.lcm is a link to the newest recording.
set -euo pipefail
case "${1:-}" in
  -h | --help) sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"; exit 0 ;;
  -*) echo "record: unknown option $1; see $0 --help" >&2; exit 2 ;;
esac

name=${1:-drive}
url=${2:-${LCM_DEFAULT_URL:-udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304}}
command -v lcm-logger >/dev/null || {
  echo "record: lcm-logger is missing; install it with: sudo apt-get install liblcm-bin" >&2
  exit 1
}
if command -v ip >/dev/null && ! ip route get 239.255.76.67 >/dev/null 2>&1; then
  echo "record: no multicast route; 'orchard doctor' says how to add one" >&2
  exit 1
fi
mkdir -p out/recordings
stem="out/recordings/$name-$(date +%Y%m%d-%H%M%S)"
log=$stem.lcm
for ((n = 2; ; ++n)); do  # a second recording within the same second
  [ -e "$log" ] || break
  log=$stem-$n.lcm
done
echo "record: writing $log from $url; stop with Ctrl-C"
echo "record: $(df -h --output=avail out/recordings | tail -1 | tr -d ' ') free on this disk"
ln -sfn "$(basename "$log")" "out/recordings/$name.lcm"
# A robot that loses power loses at most the last tenth of a second.
exec lcm-logger --lcm-url="$url" --flush-interval=100 "$log"
