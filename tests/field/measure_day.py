# SPDX-License-Identifier: BSD-3-Clause
"""A day: many hours of simulated driving through the real processes, faster than the clock."""
import os
import shutil
import struct
import subprocess
import sys
import time

import wire
from drive import Drive
from hosts import lone_host
from programs import NODES
from table import Row

GAP_us = 3_000_000
GROWTH_most_mib_per_h = 10.0


def laser_rig(drive, path):
    """The drive's rig without its camera."""
    with open(drive.config) as file:
        text = file.read()
    text = text.replace("camera:\n  enabled: true", "camera:\n  enabled: false")
    text = text.replace("detector:\n", "detector:\n  tree_threshold: 0.1\n")
    with open(path, "w") as file:
        file.write(text)


def day_log(drive, path, hours):
    """The drive's lap again and again for so many hours, times and numbers going on; its laps."""
    lap = [(wire.stamp(data)[0], channel, data) for _, channel, data in wire.read_log(drive.log)
           if channel in ("SCAN", "ODOMETRY", "POSE_FIX", "GNSS")]
    first, last = lap[0][0], lap[-1][0]
    length_us = last - first + GAP_us
    num_laps = max(1, round(hours * 3.6e9 / length_us))
    count = wire.per_channel(lap)
    num = 0
    with open(path, "wb") as file:
        for number in range(num_laps):
            for utime, channel, data in lap:
                _, seq = wire.stamp(data)
                shifted = wire.restamped(data, utime + number * length_us, seq + number * count[channel])
                name = channel.encode()
                file.write(struct.pack(">IqqII", wire.LOG_MAGIC, num, utime + number * length_us,
                                       len(name), len(data)) + name + shifted)
                num += 1
    return num_laps, length_us / 3.6e9


def bytes_of(path):
    with open(path, "rb") as file:
        return file.read()


def day(bench, arguments):
    """Hours of driving in lockstep through the processes: memory, descriptors, threads, and the same bytes again."""
    hours = 0.1 if arguments.short else arguments.hours
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    rig, log = os.path.join(bench.work, "laser.yaml"), os.path.join(bench.work, "day.lcm")
    laser_rig(drive, rig)
    num_laps, lap_h = day_log(drive, log, hours)
    host = lone_host()
    bench.url = bench.url.replace("ttl=1", "ttl=0")
    out = os.path.join(bench.work, "map")
    shutil.rmtree(out, ignore_errors=True)
    nodes = {name: bench.start(host, name, "--config", rig, "--lockstep",
                               *(("--out", out) if name == "mapper" else ())) for name in NODES}
    begin = time.monotonic()
    player = bench.start(host, "log-player", log, "--config", rig, "--lockstep",
                         "--out", os.path.join(bench.work, "derived.lcm"))
    samples, next_word = [], begin + 60
    while True:
        try:
            code = player.process.wait(0.5)
            break
        except subprocess.TimeoutExpired:
            pass
        samples.append({name: (p.memory_mib(), p.descriptors(), p.threads())
                        for name, p in {**nodes, "player": player}.items()})
        if time.monotonic() > next_word:
            print(f"field: day, {time.monotonic() - begin:.0f} s; mapper {samples[-1]['mapper'][0]:.0f} MiB",
                  file=sys.stderr, flush=True)
            next_word += 60
    took = time.monotonic() - begin
    if code != 0:
        raise RuntimeError("orchard-log-player: " + player.said())
    codes = [nodes[name].stop() for name in NODES]
    host.close()
    os.remove(os.path.join(bench.work, "derived.lcm"))
    driven_h = num_laps * lap_h
    early, late = samples[len(samples) // 10], samples[-2 if len(samples) > 1 else -1]
    found = []
    for name in (*NODES, "player"):
        growth = (late[name][0] - early[name][0]) / (0.9 * driven_h)
        flat = early[name][1:] == late[name][1:]
        found.append(Row("day", f"{name}: memory after a tenth, at the end, per hour; descriptors, threads",
                         f"{early[name][0]:.0f}, {late[name][0]:.0f} MiB, {growth:.1f} MiB/h; "
                         f"{early[name][1]}, {early[name][2]} to {late[name][1]}, {late[name][2]}",
                         f"at most {GROWTH_most_mib_per_h:g} MiB/h; flat",
                         growth <= GROWTH_most_mib_per_h and flat))
    again = []
    for number in range(2):
        folder = os.path.join(bench.work, f"again-{number}")
        bench.orchard("map", log, "--config", rig, "--out", folder, "--quiet", "--no-derived")
        again.append(bytes_of(os.path.join(folder, "map.csv")))
    same = bytes_of(os.path.join(out, "map.csv")) == again[0] == again[1]
    found.append(Row("day", f"{driven_h:.1f} h of driving ({num_laps} laps): map of the processes and of two more "
                     "replays in one process; exit codes", f"{'the same bytes' if same else 'different'}; {codes}",
                     "the same bytes; 0", same and set(codes) == {0}))
    found.append(Row("day", "and took", f"{took:.0f} s, {3600 * driven_h / took:.0f} times real time", "", None))
    os.remove(log)
    return found
