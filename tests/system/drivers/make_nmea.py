#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A receiver's sentences: RTK fixed for 20 s, then float, 5 per second: make_nmea.py >FILE."""


def sentence(body):
    total = 0
    for byte in body.encode():
        total ^= byte
    return f"${body}*{total:02X}\r\n"


for i in range(200):
    time = f"10{20 + i // 300:02d}{i // 5 % 60:02d}.{i % 5 * 2:d}0"
    quality = 4 if i < 100 else 5
    place = "3224.000000,S,07118.000000,W"
    print(sentence(f"GNRMC,{time},A,{place},0.5,90.0,040526,,,R"), end="")
    print(sentence(f"GNGGA,{time},{place},{quality},18,0.7,41.5,M,25.0,M,1.0,0001"), end="")
    print(sentence(f"GNGST,{time},0.9,,,,0.012,0.016,0.025"), end="")
