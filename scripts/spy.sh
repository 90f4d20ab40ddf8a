#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Start lcm-spy with the message types of Orchard Mapper. Options are passed to it, such as
#   spy.sh -l "udpm://239.255.76.67:7667?ttl=0"
# (Debian's lcm-spy uses -Xincgc, which Java 17 refuses; so lcm.spy.Spy is started directly.)
set -euo pipefail
case "${1:-}" in -h | --help) sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
here=$(cd "$(dirname "$0")/.." && pwd)

first_of() {  # first_of WHAT HINT PATH...: the first path that exists
  local what=$1 hint=$2 path
  shift 2
  for path in "$@"; do
    if [ -f "$path" ]; then
      echo "$path"
      return
    fi
  done
  echo "spy: $what is missing (looked for: $*)" >&2
  echo "spy: $hint" >&2
  exit 1
}

command -v java >/dev/null || {
  echo "spy: java is missing; install it with: sudo apt-get install --no-install-recommends default-jre" >&2
  exit 1
}
java_home=$(java -XshowSettings:properties -version 2>&1 | sed -n 's/^ *java\.home = //p')
if [ -d "$java_home/lib" ] && [ ! -e "$java_home/lib/libawt_xawt.so" ]; then
  echo "spy: this java cannot open windows; install the full package with: sudo apt-get install --no-install-recommends default-jre" >&2
  exit 1
fi
types=$(first_of "the jar of the message types" \
  "build it with: cmake -S . -B build -G Ninja && ninja -C build orchard_lcmtypes_jar" \
  "$here/build/orchard_lcmtypes.jar" \
  "$here/orchard_lcmtypes.jar" \
  /usr/share/orchard-mapper/orchard_lcmtypes.jar \
  /usr/local/share/orchard-mapper/orchard_lcmtypes.jar)
lcm=$(first_of "lcm.jar" "install it with: sudo apt-get install liblcm-java" \
  /usr/share/java/lcm.jar /usr/local/share/java/lcm.jar)
chart=$(first_of "jchart2d.jar" "install it with: sudo apt-get install libjchart2d-java" \
  /usr/share/java/jchart2d.jar /usr/local/share/java/jchart2d.jar)
if [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
  echo "spy: no display: run it in a desktop session (or ssh -X); for text there is: orchard echo STATUS" >&2
  exit 1
fi
echo "spy: java -cp $lcm:$chart:$types lcm.spy.Spy $*"
exec java -Djava.net.preferIPv4Stack=true -cp "$lcm:$chart:$types" lcm.spy.Spy "$@"
