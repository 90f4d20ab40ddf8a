# SPDX-License-Identifier: BSD-3-Clause
"""An hour of driving with its pictures through the live processes, five times as fast as the clock."""
import os
import shutil
import time

import wire
from drive import Drive
from hosts import lone_host
from measure_day import GROWTH_most_mib_per_h, day_log
from programs import NODES
from table import Row

SPEED = 5.0
CHANNELS = ("SCAN", "IMAGE", "ODOMETRY", "POSE_FIX", "GNSS")
GAP_us = 100_000  # between laps, as between scans: a longer one would be over in a fifth of it, and be taken for a clock that leaps
GROWTH_most = 0.10  # of the processor's time for a minute of driving


def processor_s(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def watched(player, programs):
    """Samples of each program once a second: time, processor [s], memory of its own [MiB], descriptors."""
    samples = {name: [] for name in programs}
    while player.alive():
        time.sleep(1.0)
        for name, program in programs.items():
            samples[name].append((time.monotonic(), processor_s(program.pid), program.own_memory_mib(), program.descriptors()))
    return samples


def thirds(samples, of):
    """What `of` makes of the samples of the second third of the drive, and of the last."""
    third = len(samples) // 3
    return of(samples[third:2 * third]), of(samples[2 * third:])


def processor_share(samples):
    return (samples[-1][1] - samples[0][1]) / (samples[-1][0] - samples[0][0])


def is_flat(samples):
    """Whether no more descriptors are open at the end than ever before its last third; fewer is no miss."""
    return thirds(samples, lambda part: min(sample[3] for sample in part))[1] <= max(sample[3] for sample in samples[:2 * len(samples) // 3])


def rows_of(name, samples, driven_h):
    """Rows on what a program needs as the drive grows."""
    early, late = thirds(samples, processor_share)
    low, high = thirds(samples, lambda part: min(sample[2] for sample in part))
    growth = (high - low) / (driven_h / 3)
    return [
        Row("pictures", f"{name}: processor for a minute of driving, in the second third and in the last",
            f"{60 * early / SPEED:.2f}, {60 * late / SPEED:.2f} s", f"at most {GROWTH_most:.0%} more", late <= (1 + GROWTH_most) * early),
        Row("pictures", f"{name}: own memory in the second third, in the last; per hour; descriptors at least and at most",
            f"{low:.0f}, {high:.0f} MiB; {growth:.0f} MiB/h; {min(s[3] for s in samples)}, {max(s[3] for s in samples)}",
            f"at most {GROWTH_most_mib_per_h:g} MiB/h; no more", growth <= GROWTH_most_mib_per_h and is_flat(samples)),
    ]


def pictures(bench, arguments):
    """Driving with pictures at five times real time: what is lost, and what the processes need as it grows."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    log, out = os.path.join(bench.work, "pictures.lcm"), os.path.join(bench.work, "map")
    num_laps, lap_h = day_log(drive, log, 0.05 if arguments.short else min(arguments.hours, 1.0), CHANNELS, GAP_us)
    driven_h = num_laps * lap_h
    shutil.rmtree(out, ignore_errors=True)
    host = lone_host()
    bench.url = bench.url.replace("ttl=1", "ttl=0")
    listener = wire.Listener(host)
    nodes = bench.start_nodes(host, drive.config, out)
    player = bench.start(host, "log-player", log, "--config", drive.config, "--speed", str(SPEED), "--wait-for", ",".join(NODES))
    samples = watched(player, nodes)
    time.sleep(3.0)
    found = []
    for name in ("detector", "mapper"):
        said = listener.statuses(f"orchard-{name}")
        lost = said[-1][1].num_lost
        num = said[-1][1].num_good + lost
        warnings = [status.text for _, status in said if status.level >= 2]
        text = f" ({warnings[len(warnings) // 2]})" if warnings else ""
        found.append(Row("pictures", f"{name}: messages lost of {num}; STATUS a warning or worse", f"{lost}; {len(warnings) / len(said):.0%}{text}",
                         "0", lost == 0))
    for name in NODES:
        found += rows_of(name, samples[name], driven_h)
    moment = time.monotonic()
    code = nodes["mapper"].stop(seconds=300)
    found.append(Row("pictures", "the mapper ends after", f"{time.monotonic() - moment:.1f} s, exit code {code}", "0", code == 0))
    listener.close()
    host.close()
    os.remove(log)
    return found
