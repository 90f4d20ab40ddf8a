#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""orchard calibrate delay --laser: stamps of SCAN that were made late are found late by as much.

laser_delay_test.py ORCHARD SOURCE_TREE"""
import os
import re
import struct
import subprocess
import sys
import tempfile

LATE_MS = 44.0  # as of a TiM781S whose time stamp is taken for the first beam's
MAGIC = 0xEDA1DA01


def with_late_scans(data, late_us):
    """A log (LCM's format: magic, number, time, sizes, channel, message) whose SCAN is stamped later."""
    out, at = bytearray(data), 0
    while at < len(data):
        magic, _, _, channel_size, size = struct.unpack_from(">IqqII", data, at)
        assert magic == MAGIC
        message = at + 28 + channel_size
        if data[at + 28:message] == b"SCAN":  # the type's hash, then utime
            utime, = struct.unpack_from(">q", data, message + 8)
            struct.pack_into(">q", out, message + 8, utime + late_us)
        at = message + size
    return bytes(out)


def main():
    orchard, source = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        log, rig = os.path.join(folder, "drive.lcm"), os.path.join(folder, "rig.yaml")
        subprocess.run([orchard, "simulate", "--scene", "orchard", "--seed", "3", "--duration", "80", "--out", log],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with open(log, "rb") as file:
            data = with_late_scans(file.read(), round(1000 * LATE_MS))
        with open(log, "wb") as file:
            file.write(data)
        done = subprocess.run([orchard, "calibrate", "delay", log, "--laser", "--out", rig, "--config",
                               os.path.join(source, "config", "orchard.yaml")], stdout=subprocess.PIPE, text=True)
        print(done.stdout)
        if done.returncode != 0:
            return 1
        with open(rig) as file:
            found = re.search(r"laser ([-0-9.]+) ms after ODOMETRY, standard error ([0-9.]+) ms.*\n *delay_s: ([-0-9.]+)",
                              file.read())
        if not found:
            print("FAILED: the rig has no delay with its standard error")
            return 1
        delay_ms, sd_ms, delay_s = map(float, found.groups())
        # Four standard errors: one drive in 16,000 is further off.
        if abs(delay_ms - LATE_MS) > 4.0 * sd_ms or sd_ms > 10.0 or abs(delay_ms - 1e3 * delay_s) > 1.0:
            print(f"FAILED: {delay_ms} +- {sd_ms} ms, stamped {LATE_MS} ms late")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
