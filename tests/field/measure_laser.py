# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of a scanner's driver: cables pulled out, stamps under load, broken sums."""
import os
import random
import subprocess
import time

from hosts import Network
from programs import Program
from table import Row


def trial(bench, *arguments):
    """What laser_trials printed, by name."""
    program = os.path.join(bench.build, "tests", "field", "laser_trials")
    done = subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True)
    pairs = [line.split() for line in done.stdout.splitlines()]  # log lines have more words
    return {pair[0]: float(pair[1]) for pair in pairs if len(pair) == 2}


def laser_unplug(bench, arguments):
    """A Hokuyo scanner is unplugged and plugged in again, over TCP and a pseudo terminal."""
    rows = []
    for line in ("tcp", "pty"):
        got = trial(bench, "unplug", line, arguments.num or (3 if arguments.short else 20),
                    arguments.seed)
        rows.append(Row(
            "laser_unplug", f"{line}: {got['replugs']:.0f} times out and in: scans again after, at most "
            "(mean); wrong beams; worst stamp",
            f"{got['worst_s']:.2f} s ({got['mean_s']:.2f} s); {got['wrong']:.0f}; {got['worst_stamp_ms']:.1f} ms",
            "2 s; 0; 20 ms",
            got["worst_s"] <= 2.0 and got["wrong"] == 0 and got["worst_stamp_ms"] <= 20.0))
    return rows


def scans(log):
    """When scans came, by the clock that all hosts of a machine share."""
    with open(log) as file:
        return [float(line.split()[1]) for line in file if line.startswith("scan ")]


def first_after(log, begin, seconds):
    """How long after `begin` the first scan came."""
    while time.monotonic() < begin + seconds:
        found = next((t for t in scans(log) if t > begin), None)
        if found is not None:
            return found - begin
        time.sleep(0.05)
    return seconds


def laser_cable(bench, arguments):
    """The cable between a scanner's host and its driver's is cut and mended: nothing is said, it is silent."""
    draw = random.Random(arguments.seed)
    program = os.path.join(bench.build, "tests", "field", "laser_trials")
    link = os.path.join(bench.build, "tests", "field", "impaired_link")
    log = os.path.join(bench.work, "watch.log")
    num = arguments.num or (2 if arguments.short else 20)
    waits, lengths = [], []
    with Network(["laser", "robot"], link, {"laser": {}}) as network:
        server = Program(network["laser"], [program, "serve", "tcp:10.76.67.1:10940"],
                         os.path.join(bench.work, "serve.log"))
        driver = Program(network["robot"], [program, "watch", "tcp:10.76.67.1:10940"], log)
        bench.running += [server, driver]
        first_after(log, time.monotonic(), 20)
        for _ in range(num):
            network.links["laser"].cut()
            lengths.append(draw.uniform(0.2, 12.0))
            time.sleep(lengths[-1])
            network.links["laser"].mend()
            waits.append(first_after(log, time.monotonic() + 0.02, 20))
            time.sleep(0.5)
        alive = driver.alive()
        driver.kill()
        server.kill()
    return [Row("laser_cable", f"cable cut {num} times for {min(lengths):.1f} to {max(lengths):.1f} s: scans again "
                "after, at most (mean); the driver", f"{max(waits):.2f} s ({sum(waits) / num:.2f} s); "
                f"{'runs on' if alive else 'ended'}", "2 s; runs on", max(waits) <= 2.0 and alive)]


def laser_stamps(bench, arguments):
    """Stamps of a scanner at 40 Hz against true time, its clock wrapping, beside a busy host."""
    rows = []
    seconds = 10 if arguments.short else 120
    for load, skew in ((0, 0), (2 * os.cpu_count(), 100)):
        got = trial(bench, "stamps", seconds, load, skew)
        rows.append(Row(
            "laser_stamps", f"{seconds} s with a wrap in the middle, skew {skew} ppm, {load} processes that "
            "never rest: mean, sd, worst; sweeps that came; CPU of the driver",
            f"{got['mean_ms']:+.2f}, {got['sd_ms']:.2f}, {got['worst_ms']:.2f} ms; "
            f"{100 * got['sweeps'] / got['expected']:.1f} %; {got['cpu_percent']:.1f} % of a core",
            "sd 2 ms, worst 20 ms", got["sd_ms"] <= 2.0 and got["worst_ms"] <= 20.0))
    return rows


def laser_sums(bench, arguments):
    """Sweeps of which 1 % have a wrong sum; bearings against the specification's formula."""
    got = trial(bench, "sums", 2000 if arguments.short else 100000, 1.0, arguments.seed)
    bearings = trial(bench, "bearings")
    return [
        Row("laser_sums", f"{got['spoilt']:.0f} of {got['sweeps']:.0f} sweeps with a wrong sum: published; "
            "counted; wrong beams published",
            f"{got['published']:.0f}; {got['counted_bad']:.0f}; {got['wrong_beams']:.0f}", "the others; all; 0",
            got["wrong_beams"] == 0 and got["counted_bad"] == got["spoilt"]
            and got["published"] >= got["sweeps"] - got["spoilt"] - 2),
        Row("laser_sums", "bearings of three models against (step - AFRT) 2 pi / ARES, worst",
            f"{bearings['worst_rad']:.0e} rad", "1e-9 rad", bearings["worst_rad"] <= 1e-9),
    ]
