#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What real SICK scanners sent, in CoLa-A and CoLa-B, against a decoder of its own.

sick_captures_test.py READ_RAW DATA   (77: no recordings)
The decoder below is written from the manufacturer's telegram listing (8014631) and shares nothing with
lib/device/cola. The dialogue before the sweeps is the scanner's own where the capture has it."""
import gzip
import json
import math
import os
import struct
import sys

from raw_bytes import Read

CAPTURES = {  # name: file of CoLa-B, sweep [degrees], motor [Hz], beams, has intensities
    "lms111": ("20210302_lms111.pcapng.json.gz", 270.0, 50.0, 541, False),
    "tim781s": ("20210125-tim781s-scandata.pcapng.json.gz", 270.0, 15.0, 811, True),
}
NUM_SENT_AGAIN = {"lms111": 3, "tim781s": 0}


def in_frame(content):
    """A telegram of CoLa-B."""
    total = 0
    for byte in content:
        total ^= byte
    return b"\2\2\2\2" + struct.pack(">I", len(content)) + content + bytes([total])


def decoded_binary(content):
    """Times, angles and values of a telegram of CoLa-B."""
    at = len(b"sSN LMDscandata ")

    def take(form):
        nonlocal at
        values = struct.unpack_from(">" + form, content, at)
        at += struct.calcsize(">" + form)
        return values if len(values) > 1 else values[0]

    _, _, _, _, status, number, _, start_us, sent_us = take("HHIBBHHII")
    take("4BH")
    rate_hz = take("II")[0] / 100
    for _ in range(take("H")):
        take("IH")
    channels = {}
    for letter in "HB":
        for _ in range(take("H")):
            name = take("5s").decode()
            scale, offset, first, step, num = take("ffiHH")
            channels[name] = (scale, offset, first, step, list(take(f"{num}{letter}")))
    return number, start_us, sent_us, status, rate_hz, channels


def decoded_text(line):
    """The same of a telegram of CoLa-A."""
    words = iter(line.split(" ")[2:])

    def whole(num=1):
        values = [int(next(words), 16) for _ in range(num)]
        return values if num > 1 else values[0]

    def real():
        return struct.unpack(">f", bytes.fromhex(next(words).zfill(8)))[0]

    _, _, _, _, status, number, _, start_us, sent_us = whole(9)
    whole(5)
    rate_hz = whole(2)[0] / 100
    for _ in range(whole()):
        whole(2)
    channels = {}
    for _ in range(2):
        for _ in range(whole()):
            name, scale, offset = next(words), real(), real()
            first = struct.unpack(">i", struct.pack(">I", whole()))[0]
            step, num = whole(2)
            channels[name] = (scale, offset, first, step, whole(num))
    return number, start_us, sent_us, status, rate_hz, channels


def captured(data, name):
    """(seconds, content) of each telegram of a capture in CoLa-B, and (seconds, line) of the same in CoLa-A."""
    folder = os.path.join(data, "sick_captures")
    with gzip.open(os.path.join(folder, "cola_b", CAPTURES[name][0])) as file:
        packets = [packet["_source"]["layers"]["tcp"] for packet in json.load(file)]
    binary = [(float(p["Timestamps"]["tcp.time_relative"]), bytes.fromhex(p["tcp.payload"].replace(":", "")))
              for p in packets]
    with gzip.open(os.path.join(folder, "cola_a", f"{name}_transcoded.txt.gz"), "rt") as file:
        text = [line.rstrip("\n").split(" ", 1) for line in file]
    return binary, [(float(seconds), line) for seconds, line in text]


def dialogue(is_binary, output_range):
    """The scanner's side until it streams; a scanner that speaks CoLa-B answers to the second request."""
    begin = 0.51 if is_binary else 0.0
    name = "none"
    if is_binary:
        answers = [b"sEA LMDscandata \0", b"sRA DeviceIdent \0\4" + name.encode() + b"\0\1V", output_range,
                   b"sAN SetAccessMode \1", b"sWA LMDscandatacfg ", b"sAN Run \1", b"sEA LMDscandata \1"]
        frames = [in_frame(answer) for answer in answers]
    else:
        angles = struct.unpack(">HIII", output_range[len(b"sRA LMPoutputRange "):])
        texts = ["sEA LMDscandata 0", f"sRA DeviceIdent 4 {name} 1 V",
                 "sRA LMPoutputRange " + " ".join(f"{angle:X}" for angle in angles), "sAN SetAccessMode 1",
                 "sWA LMDscandatacfg", "sAN Run 1", "sEA LMDscandata 1"]
        frames = [b"\2" + text.encode() + b"\3" for text in texts]
    return [(0.0, "C", b""), (begin, "S", b"")] + [(begin + 0.01 * i, "R", f) for i, f in enumerate(frames)]


def check(program, data, name, failures):
    file, sweep_deg, rate_hz, num_beams, has_intensities = CAPTURES[name]
    binary, text = captured(data, name)
    output_range = next(b[8:-1] for _, b in binary if b[8:].startswith(b"sRA LMPoutputRange "))
    sweeps = [(t, b) for t, b in binary if b[8:].startswith(b"sSN LMDscandata ")]
    truth = [decoded_binary(b[8:-1]) for _, b in sweeps]

    def expect(what, is_so):
        if not is_so:
            failures.append(f"{name}: {what}")

    expect("the two dialects hold the same", [decoded_text(line) for _, line in text] == truth)
    expect("checksums", all(in_frame(b[8:-1]) == b for _, b in binary))
    once = [i for i in range(len(truth)) if i == 0 or truth[i][:2] != truth[i - 1][:2]]
    expect(f"{NUM_SENT_AGAIN[name]} come twice", len(truth) - len(once) == NUM_SENT_AGAIN[name])
    seconds_of_sweep = sweep_deg / 360.0 / rate_hz

    begin = sweeps[0][0] - 1.0  # the dialogue is over by then
    reads = {
        "CoLa-B": Read(program, "cola", dialogue(True, output_range) +
                       [(t - begin, "R", b) for t, b in binary if t >= sweeps[0][0]]),
        "CoLa-A": Read(program, "cola", dialogue(False, output_range) +
                       [(t - begin, "R", b"\2" + line.encode() + b"\3") for t, line in text]),
    }
    for dialect, read in reads.items():
        expect(f"{dialect}: {len(read.scans)} scans, {read.num_bad} refused",
               len(read.scans) == len(once) and read.num_bad == 0)
        expect(f"{dialect} in STATUS: {read.text}",
               read.level == 0 and read.text.startswith(dialect) and "transmission minus the sweep" in read.text)
        for i, scan in zip(once, read.scans):
            _, start_us, sent_us, _, truth_hz, channels = truth[i]
            scale, offset, first, step, values = channels["DIST1"]
            expect("motor", truth_hz == rate_hz)
            expect("sent sooner after its stamp than it lasts", 1e-6 * (sent_us - start_us) < seconds_of_sweep / 2)
            expect(f"{dialect} sweep {i}: beams", len(scan.ranges_m) == num_beams == len(values))
            ranges_m = [(scale * v + offset) / 1000 for v in values]
            expect(f"{dialect} sweep {i}: ranges", all(
                abs(a - (r if 0.01 <= r <= 65.0 else 0.0)) < 1e-6 for a, r in zip(scan.ranges_m, ranges_m)))
            expect(f"{dialect} sweep {i}: intensities", scan.intensities == (
                [float(v) for v in channels["RSSI1"][4]] if has_intensities else []))
            # 270 degrees from 45 degrees behind the right: by the data sheet, not by the rounded step.
            expect(f"{dialect} sweep {i}: bearings",
                   abs(math.degrees(scan.bearing_min_rad) + 135.0) < 1e-3 and
                   abs(math.degrees(scan.bearing_step_rad) * (num_beams - 1) - sweep_deg) < 1e-3)
            expect(f"{dialect} sweep {i}: time between beams",
                   abs(1e-6 * scan.beam_period_us * (num_beams - 1) - seconds_of_sweep) < 1e-5)
            # What was sent has been measured; the network of the capture delays by a few milliseconds.
            last_beam = scan.seconds + 1e-6 * scan.beam_period_us * (num_beams - 1)
            late_ms = 1e3 * (sweeps[i][0] - begin - last_beam)
            expect(f"{dialect} sweep {i}: measured {late_ms:.1f} ms before it arrived", -0.5 < late_ms < 20.0)
    expect("both dialects give the same ranges",
           [s.ranges_m for s in reads["CoLa-A"].scans] == [s.ranges_m for s in reads["CoLa-B"].scans])

    # Of every tenth telegram one bit is wrong: the others come, and each is counted.
    damaged, num_damaged = [], 0
    for number, (t, b) in enumerate(sweeps):
        if number % 10 == 5:
            place = (number * 7919) % len(b)
            b = b[:place] + bytes([b[place] ^ (1 << number % 8)]) + b[place + 1:]
            num_damaged += 1
        damaged.append((t - begin, "R", b))
    read = Read(program, "cola", dialogue(True, output_range) + damaged)
    expect(f"damaged: {len(read.scans)} scans, {read.num_bad} of {num_damaged} counted",
           len(once) - num_damaged <= len(read.scans) < len(once) and num_damaged <= read.num_bad <= 2 * num_damaged)
    expect(f"damaged: {read.level} {read.text}", read.level == 2 and "refused in 10 s" in read.text)
    true_ranges = {tuple(scan.ranges_m) for scan in reads["CoLa-B"].scans}
    expect("damaged: every scan is one that was sent", all(tuple(s.ranges_m) in true_ranges for s in read.scans))
    print(f"{name}: {len(once)} scans of {num_beams} beams in both dialects, {len(truth) - len(once)} sent twice; "
          f"of {num_damaged} damaged {read.num_bad} counted")


def main():
    program, data = sys.argv[1:]
    if not os.path.isdir(os.path.join(data, "sick_captures")):
        print(f"skipped: no sick_captures in {data}")
        return 77
    failures = []
    for name in CAPTURES:
        check(program, data, name, failures)
    for failure in failures[:20]:
        print(f"FAILED: {failure}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
