#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Sends SCAN at 10 Hz and ODOMETRY at 50 Hz from anything that measures, without python3-lcm.

   lcm-gen --python lcmtypes/scan_t.lcm lcmtypes/odometry_t.lcm
   python3 send.py
"""
import socket
import struct
import time

from orchard import odometry_t, scan_t  # what lcm-gen made; the package has it, too

link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
link.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)  # this machine only
sent = 0


def publish(channel, message):
    """One LCM datagram: "LC02", a number, the channel's name, the message; below 65 kB."""
    global sent
    head = struct.pack(">4sI", b"LC02", sent) + channel.encode() + b"\0"
    link.sendto(head + message.encode(), ("239.255.76.67", 7667))
    sent = (sent + 1) % 2**32


scan = scan_t()  # a post of 10 cm, 2 m ahead; here the scanner's bytes would be read
scan.bearing_min_rad, scan.bearing_step_rad = -1.5, 0.01
scan.range_min_m, scan.range_max_m = 0.1, 30.0
scan.ranges_m = [1.95 + 0.01 * abs(i - 150) if abs(i - 150) <= 2 else 0.0 for i in range(301)]
scan.num_ranges = len(scan.ranges_m)  # 0: no return; beam_period_us stays 0, unknown
odometry = odometry_t()  # its covariance stays 0, unknown
while True:
    odometry.utime = time.time_ns() // 1000  # when it was measured, not when it is sent
    odometry.speed_mps, odometry.yaw_rate_radps = 0.5, 0.0
    publish("ODOMETRY", odometry)
    if odometry.seq % 5 == 0:
        scan.utime = time.time_ns() // 1000  # of the first beam
        publish("SCAN", scan)
        scan.seq += 1
    odometry.seq += 1  # +1 per message: gaps are counted as lost
    time.sleep(0.02)
