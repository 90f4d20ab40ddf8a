# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# To be sourced by experiments on farms, after script_help.sh: runs the script again in a private
# network namespace, and sets $orchard (the program) and $work (a folder that is removed at the end,
# when a Slurm that was started is stopped, too).
cd "$(dirname "$0")/../.."
if [ -z "${FARM_INSIDE:-}" ]; then
  FARM_INSIDE=yes exec tests/system/in_namespace.sh "$0" "$@"
fi
export PATH=$PATH:/usr/sbin
orchard=${BUILD:-$PWD/build}/bin/orchard
work=$(mktemp -d)
slurm_pids=()
. tests/system/farm/season.sh
. tests/system/farm/slurm.sh
trap '[ ${#slurm_pids[@]} = 0 ] || stop_slurm; rm -rf "$work"' EXIT
