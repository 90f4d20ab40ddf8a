# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the system tests: a scratch folder, children that never outlive the test, and checks.
set -euo pipefail
bin=$1
url="udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304"
work=$(mktemp -d)
children=()
finish() {
  local code=$?
  for child in "${children[@]}"; do
    kill -KILL "$child" 2>/dev/null || true
    wait "$child" 2>/dev/null || true
  done
  rm -rf "$work"
  exit "$code"
}
trap finish EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
start() {  # start LOG COMMAND...: in the background; its id is in $started
  local log=$1; shift
  "$@" >"$log" 2>&1 &
  started=$!
  children+=("$started")
}
