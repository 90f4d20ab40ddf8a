# SPDX-License-Identifier: BSD-3-Clause
"""CDR as ROS 2 sends it (OMG DDSI-RTPS 10, plain CDR, little-endian), by the messages' definitions."""
import struct

POINT = [("x", "d"), ("y", "d"), ("z", "d")]
QUATERNION = POINT + [("w", "d")]
POSE = [("position", POINT), ("orientation", QUATERNION)]
TWIST = [("linear", POINT), ("angular", POINT)]
TRANSFORM = [("header", "header"), ("child_frame_id", "s"),
             ("transform", [("translation", POINT), ("rotation", QUATERNION)])]
ROI = [("x_offset", "I"), ("y_offset", "I"), ("height", "I"), ("width", "I"), ("do_rectify", "B")]
# A letter as in struct; "s" a text; "bytes", "floats", "doubles" and a tuple's type as sequences; a number
# an array of so many doubles.
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
    "tf2_msgs/TFMessage": [("transforms", (TRANSFORM,))],
    "sensor_msgs/CameraInfo": [("height", "I"), ("width", "I"), ("distortion_model", "s"), ("d", "doubles"),
                               ("k", 9), ("r", 9), ("p", 12), ("binning_x", "I"), ("binning_y", "I"),
                               ("roi", ROI)],
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

    def header(self, utime, frame):
        self.put("i", utime // 1_000_000)
        self.put("I", utime % 1_000_000 * 1000)
        self.text(frame)

    def fields(self, definition, values):
        for name, kind in definition:
            value = values[name]
            if isinstance(kind, list):
                self.fields(kind, value)
            elif isinstance(kind, tuple):
                self.put("I", len(value))
                for element in value:
                    self.fields(kind[0], element)
            elif kind == "header":
                self.header(*value)
            elif isinstance(kind, int):
                self.put("d", *value)
            elif kind == "s":
                self.text(value)
            elif kind == "bytes":
                self.put("I", len(value))
                self.content += value
            elif kind in ("floats", "doubles"):
                self.put("I", len(value))
                if value:
                    self.put(kind[0], *value)
            else:
                self.put(kind, value)


def cdr(ros_type, fields):
    writer = Writer()
    if "header" in fields:
        writer.header(*fields["header"])
    writer.fields(DEFINITIONS[ros_type], fields)
    return b"\0\1\0\0" + bytes(writer.content)
