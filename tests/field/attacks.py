# SPDX-License-Identifier: BSD-3-Clause
"""What a stranger on the network may send, by name: each a function (sender, random, sample).

sample: {channel: bytes} of real messages. Names of LCM's own weakness end in "(upstream)".
"""
import math
import random as randomness
import struct
import time

import wire

FAR_utime = 7258118399999999  # the last microsecond that a message may carry: the year 2199
INT32_MOST = 2**31 - 1
DAY_us = 86_400_000_000


def paced(sender, packets, pause_every=50):
    """Sent so that a receiver sees them, not its socket buffer drops them."""
    for number, packet in enumerate(packets):
        sender.raw(packet)
        if number % pause_every == pause_every - 1:
            time.sleep(0.002)


def typed_bombs(sender, random, sample):
    """The right hash and a huge or negative count, and nothing behind it."""
    counts = (0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x10000000, 0x00FFFFFF)
    paced(sender, [wire.short_datagram(channel, data[:20] + struct.pack(">I", count) * size)
                   for channel, data in sample.items() for count in counts for size in (1, 2, 12)])


def runts(sender, random, sample):
    """Packets that are shorter than their own header."""
    packets = []
    for size in range(0, 28):
        for magic in (b"LC02", b"LC03", b""):
            packets.append((magic + bytes(random.randrange(256) for _ in range(size)))[:size])
    paced(sender, packets * 20)


def duplicate_fragments(sender, random, sample):
    """Fragments that come twice and thrice: holes where the others should be."""
    data = sample["SCAN"]
    half = len(data) // 2
    packets = []
    for number in range(200):
        first = wire.fragment(number, len(data), 0, 0, 2, data[:half], b"SCAN")
        packets += [first, first, first]
        second = wire.fragment(number + 1000, len(data), half, 1, 2, data[half:])
        packets += [second, second]
    paced(sender, packets)


def false_sizes(sender, random, sample):
    """First fragments that claim gigabytes, and counts of parts that are not there."""
    packets = []
    for number in range(300):
        size = random.choice((0, 1, 0x7FFFFFFF, 0xFFFFFFFF, 0x80000000, 1 << 24, (1 << 24) + 1))
        packets.append(wire.fragment(number, size, 0, 0, random.choice((0, 1, 2, 65535)),
                                     sample["SCAN"][:500], b"SCAN"))
    paced(sender, packets)


def offset_wrap(sender, random, sample):
    """An offset that wraps when the length is added (LCM pull request 628)."""
    for number in range(8):
        sender.raw(wire.fragment(900 + number, 3000, 0, 0, 3, b"x" * 900, b"SCAN"))
        sender.raw(wire.fragment(900 + number, 3000, 0xFFFFFFF0, 1, 3, b"y" * 900))


def late_sizes(sender, random, sample):
    """A second fragment whose size is another than the first one's."""
    for number in range(8):
        sender.raw(wire.fragment(700 + number, 3000, 0, 0, 3, b"x" * 900, b"SCAN"))
        sender.raw(wire.fragment(700 + number, 60000, 50000, 1, 3, b"y" * 900))
        sender.raw(wire.fragment(700 + number, 3000, 2999, 2, 3, b"z" * 900))


def nameless(sender, random, sample):
    """Channel names without an end, too long, empty, of control characters."""
    packets = [struct.pack(">II", wire.SHORT, 1) + b"A" * size for size in (1, 63, 64, 65, 300, 1400)]
    packets += [wire.short_datagram(name, sample["SCAN"]) for name in
                (b"", b"\x1b[2J", b"A" * 63, b"A" * 64, b"A" * 300, b"SCAN\xff", b".*")]
    paced(sender, packets * 20)


def random_packets(sender, random, sample, num=100_000):
    """Noise: bytes at random, real messages with some bytes changed, cut or longer."""
    channels = sorted(sample)
    noise = randomness.Random(random.random())

    def packets():
        for number in range(num):
            kind = number % 4
            if kind == 0:
                yield noise.randbytes(noise.randrange(0, 600))
                continue
            channel = noise.choice(channels)
            data = bytearray(sample[channel][:1400])
            if kind == 1:
                for _ in range(noise.randrange(1, 6)):
                    data[noise.randrange(len(data))] = noise.randrange(256)
            elif kind == 2:
                data = data[:noise.randrange(len(data))]
            else:
                head = struct.pack(">IIIIHH", wire.LONG, noise.randrange(4), noise.randrange(5000),
                                   noise.randrange(5000), noise.randrange(3), noise.randrange(4))
                yield head + b"SCAN\0" + bytes(data)
                continue
            yield wire.short_datagram(channel, bytes(data), number)

    paced(sender, packets(), 100)


def half_a_minute(sender, random, sample):
    """One whole message of each kind from half a minute ahead."""
    for channel, data in sample.items():
        utime, seq = wire.stamp(data)
        sender.send(channel, wire.restamped(data, utime + 30_000_000, seq + 1))
        time.sleep(0.05)


def far_future(sender, random, sample):
    """One whole message of each kind with the last time and number there are."""
    for channel, data in sample.items():
        sender.send(channel, wire.restamped(data, FAR_utime, INT32_MOST))
        time.sleep(0.05)


def tomorrow(sender, random, sample):
    """One whole message of each kind from tomorrow."""
    for channel, data in sample.items():
        utime, seq = wire.stamp(data)
        sender.send(channel, wire.restamped(data, utime + DAY_us, seq + 1))
        time.sleep(0.05)


def altered(channel, data, change):
    kinds = {"SCAN": "scan_t", "ODOMETRY": "odometry_t", "POSE_FIX": "pose_fix_t", "POSE": "pose_t",
             "DETECTIONS": "detections_v2_t", "GNSS": "gnss_t"}
    message = getattr(wire.types, kinds[channel]).decode(data)
    message.utime += 1000
    message.seq += 1
    change(message)
    return message.encode()


def set_all(*names, to):
    def change(message):
        for name in names:
            value = getattr(message, name)
            setattr(message, name, [to] * len(value) if isinstance(value, (list, tuple)) else to)
    return change


def not_numbers(sender, random, sample):
    """NaN, infinities and 1e300 wherever a number stands."""
    for value in (math.nan, math.inf, -math.inf, 1e300, -1e300):
        fields = {"SCAN": ("bearing_min_rad", "bearing_step_rad", "beam_period_us", "range_max_m"),
                  "ODOMETRY": ("speed_mps", "yaw_rate_radps"), "POSE_FIX": ("x_m", "y_m", "yaw_rad", "covariance"),
                  "POSE": ("x_m", "y_m", "yaw_rad", "covariance"), "GNSS": ("latitude_deg", "longitude_deg")}
        for channel, names in fields.items():
            for name in names:
                try:
                    sender.send(channel, altered(channel, sample[channel], set_all(name, to=value)))
                except (AttributeError, struct.error):
                    continue
        time.sleep(0.02)


def turned_pose(sender, random, sample):
    """A pose whose heading is 1e300 and one of 1e15 turns."""
    for value in (1e300, -1e300, 1e16):
        for channel in ("POSE", "POSE_FIX"):
            sender.send(channel, altered(channel, sample[channel], set_all("yaw_rad", to=value)))
        time.sleep(0.02)


def million_points(sender, random, sample):
    """A corrected past of a million points, in pages, and one of 2^31 - 1 pages."""
    point = wire.types.trajectory_pose_t()
    point.covariance = [1e-4, 0, 0, 1e-4, 0, 1e-4]
    utime, _ = wire.stamp(sample["POSE"])
    per_page, num_pages = 500, 2000
    for page in range(num_pages):
        message = wire.types.trajectory_t()
        message.utime, message.seq = utime, page
        message.revision, message.page, message.num_pages = 1, page, num_pages
        message.poses = []
        for number in range(per_page):
            copy = wire.types.trajectory_pose_t()
            copy.utime = utime - (num_pages - page) * per_page + number
            copy.covariance = point.covariance
            message.poses.append(copy)
        message.num_poses = per_page
        if page == 0:
            for pages in (INT32_MOST, -INT32_MOST - 1, 0, -1):
                message.num_pages = pages
                sender.send("TRAJECTORY", message.encode())
            message.num_pages = num_pages
        if page < 20 or page % 10 == 0:
            template = message.encode()
        sender.send("TRAJECTORY", template)
        time.sleep(0.0005)


def foreign_config(sender, random, sample):
    """Configurations of nobody, of 60 kB, with escape codes; STATUS of the same kind."""
    for number in range(200):
        config = wire.types.config_t()
        config.utime, config.seq, config.hash = 1, number, random.getrandbits(60)
        config.name = "orchard-detector" if number % 2 else "\x1b[2J\x1b]0;stranger\x07" + "n" * 500
        config.version, config.text = "9", "lcm:\n  url: \x1b[31m\n" * 1500
        sender.send("CONFIG", config.encode())
        status = wire.types.status_t()
        status.seq, status.name, status.host = number, f"orchard-nobody-{number}", "\x1b[2J" + "h" * 900
        status.text = "\x1b]0;stranger\x07" * 50
        sender.send("STATUS", status.encode())
        time.sleep(0.002)


def flood(sender, random, sample):
    """Real detections and scans as fast as they can be sent, for three seconds."""
    end, number = time.monotonic() + 3.0, 0
    detections = sample["DETECTIONS"]
    utime, seq = wire.stamp(detections)
    while time.monotonic() < end:
        number += 1
        sender.send("DETECTIONS", wire.restamped(detections, utime + number, seq + number))


ATTACKS = (typed_bombs, runts, duplicate_fragments, false_sizes, nameless, late_sizes,
           random_packets, foreign_config, not_numbers, turned_pose, million_points, half_a_minute,
           tomorrow, far_future, flood, offset_wrap)
