# SPDX-License-Identifier: BSD-3-Clause
"""Makes the measurements of tests/experiments/field.sh; the functions of the measure_ files, by name."""
import argparse
import os
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
import measure_strangers
import measure_two_machines
import table
import wire
from programs import Bench

MEASUREMENTS = {
    function.__name__: function for function in (
        measure_link.loss, measure_link.loss_default_kernel, measure_link.duplicates,
        measure_link.reorder, measure_link.link_down, measure_link.slow_link,
        measure_kills.kills, measure_kills.kills_saving, measure_disk.disk_full,
        measure_disk.rotation, measure_hostile.hostile,
        measure_hostile.hostile_guarded,
        measure_clocks.clocks, measure_clocks.clock_offset, measure_strangers.twice,
        measure_strangers.same_folder, measure_strangers.old_types, measure_strangers.calibration,
        measure_two_machines.two_machines, measure_laser.laser_unplug, measure_laser.laser_cable,
        measure_laser.laser_stamps, measure_laser.laser_sums, measure_live.emulated, measure_day.day)
}


def parse():
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--build", default="build")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--speed", type=float, default=2.0)
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--num", type=int, default=0)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--out", default="out/field")
    parser.add_argument("--list", action="store_true")
    return parser.parse_args()


def main():
    arguments = parse()
    if arguments.list:
        for name, function in MEASUREMENTS.items():
            print(f"{name:20} {function.__doc__.splitlines()[0]}")
        return 0
    unknown = [name for name in arguments.names if name not in MEASUREMENTS]
    if unknown:
        print(f"field: no measurement {unknown[0]}; see field.sh --list", file=sys.stderr)
        return 2
    build = os.path.abspath(arguments.build)
    wire.load_types(build)
    failed = False
    names = arguments.names or list(MEASUREMENTS)
    for number, name in enumerate(names):
        print(f"field: {name} ({number + 1} of {len(names)}) ...", file=sys.stderr, flush=True)
        bench = Bench(build, os.path.abspath(os.path.join(arguments.out, name)))
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
        if arguments.write:
            table.write(rows, list(MEASUREMENTS))
        print(f"field: {name} took {time.monotonic() - begin:.0f} s", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
