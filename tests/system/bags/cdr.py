# SPDX-License-Identifier: BSD-3-Clause
"""CDR as ROS 2 sends it (OMG DDSI-RTPS 10, plain CDR, little-endian), by the messages' definitions."""
import struct

POINT = [("x", "d"), ("y", "d"), ("z", "d")]
QUATERNION = POINT + [("w", "d")]
POSE = [("position", POINT), ("orientation", QUATERNION)]
TWIST = [("linear", POINT), ("angular", POINT)]
# A letter as in struct; "s" a text; "bytes" and "floats" sequences; "N*d" an array of fixed length.
DEFINITIONS = {
    "sensor_msgs/LaserScan": [("angle_min", "f"), ("angle_max", "f"), ("angle_increment", "f"),
                              ("time_increment", "f"), ("scan_time", "f"), ("range_min", "f"),
                              ("range_max", "f"), ("ranges", "floats"), ("intensities", "floats")],
    "sensor_msgs/CompressedImage": [("format", "s"), ("data", "bytes")],
    "sensor_msgs/Image": [("height", "I"), ("width", "I"), ("encoding", "s"), ("is_bigendian", "B"),
                          ("step", "I"), ("data", "bytes")],
    "nav_msgs/Odometry": [("child_frame_id", "s"), ("pose", [("pose", POSE), ("covariance", 36)]),
                          ("twist", [("twist", TWIST), ("covariance", 36)])],
    "sensor_msgs/Imu": [("orientation", QUATERNION), ("orientation_covariance", 9),
                        ("angular_velocity", POINT), ("angular_velocity_covariance", 9),
                        ("linear_acceleration", POINT), ("linear_acceleration_covariance", 9)],
    "sensor_msgs/NavSatFix": [("status", [("status", "b"), ("service", "H")]), ("latitude", "d"),
                              ("longitude", "d"), ("altitude", "d"), ("position_covariance", 9),
                              ("position_covariance_type", "B")],
    "geometry_msgs/PoseWithCovarianceStamped": [("pose", [("pose", POSE), ("covariance", 36)])],
}


class Writer:
    def __init__(self):
        self.content = bytearray()

    def put(self, letter, *values):
        size = struct.calcsize(letter)
        self.content += bytes(-len(self.content) % size)
        self.content += struct.pack(f"<{len(values)}{letter}", *values)

    def text(self, value):
        encoded = value.encode() + b"\0"
        self.put("I", len(encoded))
        self.content += encoded

    def fields(self, definition, values):
        for name, kind in definition:
            value = values[name]
            if isinstance(kind, list):
                self.fields(kind, value)
            elif isinstance(kind, int):
                self.put("d", *value)
            elif kind == "s":
                self.text(value)
            elif kind == "bytes":
                self.put("I", len(value))
                self.content += value
            elif kind == "floats":
                self.put("I", len(value))
                if value:
                    self.put("f", *value)
            else:
                self.put(kind, value)


def cdr(ros_type, fields):
    utime, frame = fields["header"]
    writer = Writer()
    writer.put("i", utime // 1_000_000)
    writer.put("I", utime % 1_000_000 * 1000)
    writer.text(frame)
    writer.fields(DEFINITIONS[ros_type], fields)
    return b"\0\1\0\0" + bytes(writer.content)
