# SPDX-License-Identifier: BSD-3-Clause
"""A drive along two rows of six trees, whose poses are fixes: mapped in a fraction of a second."""
import subprocess

CHANGES = {"mode: slam": "mode: fixes", "laps: 3": "laps: 1", "fix_rate_hz: 0": "fix_rate_hz: 10",
           "num_rows: 10": "num_rows: 2", "trees_per_row: 30": "trees_per_row: 6"}


def make_drive(source, orchard, log_path, rate_hz=6.0, spacing_m=2.0):
    """Writes the log, and beside it the rig LOG.yaml. Another rate of scans gives another noise,
    another spacing of the trees is another orchard."""
    with open(source + "/config/block.yaml") as file:
        rig = file.read()
    for old, new in {**CHANGES, "range_max_m: 20.0":
                     f"range_max_m: 20.0\n    rate_hz: {rate_hz}",
                     "    tree_spacing_m: 2.0": f"    tree_spacing_m: {spacing_m}"}.items():
        assert old in rig, old
        rig = rig.replace(old, new)
    with open(log_path + ".yaml", "w") as file:
        file.write(rig)
    subprocess.run([orchard, "simulate", "--scene", "orchard", "--seed", "1", "--config",
                    log_path + ".yaml", "--out", log_path], check=True, capture_output=True)
