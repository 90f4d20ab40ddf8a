# SPDX-License-Identifier: BSD-3-Clause
"""Recorded bytes of a device, from the format in lib/io/recording/raw_bytes.hpp, through read_raw."""
import os
import struct
import subprocess
import tempfile

START_US = 1_700_000_000_000_000


def write(path, events):
    """events: (seconds, kind "C", "R" or "S", bytes)."""
    with open(path, "wb") as file:
        file.write(b"ORCHRAW1")
        for seconds, kind, data in events:
            file.write(struct.pack(">qcI", START_US + round(1e6 * seconds), kind.encode(), len(data)) + data)


class Read:
    """What a protocol makes of events."""

    def __init__(self, program, protocol, events):
        self.scans, self.fixes, self.num_good, self.num_bad = [], [], 0, 0
        self.level, self.text = 0, ""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "device.raw")
            write(path, events)
            done = subprocess.run([program, protocol, path], check=True, stdout=subprocess.PIPE, text=True)
        for line in done.stdout.splitlines():
            word, _, rest = line.partition(" ")
            if word == "scan":
                self.scans.append(Scan([float(w) for w in rest.split()]))
            elif word == "gnss":
                self.fixes.append([float(w) for w in rest.split()])
            elif word == "counts":
                self.num_good, self.num_bad = map(int, rest.split())
            elif word == "condition":
                self.level, self.text = int(rest[0]), rest[2:]


class Scan:
    """A line "scan" of read_raw."""

    def __init__(self, numbers):
        self.seconds = 1e-6 * (numbers[0] - START_US)
        self.bearing_min_rad, self.bearing_step_rad, self.beam_period_us = numbers[1:4]
        num = int(numbers[6])
        self.ranges_m, self.intensities = numbers[7:7 + num], numbers[7 + num:]
