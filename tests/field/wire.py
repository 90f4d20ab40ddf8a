# SPDX-License-Identifier: BSD-3-Clause
"""LCM on the wire and in a log, written from LCM's published formats: no LCM library is needed."""
import os
import select
import socket
import struct
import sys
import time

from hosts import in_thread

IPPROTO_IP, IP_MULTICAST_TTL = socket.IPPROTO_IP, socket.IP_MULTICAST_TTL
GROUP, PORT = "239.255.76.67", 7667
SHORT, LONG = 0x4C433032, 0x4C433033  # "LC02", "LC03"
LOG_MAGIC = 0xEDA1DA01
SOURCES = ("SCAN", "IMAGE", "ODOMETRY", "GNSS", "IMU", "POSE_FIX")
types = None  # the module of generated types, once load_types() has found it


def load_types(build):
    """The classes that lcm-gen made in a build folder."""
    global types
    sys.path.insert(0, os.path.join(build, "lcmtypes", "python"))
    import orchard
    types = orchard
    return orchard


def short_datagram(channel, data, number=0):
    name = channel if isinstance(channel, bytes) else channel.encode()
    return struct.pack(">II", SHORT, number & 0xFFFFFFFF) + name + b"\0" + data


def fragment(number, size, offset, index, count, data, channel=None):
    head = struct.pack(">IIIIHH", LONG, number & 0xFFFFFFFF, size & 0xFFFFFFFF,
                       offset & 0xFFFFFFFF, index & 0xFFFF, count & 0xFFFF)
    return head + (channel + b"\0" if channel is not None else b"") + data


def udp_socket(host):
    with host.network():
        return socket.socket(socket.AF_INET, socket.SOCK_DGRAM)


class Sender:
    """Publishes on a host, as a process there would."""

    def __init__(self, host, ttl=1, socket=None, port=PORT):
        self.port = port
        self.socket = socket or udp_socket(host)
        self.socket.setsockopt(IPPROTO_IP, IP_MULTICAST_TTL, ttl)
        self.number = 0

    def raw(self, datagram):
        try:
            self.socket.sendto(datagram, (GROUP, self.port))
        except OSError:
            return False
        return True

    def send(self, channel, data):
        self.number += 1
        if len(data) + len(channel) < 60000:
            return self.raw(short_datagram(channel, data, self.number))
        name, size, chunk = channel.encode(), len(data), 60000
        offsets = [0, *range(chunk - len(name) - 1, size, chunk)]
        for index, offset in enumerate(offsets):
            end = offsets[index + 1] if index + 1 < len(offsets) else size
            self.raw(fragment(self.number, size, offset, index, len(offsets), data[offset:end],
                              name if index == 0 else None))
            time.sleep(0.0003)
        return True


class Listener:
    """Keeps every STATUS that a host hears with the time of its arrival, and counts every channel."""

    def __init__(self, host, keep=("STATUS",)):
        with host.network():
            self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
            self.socket.bind((GROUP, PORT))
            self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                                   struct.pack("4sII", socket.inet_aton(GROUP), 0, 0)[:8])
        self.keep, self.count, self.last, self.messages = keep, {}, {}, []
        self.stopped = False
        self.thread = in_thread(self.listen)

    def listen(self):
        while not self.stopped:
            if not select.select([self.socket], [], [], 0.2)[0]:
                continue
            packet = self.socket.recv(70000)
            arrival = time.monotonic()
            if packet[:4] != b"LC02" or b"\0" not in packet[8:80]:
                continue
            name, data = packet[8:].split(b"\0", 1)
            channel = name.decode("latin1")
            self.count[channel] = self.count.get(channel, 0) + 1
            self.last[channel] = arrival
            if channel in self.keep:
                self.messages.append((arrival, channel, data))

    def statuses(self, name=None, since=0.0):
        """[(arrival, status)] of the generated types, oldest first; what cannot be read is left out."""
        found = []
        for arrival, channel, data in list(self.messages):
            if channel != "STATUS" or arrival < since:
                continue
            for kind in [k for k in dir(types) if k.startswith("status_") and k.endswith("_t")]:
                try:
                    status = getattr(types, kind).decode(data)
                except (ValueError, struct.error, UnicodeDecodeError):
                    continue
                if name is None or status.name == name:
                    found.append((arrival, status))
                break
        return found

    def wait(self, condition, seconds):
        """The first STATUS of which condition(status) holds within a time, with its arrival, or None."""
        end, seen = time.monotonic() + seconds, 0
        while time.monotonic() < end:
            messages = self.statuses()
            for arrival, status in messages[seen:]:
                if condition(status):
                    return arrival, status
            seen = len(messages)
            time.sleep(0.02)
        return None

    def close(self):
        self.stopped = True
        self.thread.join()
        self.socket.close()


def read_log(path):
    """[(utime of arrival, channel, bytes)] of a log of lcm-logger; ends where the file is cut."""
    with open(path, "rb") as file:
        content = file.read()
    events, at = [], 0
    while at + 28 <= len(content):
        magic, _, utime, name, size = struct.unpack(">IqqII", content[at:at + 28])
        if magic != LOG_MAGIC or at + 28 + name + size > len(content):
            break
        begin = at + 28 + name
        events.append((utime, content[at + 28:begin].decode("latin1"), content[begin:begin + size]))
        at = begin + size
    return events


def each_event(path):
    """The same as read_log(), one at a time: for logs larger than memory."""
    with open(path, "rb") as file:
        while len(head := file.read(28)) == 28:
            _, _, utime, name, size = struct.unpack(">IqqII", head)
            channel = file.read(name).decode("latin1")
            yield utime, channel, file.read(size)


def write_log(path, events):
    with open(path, "wb") as file:
        for number, (utime, channel, data) in enumerate(events):
            name = channel.encode("latin1")
            file.write(struct.pack(">IqqII", LOG_MAGIC, number, utime, len(name), len(data)))
            file.write(name + data)


def stamp(data):
    """(utime, seq) of a message: every type begins with its hash and these two."""
    return struct.unpack(">qi", data[8:20])


def restamped(data, utime=None, seq=None):
    old_utime, old_seq = stamp(data)
    return (data[:8] + struct.pack(">qi", old_utime if utime is None else utime,
                                   old_seq if seq is None else seq) + data[20:])


def per_channel(events):
    count = {}
    for _, channel, _ in events:
        count[channel] = count.get(channel, 0) + 1
    return count
