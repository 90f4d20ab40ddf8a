# SPDX-License-Identifier: BSD-3-Clause
"""The sensor messages of an LCM log as what ROS would have said of the same drive.

The log is read here anew (lcm-logger's format), and its messages by what lcm-gen writes for Python,
so that nothing of the code under test takes part.
"""
import pathlib
import struct
import subprocess
import sys

SYNC = 0xEDA1DA01
TYPES = {"SCAN": "scan_t", "IMAGE": "image_t", "ODOMETRY": "odometry_t", "IMU": "imu_t",
         "GNSS": "gnss_t", "POSE_FIX": "pose_fix_t"}
TOPICS = {"SCAN": "/front/scan", "IMAGE": "/camera/image_raw/compressed", "ODOMETRY": "/odom",
          "IMU": "/imu/data", "GNSS": "/gps/fix", "POSE_FIX": "/total_station"}
ROS_TYPES = {"SCAN": "sensor_msgs/LaserScan", "IMAGE": "sensor_msgs/CompressedImage",
             "ODOMETRY": "nav_msgs/Odometry", "IMU": "sensor_msgs/Imu",
             "GNSS": "sensor_msgs/NavSatFix",
             "POSE_FIX": "geometry_msgs/PoseWithCovarianceStamped"}


def types(source, folder):
    """The message types as Python modules, made by lcm-gen into `folder`."""
    files = [str(f) for f in pathlib.Path(source, "lcmtypes").glob("*.lcm")]
    subprocess.run(["lcm-gen", "--python", "--ppath", folder, *files], check=True)
    sys.path.insert(0, folder)
    import orchard  # noqa: E402  made just now

    return orchard


def events(path):
    with open(path, "rb") as log:
        while True:
            head = log.read(28)
            if len(head) < 28:
                return
            sync, _, _, channel_size, data_size = struct.unpack(">IqqII", head)
            assert sync == SYNC, "a damaged log"
            channel = log.read(channel_size).decode()
            yield channel, log.read(data_size)


def stamp(utime):
    return utime // 1_000_000, utime % 1_000_000 * 1000


def plane_covariance(c):
    """6 x 6 of a pose or twist, row by row, from (x, y, yaw): xx xy xyaw yy yyaw yawyaw."""
    full = [0.0] * 36
    for value, places in zip(c, ((0,), (1, 6), (5, 30), (7,), (11, 31), (35,))):
        for place in places:
            full[place] = value
    return full


def yaw_quaternion(yaw):
    import math

    return {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}


def as_ros(channel, m):
    """A message as ROS's fields, nested as ROS nests them; `header` is (utime, frame)."""
    if channel == "SCAN":
        n = m.num_ranges
        return {"header": (m.utime, "laser"), "angle_min": m.bearing_min_rad,
                "angle_max": m.bearing_min_rad + (n - 1) * m.bearing_step_rad,
                "angle_increment": m.bearing_step_rad, "time_increment": 1e-6 * m.beam_period_us,
                "scan_time": 0.0, "range_min": m.range_min_m, "range_max": m.range_max_m,
                "ranges": [float("inf") if r == 0.0 else r for r in m.ranges_m],
                "intensities": list(m.intensities)}
    if channel == "IMAGE":
        assert m.encoding == 0
        return {"header": (m.utime, "camera"), "format": "jpeg", "data": bytes(m.data)}
    if channel == "ODOMETRY":
        covariance = [0.0] * 36
        covariance[0], covariance[5], covariance[30], covariance[35] = (
            m.covariance[0], m.covariance[1], m.covariance[1], m.covariance[2])
        zero = {"x": 0.0, "y": 0.0, "z": 0.0}
        return {"header": (m.utime, "odom"), "child_frame_id": "base_link",
                "pose": {"pose": {"position": dict(zero), "orientation": yaw_quaternion(0.0)},
                         "covariance": [0.0] * 36},
                "twist": {"twist": {"linear": {"x": m.speed_mps, "y": 0.0, "z": 0.0},
                                    "angular": {"x": 0.0, "y": 0.0, "z": m.yaw_rate_radps}},
                          "covariance": covariance}}
    if channel == "IMU":
        def diagonal(value):
            return [value, 0, 0, 0, value, 0, 0, 0, value]

        assert not m.has_orientation
        rate, force = m.angular_rate_radps, m.acceleration_mps2
        return {"header": (m.utime, "base_link"),
                "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 0.0},
                "orientation_covariance": [-1.0] + [0.0] * 8,
                "angular_velocity": {"x": rate[0], "y": rate[1], "z": rate[2]},
                "angular_velocity_covariance": diagonal(m.angular_rate_variance),
                "linear_acceleration": {"x": force[0], "y": force[1], "z": force[2]},
                "linear_acceleration_covariance": diagonal(m.acceleration_variance)}
    if channel == "GNSS":
        c = m.covariance
        return {"header": (m.utime, "gps"),
                "status": {"status": {0: -1, 1: 0, 2: 1, 4: 2, 5: 2}[m.fix_quality], "service": 1},
                "latitude": m.latitude_deg, "longitude": m.longitude_deg, "altitude": m.altitude_m,
                "position_covariance": [c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]],
                "position_covariance_type": 3 if any(c) else 0}
    return {"header": (m.utime, "map"),
            "pose": {"pose": {"position": {"x": m.x_m, "y": m.y_m, "z": 0.0},
                              "orientation": yaw_quaternion(m.yaw_rad)},
                     "covariance": plane_covariance(m.covariance)}}


def read(source, log, folder):
    """(utime, channel, ROS fields) of every sensor message, in the log's order."""
    orchard = types(source, folder)
    messages = []
    for channel, data in events(log):
        if channel in TYPES:
            decoded = getattr(orchard, TYPES[channel]).decode(data)
            messages.append((decoded.utime, channel, as_ros(channel, decoded)))
    return messages
