#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""mcap_for_viewers_test.py ORCHARD SOURCE WORK: what `orchard log mcap` writes is read by @mcap/core,
holds to Foxglove's own schemas, and says what the log and its map say. Exit code 77: npm's packages are
not to be had."""
import base64
import csv
import json
import math
import pathlib
import shutil
import subprocess
import sys

import drive
import npm_modules

ORCHARD, SOURCE, WORK = sys.argv[1:4]


def orchard(*words):
    subprocess.run([ORCHARD, *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def near(a, b, slack=1e-6):
    return abs(a - b) <= slack


def main():
    modules = npm_modules.fetch(WORK)
    folder = pathlib.Path(WORK, "viewers")
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "types").mkdir(parents=True)
    log, shown = folder / "drive.lcm", folder / "drive.mcap"
    orchard("simulate", "--scene", "orchard", "--seed", "5", "--duration", "8", "--out", log)
    orchard("map", log, "--out", folder / "map", "--quiet")
    orchard("log", "mcap", log, "--map", folder / "map", "--out", shown)
    read = subprocess.run(["node", npm_modules.script(modules, "read_mcap.mjs"), shown],
                          capture_output=True, text=True)
    assert read.returncode == 0, read.stderr
    topics = {}
    for line in read.stdout.splitlines():
        topic, time_ns, message = json.loads(line)
        topics.setdefault(topic, []).append((int(time_ns), message))

    orchard_types = drive.types(SOURCE, str(folder / "types"))
    scans, pictures, fixes = [], [], []
    for channel, data in drive.events(log):
        if channel == "SCAN":
            scans.append(orchard_types.scan_t.decode(data))
        if channel == "IMAGE":
            pictures.append(orchard_types.image_t.decode(data))
        if channel == "GNSS":
            fixes.append(orchard_types.gnss_t.decode(data))
    assert len(scans) == len(topics["/scan"]) > 50
    for scan, (time_ns, message) in zip(scans, topics["/scan"]):
        assert time_ns == scan.utime * 1000
        assert near(message["start_angle"], scan.bearing_min_rad)
        end = scan.bearing_min_rad + (scan.num_ranges - 1) * scan.bearing_step_rad
        assert near(message["end_angle"], end) and len(message["ranges"]) == scan.num_ranges
        for ours, theirs in zip(scan.ranges_m, message["ranges"]):
            believed = scan.range_min_m <= ours <= scan.range_max_m
            assert near(theirs, ours if believed else 0.0), (ours, theirs)
    assert [base64.b64decode(m["data"]) for _, m in topics["/camera"]] == [bytes(p.data) for p in pictures]
    assert [m["latitude"] for _, m in topics["/gnss"]] == [f.latitude_deg for f in fixes]

    with open(folder / "map/map.csv") as file:
        landmarks = {f"landmark {row['id']}": row for row in csv.DictReader(file)}
    entities = {e["id"]: e for e in topics["/map"][0][1]["entities"]}
    assert entities.keys() == landmarks.keys() and len(entities) > 5
    for name, row in landmarks.items():
        cylinder = entities[name]["cylinders"][0]
        assert near(cylinder["pose"]["position"]["x"], float(row["x_m"]))
        assert near(cylinder["pose"]["position"]["y"], float(row["y_m"]))
        assert near(cylinder["size"]["x"], max(0.02, float(row["width_m"])))
        paint = cylinder["color"]
        assert (paint["g"] > paint["r"]) == (row["class"] == "tree")
    with open(folder / "map/trajectory.csv") as file:
        path = list(csv.DictReader(file))
    assert len(path) == len(topics["/tf"]) == len(topics["/pose"])
    for row, (time_ns, message) in zip(path, topics["/tf"]):
        moved = message["transforms"][0]
        assert time_ns == int(row["utime_us"]) * 1000
        assert near(moved["translation"]["x"], float(row["x_m"]))
        yaw = 2 * math.atan2(moved["rotation"]["z"], moved["rotation"]["w"])
        assert near(math.remainder(yaw - float(row["yaw_rad"]), 2 * math.pi), 0, 1e-5)
    # The camera looks forward and stands upright: its z axis along base's x, its y axis down.
    mounts = {t["child_frame_id"]: t for t in topics["/tf_static"][0][1]["transforms"]}
    q = mounts["camera"]["rotation"]
    x, y, z, w = q["x"], q["y"], q["z"], q["w"]
    forward = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    down = (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x))
    assert forward[0] > 0.98 and down[2] < -0.98, (forward, down)
    # trajectory.tum says the same to evo: seconds, place, quaternion.
    tum = [[float(v) for v in line.split()]
           for line in (folder / "map/trajectory.tum").read_text().splitlines()
           if not line.startswith("#")]
    assert len(tum) == len(path)
    for row, (t, tx, ty, tz, qx, qy, qz, qw) in zip(path, tum):
        assert near(t, 1e-6 * int(row["utime_us"]), 1e-6) and tz == qx == qy == 0
        assert near(tx, float(row["x_m"])) and near(ty, float(row["y_m"]))
        assert near(math.remainder(2 * math.atan2(qz, qw) - float(row["yaw_rad"]), 2 * math.pi), 0, 1e-5)
    print(f"{sum(map(len, topics.values()))} messages on {len(topics)} topics hold")


if __name__ == "__main__":
    main()
