#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What does it cost to publish many trees, and is a publisher that is killed all or nothing?

A PostgreSQL with PostGIS of its own; a map of TREES trees (default 1,000,000) is published, published
again unchanged, by two at once as two blocks, and killed at ten moments.
  tests/experiments/publish_cost.py [TREES]       needs a build in build/ (or BUILD=folder)
"""
import os
import random
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/tests/system", ROOT + "/tests/system/publish"]
import maps  # noqa: E402
import server as postgres  # noqa: E402

ORCHARD = os.environ.get("BUILD", ROOT + "/build") + "/bin/orchard"


def write_map(folder, trees, seed):
    dice = random.Random(seed)
    maps.write_map(folder, (maps.landmark(i + 1, 2 * (i % 1000) + dice.gauss(0, 0.05), 4 * (i // 1000), i // 1000 + 1, i % 1000 + 1,
                                          dice.gauss(0.12, 0.01)) for i in range(trees)),
                   georeference=maps.datum(41.6, 0.6, 200.0, yaw_rad=0.2))


def main():
    if len(sys.argv) > 1 and sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return
    trees = int(sys.argv[1]) if len(sys.argv) > 1 else 1000000
    with postgres.Server() as db, tempfile.TemporaryDirectory() as folder:
        write_map(folder + "/a", trees, 1)
        write_map(folder + "/b", trees, 2)

        def start(name, block):
            return subprocess.Popen([ORCHARD, "publish", f"{folder}/{name}", "--to", db.url(),
                                     "--block", block, "--date", "2026-04-10"],
                                    stdout=subprocess.DEVNULL)

        def timed(*jobs):
            begin = time.monotonic()
            publishers = [start(*job) for job in jobs]
            assert all(p.wait() == 0 for p in publishers)
            return time.monotonic() - begin

        def count(where="true"):
            return int(db.sql(f"SELECT count(*) FROM orchard.tree WHERE {where}")[0])

        first_s = timed(("a", "north"))
        print(f"{trees} trees published in {first_s:.1f} s", flush=True)
        print(f"again, unchanged: {timed(('a', 'north')):.1f} s", flush=True)
        print(f"two at once, two blocks: {timed(('a', 'east'), ('b', 'west')):.1f} s; "
              f"{count()} trees are there", flush=True)
        num_whole = num_nothing = 0
        print("killed at ten moments: ", end="")
        for k in range(10):
            publisher = start("b", f"k{k}")
            time.sleep(first_s * (k + 0.5) / 10)
            publisher.kill()
            publisher.wait()
            while db.sql("SELECT count(*) FROM pg_stat_activity WHERE "
                         "application_name = 'orchard publish'") != ["0"]:
                time.sleep(0.1)
            there = count(f"block = 'k{k}'")
            num_whole += there == trees
            num_nothing += there == 0
        print(f"{num_nothing} times nothing, {num_whole} times all, "
              f"{10 - num_whole - num_nothing} times a part")


if __name__ == "__main__":
    main()
