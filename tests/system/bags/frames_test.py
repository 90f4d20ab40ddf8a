#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""frames_test.py ORCHARD SOURCE WORK: what /tf, /tf_static and camera_info of a bag tell about the rig,
against matrices composed here; and the robot's motion from /tf where there is no odometry."""
import csv
import math
import pathlib
import shutil
import subprocess
import sys

import numpy
import yaml
from drive import events, read, types
import write_bags

ORCHARD, SOURCE, WORK = sys.argv[1:4]
# Parent, child, x, y, z, roll, pitch, yaw: a mast with the scanner, turned; a camera that looks forward.
FIXED = [("base_footprint", "base_link", 0.0, 0.0, 0.12, 0, 0, 0),
         ("base_link", "mast", 0.2, 0.1, 0.5, 0, 0, 0.3),
         ("mast", "laser", 0.1, -0.05, 0.2, 0, 0, -0.25),
         ("base_link", "camera_link", 0.3, 0.02, 0.6, 0.01, -0.02, 0.05),
         ("camera_link", "camera", 0, 0, 0, -math.pi / 2, 0, -math.pi / 2),
         ("mast", "gps", -0.4, 0.3, 1.0, 0, 0, 0)]
LENS = {"height": 240, "width": 320, "distortion_model": "plumb_bob", "d": [-0.1, 0.02, 0.001, -0.002, 0.0],
        "k": [221.5, 0, 161.3, 0, 221.9, 118.2, 0, 0, 1], "r": [1, 0, 0, 0, 1, 0, 0, 0, 1], "p": [0.0] * 12,
        "binning_x": 0, "binning_y": 0,
        "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": 0}}


def rotation(roll, pitch, yaw):
    """Rz Ry Rx, as URDF's rpy."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    x = numpy.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    y = numpy.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    z = numpy.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return z @ y @ x


def quaternion(roll, pitch, yaw):
    cr, sr, cp, sp, cy, sy = (f(a / 2) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return {"x": sr * cp * cy - cr * sp * sy, "y": cr * sp * cy + sr * cp * sy,
            "z": cr * cp * sy - sr * sp * cy, "w": cr * cp * cy + sr * sp * sy}


def pose_of(frame, joints):
    """4 x 4 of a frame in base_footprint."""
    matrix = numpy.eye(4)
    parents = {j[1]: j for j in joints}
    while frame in parents:
        parent, _, x, y, z, *rpy = parents[frame]
        joint = numpy.eye(4)
        joint[:3, :3], joint[:3, 3] = rotation(*rpy), (x, y, z)
        matrix, frame = joint @ matrix, parent
    return matrix


def transform(utime, parent, child, x, y, z, *rpy):
    return {"header": (utime, parent), "child_frame_id": child,
            "transform": {"translation": {"x": x, "y": y, "z": z}, "rotation": quaternion(*rpy)}}


def orchard(*words, code=0):
    done = subprocess.run([ORCHARD, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == code, (words, done)
    return done.stdout


class Bag:
    def __init__(self, folder):
        self.folder = folder
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "types").mkdir(parents=True)
        log = folder / "drive.lcm"
        orchard("simulate", "--scene", "orchard", "--seed", "3", "--duration", "8", "--out", log,
                "--poses", folder / "poses.csv")
        self.messages = read(SOURCE, log, str(folder / "types"))
        with open(folder / "poses.csv") as file:
            self.path = [(int(r["utime_us"]), float(r["x_m"]), float(r["y_m"]), float(r["yaw_rad"]))
                         for r in csv.DictReader(file)]

    def imported(self, name, messages, joints, with_motion):
        """The bag's import: what it printed, the rig's YAML, the log."""
        start = messages[0][0]
        frames = [(start, "TF_STATIC", {"transforms": [transform(start, *j) for j in joints]}),
                  (start, "CAMERA_INFO", {"header": (start, "camera"), **LENS})]
        if with_motion:  # beside a wheel that turns
            frames += [(t, "TF", {"transforms": [transform(t, "base_link", "wheel", 0, 0, 0, 0, t * 1e-6, 0),
                                                 transform(t, "odom", "base_footprint", x, y, 0, 0, 0, yaw)]})
                       for t, x, y, yaw in self.path]
        bag, rig, log = (self.folder / (name + end) for end in (".db3", ".yaml", ".lcm"))
        write_bags.write_sqlite(sorted(messages + frames, key=lambda m: m[0]), bag)
        said = orchard("import", bag, "--out", log, "--rig-out", rig)
        return said, yaml.safe_load(rig.read_text()), log


def assert_near(values, truth, slack=2e-6):
    values = [float(v) for v in (values if isinstance(values, list) else [values])]
    assert numpy.allclose(values, truth, atol=slack, rtol=0), (values, truth)


def rig_is_that_of_the_frames(rig):
    laser, camera = pose_of("laser", FIXED), pose_of("camera", FIXED)
    assert_near(rig["laser"]["mount_x_m"], laser[0, 3])
    assert_near(rig["laser"]["mount_y_m"], laser[1, 3])
    assert_near(rig["laser"]["mount_yaw_rad"], 0.05)
    # p_camera = Rx Ry Rz p_laser + delta (the paper's eq. 2).
    to_camera = numpy.linalg.inv(camera) @ laser
    assert_near(rig["camera"]["delta_m"], to_camera[:3, 3])
    a, b, c = (float(v) for v in rig["camera"]["phi_rad"])
    assert numpy.allclose(rotation(a, 0, 0) @ rotation(0, b, 0) @ rotation(0, 0, c), to_camera[:3, :3], atol=4e-6)
    assert_near(rig["pose"]["gnss"]["antenna_m"], pose_of("gps", FIXED)[:2, 3])
    assert_near(rig["camera"]["fc_px"], [221.5, 221.9])
    assert_near(rig["camera"]["kc"], LENS["d"])


def motion_is_that_of_the_path(bag, log):
    """A reading is the mean since the one before (lcmtypes): added up they give the path."""
    orchard_types = types(SOURCE, str(bag.folder / "types"))
    speeds = [orchard_types.odometry_t.decode(data) for channel, data in events(log) if channel == "ODOMETRY"]
    assert [s.utime for s in speeds] == [t for t, _, _, _ in bag.path]
    _, x, y, yaw = bag.path[0]
    for before, speed, (_, true_x, true_y, true_yaw) in zip(speeds, speeds[1:], bag.path[1:]):
        step = 1e-6 * (speed.utime - before.utime)
        middle = yaw + speed.yaw_rate_radps * step / 2
        x += speed.speed_mps * step * math.cos(middle)
        y += speed.speed_mps * step * math.sin(middle)
        yaw += speed.yaw_rate_radps * step
        assert math.hypot(x - true_x, y - true_y) < 0.001, (x, y, true_x, true_y)
        assert abs(math.remainder(yaw - true_yaw, 2 * math.pi)) < 1e-6


def main():
    write_bags.TOPICS.update(TF="/tf", TF_STATIC="/tf_static", CAMERA_INFO="/camera/camera_info")
    write_bags.ROS_TYPES.update(TF="tf2_msgs/TFMessage", TF_STATIC="tf2_msgs/TFMessage",
                                CAMERA_INFO="sensor_msgs/CameraInfo")
    bag = Bag(pathlib.Path(WORK, "frames"))
    said, rig, _ = bag.imported("all", bag.messages, FIXED, True)
    assert "odometry: /odom" in said, said
    rig_is_that_of_the_frames(rig)
    without = [m for m in bag.messages if m[1] != "ODOMETRY"]
    said, rig, log = bag.imported("tf", without, FIXED, True)
    assert "odometry: /tf" in said, said
    rig_is_that_of_the_frames(rig)
    motion_is_that_of_the_path(bag, log)
    said, rig, _ = bag.imported("still", without, FIXED, False)  # nothing moves: no odometry
    assert "odometry:" not in said, said
    rig_is_that_of_the_frames(rig)
    # What a mount in the plane cannot tell is said, not guessed; nor is a camera that is none.
    hung = [j if j[1] != "laser" else ("mast", "laser", 0.1, 0, 0.2, math.pi, 0, 0) for j in FIXED]
    said, rig, _ = bag.imported("hung", without, hung, False)
    assert "upside down" in said and "laser" not in rig, (said, rig)
    plain = [j if j[1] != "camera" else ("camera_link", "camera", 0, 0, 0, 0, 0, 0) for j in FIXED]
    said, rig, _ = bag.imported("plain", without, plain, False)
    assert "not an optical frame" in said and "phi_rad" not in rig["camera"], (said, rig)
    said, rig, _ = bag.imported("loose", without, [j for j in FIXED if j[1] != "mast"], False)
    assert "no fixed transforms" in said, said
    print("the frames tell the rig")


if __name__ == "__main__":
    main()
