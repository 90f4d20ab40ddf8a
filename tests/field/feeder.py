# SPDX-License-Identifier: BSD-3-Clause
"""feeder.py LOG BEGIN SPEED CHANNELS: a driver that plays a log's channels by the clock.

Started again it goes on where the drive has come to meanwhile, with seq from 0, as a real driver
does. BEGIN is the time.monotonic() of the log's first message; it runs in the network of its caller.
"""
import socket
import sys
import time

import wire


def main():
    path, begin, speed, channels = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
    wanted = set(channels.split(","))
    events = [(wire.stamp(data)[0], channel, data) for _, channel, data in wire.read_log(path)
              if channel in wanted]
    sender = wire.Sender(None, socket=socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    first, numbers = events[0][0], {}
    for utime, channel, data in events:
        due = begin + (utime - first) / 1e6 / speed
        wait = due - time.monotonic()
        if wait < -0.05:
            continue
        if wait > 0:
            time.sleep(wait)
        numbers[channel] = numbers.get(channel, -1) + 1
        sender.send(channel, wire.restamped(data, seq=numbers[channel]))
    time.sleep(1e6)


main()
