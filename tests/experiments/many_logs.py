#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What does a farm of many small logs cost, and what would ten thousand on a thousand cores take?

Short simulated drives of two robots on three dates are mapped by `orchard farm run` on two cores. All
processor time that is not the steps' own is the engine's: Snakemake, the lists, starts of programs,
checks of inputs, the status. Then the run is repeated with nothing to make. From the mean cost of
each kind of step, what a job costs beside its steps and the same rule for the size of lots
(lib/farm/step_lots.cpp), the end of 10,000 such logs on 1,000 cores of a cluster is reckoned: jobs
start one after the other, and none of the second phase before the first has ended. Prints JSON; needs a
build in build/ (or BUILD=folder) and Snakemake.

usage: tests/experiments/many_logs.py [LOGS [CORES]]     (default 500 2: some ten minutes)
"""
import concurrent.futures
import glob
import heapq
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, ROOT + "/tests/system/farm")
from small_drive import make_drive  # noqa: E402

ORCHARD = os.environ.get("BUILD", ROOT + "/build") + "/bin/orchard"
DATES, ROBOTS = 3, 2
START_S, LEAST_LOT_S = 0.3, 3.0  # as in lib/farm/step_lots.cpp
NODE_S = 2.0  # Snakemake starts once more on the node of every job
SEPARATE = {"logs": 10_000, "cores": 1_000}


def run(*command):
    """Time and processor time of a command with all that it starts; the end of what it says."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run([ORCHARD, "farm", *map(str, command)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"farm {command[0]} failed: {done.stdout}{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (time.monotonic() - begin,
            after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout)


def fill(farm, num_logs):
    """Each drive scans at a rate of its own, so that no two logs are the same."""
    def drive(k):
        block, date, robot = k // (DATES * ROBOTS), k // ROBOTS % DATES, k % ROBOTS
        folder = farm / "logs" / f"block_{block}" / f"2026-0{date + 1}-01" / f"robot_{robot}"
        folder.mkdir(parents=True)
        make_drive(ROOT, ORCHARD, str(folder / "drive.lcm"), rate_hz=6.0 + 1e-3 * k)
        os.remove(folder / "drive.lcm.yaml")

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(drive, range(num_logs)))


def steps_of(farm):
    """Mean processor time and number of each kind of step."""
    kinds = {}
    for line in (farm / "work" / "costs.txt").read_text().splitlines():
        name, _, processor_s, _ = line.split()
        total = kinds.setdefault(name.split("-")[0], [0, 0.0])
        total[0] += 1
        total[1] += float(processor_s)
    return {kind: {"num": num, "mean_s": round(total_s / num, 4)}
            for kind, (num, total_s) in kinds.items()}


def phase_s(lot_s, num_lots, cores):
    """The end of so many lots that are started one after the other."""
    free = [0.0] * cores
    for k in range(num_lots):
        begin = max(heapq.heappop(free), START_S * (k + 1))
        heapq.heappush(free, begin + NODE_S + lot_s)
    return max(free)


def reckon(kinds, beside_s, idle_s, num_measured):
    num_dates = SEPARATE["logs"] // ROBOTS
    map_s = kinds["map"]["mean_s"] * SEPARATE["logs"]
    other_s = num_dates * (kinds["date"]["mean_s"] + kinds["report"]["mean_s"]
                           + (DATES - 1) / DATES * kinds["changes"]["mean_s"])
    end_s = idle_s * SEPARATE["logs"] / num_measured
    for work_s in (map_s, other_s):
        num_lots = math.ceil(work_s / max(LEAST_LOT_S, math.sqrt(work_s * START_S)))
        end_s += phase_s(work_s / num_lots + beside_s, num_lots, SEPARATE["cores"])
    return {"logs": SEPARATE["logs"], "cores": SEPARATE["cores"],
            "steps_s": round(map_s + other_s, 1), "end_s": round(end_s, 1)}


def main():
    if len(sys.argv) > 1 and sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return
    num_logs = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    cores = int(sys.argv[2]) if len(sys.argv) > 2 else 2
    with tempfile.TemporaryDirectory() as folder:
        farm = pathlib.Path(folder) / "farm"
        run("init", farm)
        fill(farm, num_logs)
        wall_s, processor_s, said = run("run", farm, "--cores", cores)
        num_jobs = len(glob.glob(str(farm / "work/lots/*")))
        kinds = steps_of(farm)
        own_s = sum(kind["num"] * kind["mean_s"] for kind in kinds.values())
        idle_s, _, nothing = run("run", farm, "--cores", cores)
        if not nothing.startswith("0 steps made"):
            sys.exit("something was made again: " + nothing)
        status_s, _, _ = run("status", farm)
    print(json.dumps({
        "logs": num_logs, "cores": cores, "steps": int(said.split()[0]), "jobs": num_jobs,
        "kinds": kinds, "wall_s": round(wall_s, 1), "processor_s": round(processor_s, 1),
        "steps_s": round(own_s, 1), "engine_share": round(1 - own_s / processor_s, 4),
        "nothing_to_make_s": round(idle_s, 2), "status_s": round(status_s, 2),
        "reckoned": reckon(kinds, (processor_s - own_s) / num_jobs, idle_s, num_logs)}, indent=1))


if __name__ == "__main__":
    main()
