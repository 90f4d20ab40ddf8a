#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What gpsd reported of real receivers, through the gpsd protocol, against gpsd_json(5) read anew.

gpsd_reports_test.py READ_RAW DATA   (77: no recordings)
Every fix is taken once, at rising times, with the quality and the covariance that gpsd states."""
import calendar
import glob
import gzip
import json
import math
import os
import sys
import time

from raw_bytes import START_US, Read

# gpsd_json(5), TPV status: unknown, normal, DGPS, RTK fixed, RTK float, DR, GNSS and DR, time, simulated, P(Y);
# NMEA 0183, GGA quality.
QUALITY = {None: 1, 0: 1, 1: 1, 2: 2, 3: 4, 4: 5, 5: 6, 6: 6, 7: 7, 8: 8, 9: 3}
RTK = (4, 5)
UNKNOWN_HEIGHT = 1e4


def seconds(text):
    whole, _, fraction = text.rstrip("Z").partition(".")
    return calendar.timegm(time.strptime(whole, "%Y-%m-%dT%H:%M:%S")) + float("0." + (fraction or "0"))


def of_ellipse(gst):
    if all(key in gst for key in ("major", "minor", "orient")) and gst["major"] > 0:
        angle = math.radians(gst["orient"])
        east, north = math.sin(angle), math.cos(angle)
        major, minor = gst["major"] ** 2, gst["minor"] ** 2
        return [major * east ** 2 + minor * north ** 2, (major - minor) * east * north, 0.0,
                major * north ** 2 + minor * east ** 2, 0.0]
    if gst.get("lat", 0) > 0 and gst.get("lon", 0) > 0:
        return [gst["lon"] ** 2, 0.0, 0.0, gst["lat"] ** 2, 0.0]
    return None


def covariance(tpv, gst):
    """ENU: ee en eu nn nu uu; the page of lib/device/gnss says which source is the best."""
    found = of_ellipse(gst) if gst else None
    if found:
        return found + [gst["alt"] ** 2 if gst.get("alt", 0) > 0 else UNKNOWN_HEIGHT]
    if tpv.get("eph", 0) > 0:
        east = north = tpv["eph"]
    elif tpv.get("epx", 0) > 0 and tpv.get("epy", 0) > 0:
        east, north = tpv["epx"], tpv["epy"]
    else:
        return [0.0] * 6
    if QUALITY[tpv.get("status")] in RTK and max(east, north) > 1.0:
        return [0.0] * 6
    up = tpv["epv"] ** 2 if tpv["mode"] == 3 and tpv.get("epv", 0) > 0 else UNKNOWN_HEIGHT
    return [east ** 2, 0.0, 0.0, north ** 2, 0.0, up]


def epochs(reports):
    """Per time of a fix: its reports, each with the noise known by then."""
    found, gst, gst_status, status = [], None, None, None
    for report in reports:
        if report["class"] == "GST":
            gst, gst_status = report, status
        if report["class"] != "TPV":
            continue
        status = report.get("status")
        if report.get("mode", 0) < 2 or "lat" not in report or "lon" not in report or "time" not in report:
            continue
        noise = None
        if gst and "time" in gst:
            age = seconds(report["time"]) - seconds(gst["time"])
            noise = gst if age == 0 or (0 < age <= 1.5 and gst_status == status) else None
        if not found or found[-1][0][0]["time"] != report["time"]:
            found.append([])
        found[-1].append((report, noise))
    return found


def fix_of(report, noise):
    """Place, quality and covariance as one report states them."""
    cov = covariance(report, noise)
    if "altHAE" not in report and cov[0] > 0:
        cov[5] = UNKNOWN_HEIGHT
    return [report["lat"], report["lon"], report.get("altHAE", 0.0), QUALITY[report.get("status")], *cov]


def states(epoch, key):
    return any(key in report for report, _ in epoch)


def check(program, path, failures):
    name = os.path.basename(path)[:-len(".json.gz")]
    lines = [line for line in gzip.open(path, "rt", errors="replace").read().splitlines() if line.startswith("{")]
    reports = [json.loads(line) for line in lines]
    events, now, first = [(0.0, "C", b"")], 0.0, None
    for line, report in zip(lines, reports):
        if report["class"] == "TPV" and "time" in report:
            first = first if first is not None else seconds(report["time"])
            ahead = seconds(report["time"]) - first + 0.1
            now = ahead if 0.0 < ahead - now < 60.0 else now + 0.01  # a receiver's time may leap
        events.append((now, "R", line.encode() + b"\r\n"))
    read = Read(program, "gpsd", events)
    expected = epochs(reports)

    def expect(what, is_so):
        if not is_so:
            failures.append(f"{name}: {what}")

    expect(f"{read.num_bad} of {len(lines)} reports refused: {read.text}", read.num_bad == 0)
    # The last one may still wait for its height or status.
    expect(f"{len(read.fixes)} fixes, expected {len(expected)}", len(expected) - 1 <= len(read.fixes) <= len(expected))
    utimes = [fix[0] for fix in read.fixes]
    expect("times rise", all(a < b for a, b in zip(utimes, utimes[1:])))
    before = []
    for number, (fix, epoch) in enumerate(zip(read.fixes, expected)):
        stated = [fix_of(report, noise) for report, noise in epoch]
        expect(f"fix {number}: {fix[1:]} is none of {stated}", any(
            all(abs(a - b) <= 1e-6 * max(1.0, abs(b)) for a, b in zip(fix[1:], one)) for one in stated))
        if number > 0 and states(epoch, "altHAE"):  # the first may be of mode 2
            expect(f"fix {number}: without its height", fix[3] != 0.0)
        # After the first fix it is known that a status comes, if not with the first report.
        if states(epoch, "status") and states(before, "status"):
            statuses = [QUALITY[report["status"]] for report, _ in epoch if "status" in report]
            expect(f"fix {number}: quality {fix[4]}, stated {statuses}", fix[4] in statuses)
        before = epoch
    qualities = sorted({int(fix[4]) for fix in read.fixes})
    sds = [math.sqrt(max(fix[5], fix[8])) for fix in read.fixes if fix[5] > 0]
    said = f"{min(sds):.3g} to {max(sds):.3g} m" if sds else "-"
    print(f"{name}: {len(read.fixes)} fixes of {len(lines)} reports, quality {qualities}, sd {said}, "
          f"{len(read.fixes) - len(sds)} without")
    return len(read.fixes)


def main():
    program, data = sys.argv[1:]
    paths = sorted(glob.glob(os.path.join(data, "gpsd_reports", "*.json.gz")))
    if not paths:
        print(f"skipped: no gpsd_reports in {data}")
        return 77
    failures = []
    num = sum(check(program, path, failures) for path in paths)
    print(f"{len(paths)} receivers, {num} fixes")
    for failure in failures[:40]:
        print(f"FAILED: {failure}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
