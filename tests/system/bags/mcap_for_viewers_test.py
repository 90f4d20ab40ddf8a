#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""mcap_for_viewers_test.py ORCHARD SOURCE WORK: what `orchard log mcap` writes is read by @mcap/core and
Foxglove's reader of CDR, has the types of ROS 2, and says what the log and its map say; imported again it
gives the log's map and rig. Exit code 77: npm's packages are not to be had."""
import base64
import csv
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys

import drive
import npm_modules
import yaml

ORCHARD, SOURCE, WORK = sys.argv[1:4]


def orchard(*words):
    return subprocess.run([ORCHARD, *map(str, words)], check=True, capture_output=True, text=True).stdout


def near(a, b, slack=1e-6):
    return abs(a - b) <= slack


def single(value):
    """As ROS's single precision has it."""
    return struct.unpack("f", struct.pack("f", value))[0]


def rows_of(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def yaw_of(q):
    return 2 * math.atan2(q["z"], q["w"])


def same_angle(a, b):
    return near(math.remainder(a - b, 2 * math.pi), 0, 1e-5)


def read(modules, path):
    """(time in ns, message) by topic, and the topics' types."""
    done = subprocess.run(["node", npm_modules.script(modules, "read_mcap.mjs"), path],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    topics, types = {}, {}
    for line in done.stdout.splitlines():
        topic, type_name, time_ns, message = json.loads(line)
        topics.setdefault(topic, []).append((int(time_ns), message))
        types[topic] = type_name
    return topics, types


def sensors_are_those_of_the_log(topics, log, folder):
    orchard_types = drive.types(SOURCE, str(folder))
    sent = {name: [] for name in drive.TYPES}
    for channel, data in drive.events(log):
        if channel in sent:
            sent[channel].append(getattr(orchard_types, drive.TYPES[channel]).decode(data))
    assert len(sent["SCAN"]) == len(topics["/scan"]) > 50
    for scan, (time_ns, message) in zip(sent["SCAN"], topics["/scan"]):
        stamp = message["header"]["stamp"]
        assert time_ns == scan.utime * 1000 == stamp["sec"] * 10**9 + stamp["nanosec"]
        end = scan.bearing_min_rad + (scan.num_ranges - 1) * scan.bearing_step_rad
        assert message["angle_min"] == single(scan.bearing_min_rad)
        assert message["angle_max"] == single(end)
        assert message["ranges"] == ["inf" if r == 0.0 else r for r in scan.ranges_m]
    pictures = topics["/camera/image_raw/compressed"]
    assert [base64.b64decode(m["data"]["base64"]) for _, m in pictures] == \
        [bytes(p.data) for p in sent["IMAGE"]]
    assert [m["latitude"] for _, m in topics["/gnss"]] == [f.latitude_deg for f in sent["GNSS"]]
    assert [m["twist"]["twist"]["linear"]["x"] for _, m in topics["/odom"]] == \
        [o.speed_mps for o in sent["ODOMETRY"]]
    assert [m["angular_velocity"]["z"] for _, m in topics.get("/imu", [])] == \
        [i.angular_rate_radps[2] for i in sent["IMU"]]


def map_is_that_of_the_folder(topics, folder):
    landmarks = {int(row["id"]): row for row in rows_of(folder / "map.csv")}
    markers = topics["/map"][0][1]["markers"]
    cylinders = {m["id"]: m for m in markers if m["ns"] == "landmarks"}
    numbers = {m["id"]: m for m in markers if m["ns"] == "numbers"}
    assert cylinders.keys() == numbers.keys() == landmarks.keys() and len(landmarks) > 5
    for number, row in landmarks.items():
        shown, paint = cylinders[number], cylinders[number]["color"]
        assert near(shown["pose"]["position"]["x"], float(row["x_m"]))
        assert near(shown["pose"]["position"]["y"], float(row["y_m"]))
        assert near(shown["scale"]["x"], max(0.02, float(row["width_m"])))
        assert (paint["g"] > paint["r"]) == (row["class"] == "tree")
        assert shown["type"] == 3 and shown["action"] == 0 and shown["pose"]["orientation"]["w"] == 1
        if row["row"]:
            assert numbers[number]["text"] == f"{row['row']}.{row['position']}"
    path = rows_of(folder / "trajectory.csv")
    poses = topics["/map/path"][0][1]["poses"]
    assert len(path) == len(topics["/tf"]) == len(poses)
    for row, (time_ns, message), pose in zip(path, topics["/tf"], poses):
        moved = message["transforms"][0]
        assert (moved["header"]["frame_id"], moved["child_frame_id"]) == ("map", "base")
        assert time_ns == int(row["utime_us"]) * 1000
        for x, turned in ((moved["transform"]["translation"]["x"], moved["transform"]["rotation"]),
                          (pose["pose"]["position"]["x"], pose["pose"]["orientation"])):
            assert near(x, float(row["x_m"])) and same_angle(yaw_of(turned), float(row["yaw_rad"]))


def camera_looks_forward(topics):
    """Upright: its z axis along base's x, its y axis down."""
    mounts = {t["child_frame_id"]: t["transform"] for t in topics["/tf_static"][0][1]["transforms"]}
    q = mounts["camera"]["rotation"]
    x, y, z, w = q["x"], q["y"], q["z"], q["w"]
    forward = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    down = (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x))
    assert forward[0] > 0.98 and down[2] < -0.98, (forward, down)


def values_of(yaml_text, *sections):
    node = yaml.safe_load(yaml_text)
    for section in sections:
        node = node[section]
    return node


def flat(value):
    return value if isinstance(value, list) else [value]


def imported_again_it_is_the_log(log, shown, folder):
    """The rig by /tf_static and camera_info; the map as of the log, but for single precision."""
    orchard("import", shown, "--out", folder / "again.lcm", "--rig-out", folder / "again.yaml",
            "--topic", "pose_fix=/pose_fix")
    rig, again = orchard("log", "config", log), (folder / "again.yaml").read_text()
    for section, keys in (("laser", ("mount_x_m", "mount_y_m", "mount_yaw_rad")),
                          ("camera", ("width_px", "height_px", "fc_px", "cc_px", "kc", "delta_m", "phi_rad"))):
        for key in keys:
            for a, b in zip(flat(values_of(rig, section)[key]), flat(values_of(again, section)[key])):
                assert near(float(a), float(b), 2e-3 if key.endswith("_px") else 2e-6), (section, key, a, b)
    (folder / "rig.yaml").write_text(rig)
    orchard("map", folder / "again.lcm", "--config", folder / "rig.yaml", "--out", folder / "again", "--quiet")
    first, second = rows_of(folder / "map/map.csv"), rows_of(folder / "again/map.csv")
    assert len(first) == len(second)
    for a, b in zip(first, second):
        assert all(a[key] == b[key] for key in ("id", "class", "n", "row", "position")), (a, b)
        assert all(near(float(a[key]), float(b[key]), 0.0005) for key in ("x_m", "y_m", "width_m")), (a, b)


def trajectory_is_evos(folder):
    """trajectory.tum says the same to evo: seconds, place, quaternion."""
    path = rows_of(folder / "trajectory.csv")
    tum = [[float(v) for v in line.split()]
           for line in (folder / "trajectory.tum").read_text().splitlines() if not line.startswith("#")]
    assert len(tum) == len(path)
    for row, (t, tx, ty, tz, qx, qy, qz, qw) in zip(path, tum):
        assert near(t, 1e-6 * int(row["utime_us"]), 1e-6) and tz == qx == qy == 0
        assert near(tx, float(row["x_m"])) and near(ty, float(row["y_m"]))
        assert same_angle(2 * math.atan2(qz, qw), float(row["yaw_rad"]))


def main():
    modules = npm_modules.fetch(WORK)
    folder = pathlib.Path(WORK, "viewers")
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "types").mkdir(parents=True)
    log, shown = folder / "drive.lcm", folder / "drive.mcap"
    orchard("simulate", "--scene", "orchard", "--seed", "5", "--duration", "8", "--out", log)
    orchard("map", log, "--out", folder / "map", "--quiet")
    orchard("log", "mcap", log, "--map", folder / "map", "--out", shown)
    topics, types = read(modules, shown)
    assert types["/map"] == "visualization_msgs/msg/MarkerArray" and types["/tf"] == "tf2_msgs/msg/TFMessage"
    sensors_are_those_of_the_log(topics, log, folder / "types")
    map_is_that_of_the_folder(topics, folder / "map")
    camera_looks_forward(topics)
    imported_again_it_is_the_log(log, shown, folder)
    trajectory_is_evos(folder / "map")
    # The messages on the way, without a finished map.
    orchard("log", "mcap", folder / "map/derived.lcm", "--config", folder / "rig.yaml", "--out", folder / "derived.mcap")
    derived, types = read(modules, folder / "derived.mcap")
    assert len(derived["/detections"]) > 50 and len(derived["/map"]) > 1, derived.keys()
    print(f"{sum(map(len, topics.values()))} messages on {len(topics)} topics hold")


if __name__ == "__main__":
    main()
