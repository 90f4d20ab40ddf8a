# SPDX-License-Identifier: BSD-3-Clause
"""Writes a drive as bags: ROS 1 by Debian's rosbag, ROS 2's sqlite3 by Python's sqlite3, MCAP by
@mcap/core of npm (write_mcap.mjs)."""
import base64
import json
import pathlib
import sqlite3
import subprocess

import npm_modules
from cdr import cdr
from drive import ROS_TYPES, TOPICS, stamp


def ros2_name(ros_type):
    return ros_type.replace("/", "/msg/")


def write_rosbag(messages, path, compression):
    """compression: none, bz2 or lz4. Raises ImportError without Debian's python3-rosbag."""
    import genpy
    import geometry_msgs.msg
    import nav_msgs.msg
    import rosbag
    import sensor_msgs.msg

    packages = {"sensor_msgs": sensor_msgs.msg, "nav_msgs": nav_msgs.msg,
                "geometry_msgs": geometry_msgs.msg}

    def fill(target, values):
        for name, value in values.items():
            if name == "header":
                target.header.stamp = genpy.Time(*stamp(value[0]))
                target.header.frame_id = value[1]
            elif isinstance(value, dict):
                fill(getattr(target, name), value)
            else:
                setattr(target, name, value)

    with rosbag.Bag(str(path), "w", compression=compression, chunk_threshold=200_000) as bag:
        for utime, channel, values in messages:
            package, name = ROS_TYPES[channel].split("/")
            message = getattr(packages[package], name)()
            fill(message, values)
            bag.write(TOPICS[channel], message, genpy.Time(*stamp(utime)))


def write_sqlite(messages, path, compress=None):
    """As rosbag2's storage plugin lays it out; `compress` is applied to each message's bytes."""
    with sqlite3.connect(path) as db:
        db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT "
                   "NULL, serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
        db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
                   "timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
        db.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
        ids = {}
        for utime, channel, values in messages:
            if channel not in ids:
                ids[channel] = len(ids) + 1
                db.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')",
                           (ids[channel], TOPICS[channel], ros2_name(ROS_TYPES[channel])))
            data = cdr(ROS_TYPES[channel], values)
            db.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                       (ids[channel], utime * 1000, compress(data) if compress else data))
    db.close()


def write_mcap(messages, path, compression, modules):
    """By @mcap/core, the fields made bytes by @foxglove/rosmsg2-serialization; `modules` holds them."""
    lines = []
    for utime, channel, values in messages:
        fields = dict(values)
        sec, nsec = stamp(fields["header"][0])
        fields["header"] = {"stamp": {"sec": sec, "nsec": nsec},
                            "frame_id": fields["header"][1]}
        if "data" in fields:
            fields["data"] = {"base64": base64.b64encode(fields["data"]).decode()}
        if "ranges" in fields:
            fields["ranges"] = ["inf" if r == float("inf") else r for r in fields["ranges"]]
        lines.append(json.dumps([str(utime * 1000), TOPICS[channel],
                                 ros2_name(ROS_TYPES[channel]), fields]))
    script = npm_modules.script(pathlib.Path(modules), "write_mcap.mjs")
    subprocess.run(["node", str(script), str(path), compression], input="\n".join(lines),
                   text=True, check=True)
