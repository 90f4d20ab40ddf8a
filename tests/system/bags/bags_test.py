#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""bags_test.py ORCHARD SOURCE WORK ros1|ros2|mcap [ATTEMPTS]: one drive as a log and as bags made by the
format's own libraries gives one map; damaged bags are read as far as they go, with losses said; topics
are found or asked for. ATTEMPTS: bags that are cut or have bits flipped, of each kind (10). Exit code 77: the format's library is not here."""
import csv
import pathlib
import random
import re
import shutil
import subprocess
import sys

import drive
import npm_modules
import write_bags

ORCHARD, SOURCE, WORK, FORMAT = sys.argv[1:5]
ATTEMPTS = int(sys.argv[5]) if len(sys.argv) > 5 else 10
SECONDS = "8"
WITH_FIXES = ["--topic", "pose_fix=/total_station"]


def run(*words, codes=(0,)):
    done = subprocess.run([ORCHARD, *map(str, words)], capture_output=True, text=True, timeout=60)
    assert done.returncode in codes, f"{words}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def counts(text):
    """The numbers of messages by channel that an import printed."""
    return {name: int(num) for num, name in re.findall(r" (\d+) ([A-Z_]+)\b", text)}


def read_map(folder):
    with open(folder / "map.csv") as file:
        return list(csv.DictReader(file))


def assert_same_map(first, second):
    """Equal within the rounding of single precision, which ROS's scans have."""
    a, b = read_map(first), read_map(second)
    assert len(a) == len(b) > 5, f"{len(a)} and {len(b)} landmarks"
    for left, right in zip(a, b):
        for key in ("id", "class", "n", "row", "position"):
            assert left[key] == right[key], (key, left, right)
        for key in ("x_m", "y_m", "width_m"):
            assert abs(float(left[key]) - float(right[key])) < 0.0005, (key, left, right)


class Bags:
    def __init__(self):
        self.folder = pathlib.Path(WORK, FORMAT)
        shutil.rmtree(self.folder, ignore_errors=True)
        (self.folder / "types").mkdir(parents=True)
        self.log = self.folder / "drive.lcm"
        run("simulate", "--scene", "orchard", "--seed", "7", "--duration", SECONDS, "--out", self.log)
        self.messages = drive.read(SOURCE, self.log, str(self.folder / "types"))
        self.num = {}
        for _, channel, _ in self.messages:
            self.num[channel] = self.num.get(channel, 0) + 1
        run("map", self.log, "--out", self.folder / "map", "--quiet")
        self.rig = self.folder / "rig.yaml"
        self.rig.write_text(run("log", "config", self.log).stdout)

    def write(self, messages, name, how):
        path = self.folder / name
        path.unlink(missing_ok=True)
        if FORMAT == "ros1":
            write_bags.write_rosbag(messages, path, how)
        elif FORMAT == "mcap":
            write_bags.write_mcap(messages, path, how, pathlib.Path(WORK, "npm"))
        else:
            write_bags.write_sqlite(messages, path, zstd if how == "zstd" else None)
        return path

    def imported(self, bags, *options, codes=(0,)):
        out = self.folder / "imported.lcm"
        out.unlink(missing_ok=True)
        return run("import", *bags, *options, "--out", out, codes=codes), out

    def map_is_that_of_the_log(self, bags):
        done, log = self.imported(bags, *WITH_FIXES)
        assert counts(done.stdout) == self.num, (counts(done.stdout), self.num)
        assert "not used" not in done.stdout and done.stderr == "", done.stdout + done.stderr
        run("map", log, "--config", self.rig, "--out", self.folder / "again", "--quiet")
        assert_same_map(self.folder / "map", self.folder / "again")
        same = (self.folder / "map/map.csv").read_bytes() == (self.folder / "again/map.csv").read_bytes()
        print(f"{', '.join(b.name for b in bags)}: the log's map, {'to the byte' if same else 'rounded'}")

    def what_is_damaged_is_read_as_far_as_it_goes(self, bag):
        whole = bag.read_bytes()
        random.seed(3)
        broken = bag.with_name("broken" + bag.suffix)
        lost = 0
        for attempt in range(ATTEMPTS):
            content = bytearray(whole)
            if attempt < 4:
                content = content[: len(content) * (attempt + 1) // 5]
            elif attempt >= 10 and attempt % 3 == 0:
                content = content[: random.randrange(len(content))]
            else:
                for _ in range(2 ** (attempt % 6)):
                    content[random.randrange(len(content))] ^= 1 << random.randrange(8)
            broken.write_bytes(content)
            done, log = self.imported([broken], *WITH_FIXES, codes=(0, 3))
            num = counts(done.stdout)
            assert all(num[c] <= self.num[c] for c in num), (num, self.num)
            missing = sum(self.num.values()) - sum(num.values())
            if done.returncode == 0 and missing > 0:
                assert "lost: " in done.stderr or "not used" in done.stdout, (attempt, done)
                lost += 1
            if done.returncode == 3:
                assert len(done.stderr.splitlines()) >= 1, done.stderr
            else:
                # What went through the guards of every message is sound.
                assert run("log", "check", log, codes=(0, 3)).stdout.count("cannot be used") == 0
            if attempt == 3 and FORMAT != "ros2":
                assert sum(num.values()) > 0.6 * sum(self.num.values()), (attempt, num)
        assert lost > 1, "no damage was met"


def a_folder_and_its_bag_say_the_same(bags):
    """All but what ROS has in single precision, and the last bits of an angle in a quaternion."""
    row = bags.folder / "row.lcm"
    run("import", pathlib.Path(SOURCE, "tests/data/row"), "--out", row)
    messages = drive.read(SOURCE, row, str(bags.folder / "types"))
    bag = bags.write(messages, "row" + suffix(), "none")
    _, log = bags.imported([bag], *WITH_FIXES)
    again = drive.read(SOURCE, log, str(bags.folder / "types"))
    assert len(messages) == len(again) > 500

    def same(a, b, name):
        if isinstance(a, dict):
            assert all(same(a[key], b[key], key) for key in a)
        elif isinstance(a, float) and (name.startswith("angle") or name in ("time_increment", "range_min", "range_max")):
            assert abs(a - b) <= 2**-23 * abs(a), (name, a, b)
        elif name in ("z", "w"):
            assert abs(a - b) < 1e-12, (name, a, b)
        else:
            assert a == b, (name, a, b)
        return True

    for (utime, channel, fields), (utime_again, channel_again, fields_again) in zip(messages, again):
        assert (utime, channel) == (utime_again, channel_again)
        same(fields, fields_again, channel)


def zstd(data):
    return subprocess.run(["zstd", "-q", "-c", f"--stream-size={len(data)}"], input=data, capture_output=True, check=True).stdout


def several_of_a_type_are_asked_for(bags):
    twice = bags.write(bags.messages, "twice" + suffix(), "none")
    saved = drive.TOPICS["SCAN"]
    drive.TOPICS["SCAN"] = write_bags.TOPICS["SCAN"] = "/rear/scan"
    rear = bags.write([m for m in bags.messages if m[1] == "SCAN"], "rear" + suffix(), "none")
    drive.TOPICS["SCAN"] = write_bags.TOPICS["SCAN"] = saved
    done, _ = bags.imported([twice, rear], codes=(3,))
    assert "/front/scan" in done.stderr and "/rear/scan" in done.stderr, done.stderr
    done, _ = bags.imported([twice, rear], "--topic", "scan=/rear/scan", "--topic", "image=none")
    assert "scan: /rear/scan" in done.stdout and "IMAGE" not in counts(done.stdout), done.stdout
    done, _ = bags.imported([twice, rear], "--topic", "scan=/front/scan", "--topic",
                            "scan_rear=/rear/scan")
    assert done.stdout.count(f"{bags.num['SCAN']} SCAN") == 2, done.stdout  # SCAN and SCAN.rear
    for wrong in ("scan=/none", "scan=/odom", "scan", "beam=/scan"):
        done, log = bags.imported([twice], "--topic", wrong, codes=(3,))
        assert wrong in done.stderr and not log.exists(), done.stderr


def suffix():
    return {"ros1": ".bag", "ros2": ".db3", "mcap": ".mcap"}[FORMAT]


def main():
    if FORMAT == "ros1":
        try:
            import rosbag  # noqa: F401
        except ImportError:
            npm_modules.skip("Debian's python3-rosbag, python3-sensor-msgs, python3-nav-msgs are not installed")
    if FORMAT == "mcap":
        npm_modules.fetch(WORK)
    bags = Bags()
    compressions = {"ros1": ["none", "bz2", "lz4"], "mcap": ["none", "zstd", "lz4"],
                    "ros2": ["none"]}[FORMAT]
    for compression in compressions:
        bag = bags.write(bags.messages, compression + suffix(), compression)
        bags.map_is_that_of_the_log([bag])
        bags.what_is_damaged_is_read_as_far_as_it_goes(bag)
    # Two recorders of one drive, and one that began a new file in the middle.
    camera = bags.write([m for m in bags.messages if m[1] == "IMAGE"], "camera" + suffix(), "none")
    others = [m for m in bags.messages if m[1] != "IMAGE"]
    half = len(others) // 2
    first = bags.write(others[:half], "rest_0" + suffix(), compressions[-1])
    second = bags.write(others[half:], "rest_1" + suffix(), compressions[-1])
    bags.map_is_that_of_the_log([second, camera, first])
    several_of_a_type_are_asked_for(bags)
    a_folder_and_its_bag_say_the_same(bags)
    if FORMAT == "ros2" and shutil.which("zstd"):
        some = bags.messages[:300]
        done, _ = bags.imported([bags.write(some, "zstd.db3", "zstd")], *WITH_FIXES)
        assert sum(counts(done.stdout).values()) == 300, done.stdout
        # As rosbag2 leaves it: a folder with its files and what they hold.
        folder = bags.folder / "rosbag2_drive"
        folder.mkdir()
        (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: {version: 5}\n")
        for name in ("rest_0.db3", "rest_1.db3", "camera.db3"):
            shutil.copy(bags.folder / name, folder / name)
        bags.map_is_that_of_the_log([folder])
    print("bags are read as the log is")


if __name__ == "__main__":
    main()
