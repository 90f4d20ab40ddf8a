#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# tests/experiments/adaptation.sh [FIRST_SEED LAST_SEED] [CONFIG]: what adaptation while driving is worth as the
# light changes, and what posts of trunk width do to it. Several minutes. The keys of
# detector.adaptation were chosen on seeds 1-2; those of tests/RESULTS.md are of 101-110.
set -e
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
first=${1:-101}
last=${2:-110}
config=${3:-config/orchard.yaml}
cmake --build build --target experiment_adaptation_figures > /dev/null
build/experiments/adaptation_figures "$config" "$first" "$last"
