#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what goes wrong in the field, on hosts that are network namespaces joined by a bridge: a bad link,
killed processes, a full disk, hostile packets, clocks, strangers, two machines, a day. Prints a line for
each result; exits 1 when one misses what is wanted, 77 where namespaces are not allowed. Needs root and a
build with tests. A machine that does nothing else is wanted for the times."""
import argparse
import json
import os
import subprocess
import sys
import time
import traceback

sys.dont_write_bytecode = True
import measure_clocks
import measure_day
import measure_disk
import measure_hostile
import measure_kills
import measure_laser
import measure_link
import measure_live
import measure_pictures
import measure_strangers
import measure_two_machines
import wire
from programs import Bench

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

MEASUREMENTS = {
    function.__name__: function for function in (
        measure_link.loss, measure_link.loss_default_kernel, measure_link.duplicates,
        measure_link.reorder, measure_link.levelled, measure_link.link_down, measure_link.slow_link,
        measure_kills.kills, measure_kills.kills_saving, measure_disk.disk_full,
        measure_disk.rotation, measure_hostile.hostile,
        measure_hostile.hostile_guarded,
        measure_clocks.clocks, measure_clocks.clocks_live, measure_clocks.clock_offset,
        measure_strangers.twice,
        measure_strangers.same_folder, measure_strangers.old_types, measure_strangers.calibration,
        measure_two_machines.two_machines, measure_laser.laser_unplug, measure_laser.laser_cable,
        measure_laser.laser_stamps, measure_laser.laser_sums, measure_live.emulated, measure_live.bot_core, measure_day.day,
        measure_pictures.pictures)
}


def parse():
    parser = argparse.ArgumentParser(prog="field.py", description=__doc__)
    parser.add_argument("names", nargs="*", help="measurements (default: all)")
    parser.add_argument("--list", action="store_true", help="names and what they measure")
    parser.add_argument("--build", default=os.path.join(ROOT, "build"), help="build folder (default build)")
    parser.add_argument("--seed", type=int, default=7, help="of the drive and of everything that is drawn (7)")
    parser.add_argument("--speed", type=float, default=2.0, help="of replays over a link, in times real time (2)")
    parser.add_argument("--num", type=int, default=0, help="kills, packets (default: what the result was asked for)")
    parser.add_argument("--hours", type=float, default=24.0, help="of the day (24)")
    parser.add_argument("--out", default=os.path.join(ROOT, "out/field"), help="where it writes (default out/field)")
    parser.add_argument("--short", action="store_true", help="seconds instead of minutes, as in ctest")
    parser.add_argument("--json", metavar="FILE", help="write the lines there, too")
    return parser.parse_args()


def has_namespaces():
    return os.geteuid() == 0 and subprocess.run(["unshare", "-n", "-u", "true"], stderr=subprocess.DEVNULL,
                                                check=False).returncode == 0


def main():
    arguments = parse()
    if arguments.list:
        for name, function in MEASUREMENTS.items():
            print(f"{name:20} {function.__doc__.splitlines()[0]}")
        return 0
    unknown = [name for name in arguments.names if name not in MEASUREMENTS]
    if unknown:
        print(f"field: no measurement {unknown[0]}; see field.py --list", file=sys.stderr)
        return 2
    if not has_namespaces():
        print("field: skipped: needs root and network namespaces", file=sys.stderr)
        return 77
    build, out = os.path.abspath(arguments.build), os.path.abspath(arguments.out)
    os.chdir(ROOT)
    all_rows = []
    wire.load_types(build)
    failed = False
    names = arguments.names or list(MEASUREMENTS)
    for number, name in enumerate(names):
        print(f"field: {name} ({number + 1} of {len(names)}) ...", file=sys.stderr, flush=True)
        bench = Bench(build, os.path.join(out, name))
        begin = time.monotonic()
        try:
            rows = MEASUREMENTS[name](bench, arguments)
        except Exception:
            traceback.print_exc()
            print(f"field: {name} could not be measured", file=sys.stderr)
            failed = True
            continue
        finally:
            bench.close()
        for row in rows:
            print(f"{row.name}: {row.what}: {row.measured} (wanted: {row.wanted}) {row.verdict()}",
                  flush=True)
            failed = failed or row.met is False
        all_rows += [vars(row) for row in rows]
        print(f"field: {name} took {time.monotonic() - begin:.0f} s", file=sys.stderr)
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(all_rows, file, indent=1)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
