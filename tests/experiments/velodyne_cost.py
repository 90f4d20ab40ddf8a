#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What does orchard-laser-driver cost with a VLP-16 at 600 rpm, as a share of a core?

Sends 15 s of packets to it by UDP, of one return and of two; in a network namespace, so that nothing else listens:
  unshare -rn sh -c 'ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo; exec tests/experiments/velodyne_cost.py'
Needs a build in build/ (or BUILD=folder).
"""
import os
import pathlib
import signal
import socket
import struct
import subprocess
import tempfile
import time

TREE = pathlib.Path(__file__).resolve().parents[2]
DRIVER = pathlib.Path(os.environ.get("BUILD", TREE / "build")) / "bin/orchard-laser-driver"
PORT = 23680
SECONDS = 15.0
FIRING_S = 55.296e-6


def packet(number, is_dual):
    """Datagram `number` of a scanner in a round room, by the user manual of the VLP-16."""
    columns = 6 if is_dual else 12
    begin_s = number * columns * 2 * FIRING_S
    shots = b"".join(struct.pack("<HB", 1500 + 7 * i, 30) for i in range(32))
    data = b""
    for block in range(12):
        column = block // 2 if is_dual else block
        azimuth_cdeg = round(100 * 3600 * (begin_s + column * 2 * FIRING_S)) % 36000
        data += struct.pack("<HH", 0xEEFF, azimuth_cdeg) + shots
    return data + struct.pack("<IBB", round(1e6 * begin_s), 0x39 if is_dual else 0x37, 0x22)


def send(is_dual):
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    period_s = (12 if is_dual else 24) * FIRING_S
    begin = time.monotonic()
    for number in range(int(SECONDS / period_s)):
        time.sleep(max(0.0, begin + number * period_s - time.monotonic()))
        sender.sendto(packet(number, is_dual), ("127.0.0.1", PORT))


def share(is_dual):
    with tempfile.TemporaryDirectory() as folder:
        rig = pathlib.Path(folder) / "rig.yaml"
        rig.write_text(f"drivers:\n  laser:\n    device: udp:{PORT}\n    protocol: velodyne\n"
                       "    scanner_height_m: 1.0\n", encoding="utf-8")
        driver = subprocess.Popen([DRIVER, "--config", rig, "--lcm-url", "udpm://239.255.76.67:7667?ttl=0"],
                                  stderr=subprocess.DEVNULL)
        time.sleep(0.5)
        send(is_dual)
        driver.send_signal(signal.SIGINT)
        _, status, used = os.wait4(driver.pid, 0)
        assert status == 0, status
        return (used.ru_utime + used.ru_stime) / SECONDS


for returns, is_dual in (("one return", False), ("two returns", True)):
    print(f"{returns}: {100 * share(is_dual):.1f} % of a core")
