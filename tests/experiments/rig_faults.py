# SPDX-License-Identifier: BSD-3-Clause
"""Fifteen faults of a rig, each on drives of a right one: is the fault named by its key, and no right rig?"""
import json
import math
import struct

from lab import overlay


# rotations as the extrinsics' angles have them: p_camera = Rx Ry Rz p_laser + delta (x right, y down, z ahead)

def _turn(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    m = [[float(a == b) for b in range(3)] for a in range(3)]
    m[i][i], m[i][j], m[j][i], m[j][j] = c, -s, s, c
    return m


def _product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turned_camera(phi, axis, angle):
    """The angles phi of a camera that is turned about its own axis."""
    r = _product(_turn(0, phi[0]), _product(_turn(1, phi[1]), _turn(2, phi[2])))
    r = _product(_turn(axis, angle), r)
    return [math.atan2(-r[1][2], r[2][2]), math.asin(r[0][2]), math.atan2(-r[0][1], r[0][0])]


# logs: events of LCM's format; fields as in lcmtypes/

def _events(data):
    at = 0
    while at < len(data):
        sync, number, utime, len_channel, len_data = struct.unpack_from(">IqqII", data, at)
        begin = at + 28 + len_channel
        yield (sync, number, utime), data[at + 28:begin], data[begin:begin + len_data]
        at = begin + len_data


def altered_log(source, target, alter):
    """Writes the log with what alter(channel, data) makes of each message; None: the message is left out."""
    with open(target, "wb") as out:
        for (sync, number, utime), channel, data in _events(source.read_bytes()):
            data = alter(channel.decode(), data)
            if data is None:
                continue
            out.write(struct.pack(">IqqII", sync, number, utime, len(channel), len(data)) + channel + data)


def scaled_wheels(channel, data):
    """Wheels that say 1.2 m for a metre."""
    if channel != "ODOMETRY":
        return data
    speed, = struct.unpack_from(">d", data, 20)
    return data[:20] + struct.pack(">d", 1.2 * speed) + data[28:]


def mirrored_scans(channel, data):
    """A scanner upside down whose driver does not know."""
    if channel != "SCAN":
        return data
    num_ranges, num_intensities = struct.unpack_from(">ii", data, 20)
    ranges = struct.unpack_from(f">{num_ranges}f", data, 68)
    rest = struct.unpack_from(f">{num_intensities}f", data, 68 + 4 * num_ranges)
    return data[:68] + struct.pack(f">{num_ranges}f", *reversed(ranges)) + struct.pack(f">{num_intensities}f", *reversed(rest))


PHI = [1.5788, 0.0065, 1.5628]  # of config/orchard.yaml


def camera(axis, degrees):
    return {"camera.phi_rad": turned_camera(PHI, axis, math.radians(degrees))}


# name: (changes of the right rig, change of the log, names of findings that are right)
FAULTS = {
    "camera yaw 5 degrees": (camera(1, 5), None, {"camera_yaw"}),
    "camera roll 5 degrees": (camera(2, 5), None, {"camera_roll"}),
    "camera pitch 5 degrees": (camera(0, 5), None, {"camera_pitch"}),
    "camera upside down": (camera(2, 180), None, {"camera_flipped"}),
    "focal length double": ({"camera.fc_px": [443.0, 443.8]}, None, {"camera_focal"}),
    "trunk width half": ({"detector.width.mean_m": 0.0625}, None, {"few_trees"}),
    "trunk width double": ({"detector.width.mean_m": 0.25}, None, {"few_trees"}),
    "laser reversed": ({}, mirrored_scans, {"mirrored"}),
    "laser yaw 5 degrees": ({"laser.mount_yaw_rad": 0.0873}, None, {"laser_yaw"}),
    "laser mount 0.5 m": ({"laser.mount_x_m": 0.85}, None, {"laser_mount"}),
    "range_sd a third": ({"laser.range_sd_m": 0.004, "laser.range_sd_fraction": 0.00033}, None, {"range_sd"}),
    "wheels 20 %": ({}, scaled_wheels, {"wheels_scale"}),
    "camera delay 0.2 s": ({"camera.delay_s": 0.2}, None, {"camera_delay"}),
    "antenna on the wrong side": ({"pose.gnss.antenna_m": [0.0, -0.8]}, None, {"antenna"}),
    "scanners exchanged": ({"laser.mount_x_m": -0.35, "laser.mount_yaw_rad": math.pi, "laser_rear.mount_x_m": 0.35,
                            "laser_rear.mount_yaw_rad": 0.0}, None, {"scanners_exchanged"}),
}
REAR = {"laser_rear.enabled": "true", "laser_rear.mount_x_m": -0.35, "laser_rear.mount_yaw_rad": math.pi}


def findings(lab, drive, rig, log=None):
    """Names of what a map says of itself; log: a change of the drive's log."""
    changed = None
    if log is not None:
        source = drive
        drive = lab.made("log", {"drive": drive.name, "change": log.__doc__},
                         lambda folder: altered_log(source / "drive.lcm", folder / "drive.lcm", log))
        changed = log.__doc__
    folder = lab.map(drive, rig, "--quiet", "--no-derived", changed=changed)
    return [finding["name"] for finding in json.loads((folder / "summary.json").read_text())["quality"]]


def wrong_rigs(lab, seeds):
    def one(job):
        name, seed = job
        changes, log, right = FAULTS[name]
        rig = lab.rig("orchard", {"camera.enabled": "false", **REAR} if "exchanged" in name else {})
        said = findings(lab, lab.drive(rig, seed), overlay(rig, changes), log)
        return name, bool(said) and said[0] in right, said

    told = {name: [] for name in FAULTS}
    for name, is_named, said in lab.each([(name, seed) for name in FAULTS for seed in seeds], one):
        told[name].append(is_named)
        if not is_named:
            lab.say(f"  {name}: {said}")
    for name, right in told.items():
        lab.say(f"  {name}: {sum(right)} of {len(right)}")
    num = sum(map(len, told.values()))
    return {"named": f"{sum(map(sum, told.values()))} of {num}",
            "worst": ", ".join(f"{n} {sum(r)}" for n, r in told.items() if sum(r) < len(r)) or "none"}


def right_rigs(lab, seeds):
    rigs = {"orchard": (lab.rig("orchard"), "orchard", 0), "orchard_hard": (lab.rig("orchard_hard"), "orchard", 0),
            "block": (lab.rig("block"), "orchard", 120), "yard": (lab.rig("yard"), "yard", 120),
            "park": (lab.rig("park"), "park", 120),
            "two scanners": (lab.rig("orchard", {"camera.enabled": "false", **REAR}), "orchard", 0)}
    # what is wrong with a path or a map (no loop, twins, no rows) is no alarm about its rig
    of_rig = set().union(*(right for _, _, right in FAULTS.values())) - {"few_trees"} | {"wheels_delay"}

    def one(job):
        rig, scene, seconds = rigs[job[0]]
        said = findings(lab, lab.drive(rig, job[1], scene, seconds), rig)
        return job, [name for name in said if name in of_rig]

    jobs = [(name, seed) for name in rigs for seed in seeds]
    alarms = 0
    for job, said in lab.each(jobs, one):
        alarms += bool(said)
        if said:
            lab.say(f"  {job}: {said}")
    return {"alarms": f"{alarms} of {len(jobs)}"}
