#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Is every way of a map's graph.json free? check_ways.py MAP [--truth CSV] [--recording FOLDER]

Each way keeps 0.3 m from every landmark's rim, and half of its width_m is no more than that distance.
With the truth of a simulation it keeps off whatever stands there, mapped or not. With the recording's
folder every half metre of it was crossed by a beam that went on, or lies where the robot drove.
Prints one line; exit code 1 where a way is not free."""
import argparse, bisect, csv, gzip, json, math, os, sys

RIM_M = 0.3
ROUNDED_M = 0.02  # the line's corners have millimetres, the tried lines are 0.1 m apart
TRUTH_M = 0.2     # a landmark is a few centimetres off, and a bush reaches beyond what scans meet


def to_piece_m(p, a, b):
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / max(1e-12, dx * dx + dy * dy)
    t = max(0.0, min(1.0, t))
    return math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy)


def to_line_m(p, line):
    return min(to_piece_m(p, line[i - 1], line[i]) for i in range(1, len(line)))


def things(path):
    """Centres and radii of what a table of landmarks or a truth holds; of hedges discs along them."""
    found = []
    for row in csv.DictReader(open(path)):
        x_m, y_m, width_m = (float(row[k]) for k in ('x_m', 'y_m', 'width_m'))
        reach_m = max(0.0, 0.5 * (float(row.get('length_m') or 0.0) - width_m))
        angle = math.radians(float(row.get('direction_deg') or 0.0))
        num = 1 + int(reach_m / 0.05)
        for i in range(-num, num + 1) if reach_m > 0.0 else [0]:
            s_m = reach_m * i / num
            found.append((x_m + s_m * math.cos(angle), y_m + s_m * math.sin(angle), 0.5 * width_m))
    return found


def nearest_rim_m(line, everything):
    return min((to_line_m((x, y), line) - r for x, y, r in everything), default=math.inf)


def rows_of(path):
    with (gzip.open(path, 'rt') if path.endswith('.gz') else open(path)) as file:
        for row in csv.reader(file):
            if row and row[0].lstrip('-').isdigit():
                yield row


def scans_at_poses(folder, trajectory):
    """(x, y, yaw, ranges) of every scan, where the map's path has it."""
    poses = [(int(r[0]), *map(float, r[1:4])) for r in rows_of(trajectory)]
    times = [p[0] for p in poses]
    path = next(p for p in (folder + '/scans.csv', folder + '/scans.csv.gz') if os.path.exists(p))
    for row in rows_of(path):
        i = bisect.bisect_left(times, int(row[0]))
        if i < len(times) and times[i] - int(row[0]) < 100000:
            yield (*poses[i][1:], [float(v or 0.0) for v in row[1:]])


def laser_of(folder):
    values = {}
    for text in open(folder + '/sensors.yaml'):
        key, _, value = text.partition(':')
        if key.strip() in ('bearing_min_rad', 'bearing_step_rad'):
            values[key.strip()] = float(value.split('#')[0])
    return values['bearing_min_rad'], values['bearing_step_rad']


def was_seen_free(p, scans, bearing_min, bearing_step):
    for x, y, yaw, ranges in scans:
        distance_m = math.hypot(p[0] - x, p[1] - y)
        if distance_m < 0.3:
            return True
        if distance_m > 8.0:
            continue
        bearing = math.atan2(p[1] - y, p[0] - x) - yaw - bearing_min
        beam = round((bearing % (2.0 * math.pi)) / bearing_step)
        if beam < len(ranges) and ranges[beam] > distance_m + 0.1:
            return True
    return False


def places_along(line, step_m=0.5):
    for a, b in zip(line, line[1:]):
        num = max(1, int(math.hypot(b[0] - a[0], b[1] - a[1]) / step_m))
        for i in range(num):
            yield a[0] + (b[0] - a[0]) * i / num, a[1] + (b[1] - a[1]) * i / num


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('map')
    parser.add_argument('--truth')
    parser.add_argument('--recording')
    options = parser.parse_args()
    ways = json.load(open(options.map + '/graph.json'))['edges']
    marks = things(options.map + '/map.csv')
    wrong = []
    rim_m = true_m = math.inf
    for way in ways:
        own_m = nearest_rim_m(way['line'], marks)
        rim_m = min(rim_m, own_m)
        if own_m < RIM_M - ROUNDED_M:
            wrong.append(f"way {way['id']} comes within {own_m:.2f} m of a rim")
        if 0.5 * way['width_m'] > own_m + ROUNDED_M:
            wrong.append(f"way {way['id']} says {way['width_m']:.2f} m, {2 * own_m:.2f} m are free")
        if options.truth:
            off_m = nearest_rim_m(way['line'], things(options.truth))
            true_m = min(true_m, off_m)
            if off_m < TRUTH_M:
                wrong.append(f"way {way['id']} comes within {off_m:.2f} m of what stands there")
    places = unseen = 0
    if options.recording:
        bearings = laser_of(options.recording)
        scans = list(scans_at_poses(options.recording, options.map + '/trajectory.csv'))
        for way in ways:
            for p in places_along(way['line']):
                places += 1
                if not was_seen_free(p, scans, *bearings):
                    unseen += 1
                    wrong.append(f"way {way['id']} was seen free by nobody at {p[0]:.2f}, {p[1]:.2f}")
    text = f'{len(ways)} ways, nearest rim {rim_m:.2f} m'
    if options.truth:
        text += f', nearest true thing {true_m:.2f} m'
    if options.recording:
        text += f', {places - unseen} of {places} places seen free'
    print(text)
    for sentence in wrong:
        print('  ' + sentence)
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
