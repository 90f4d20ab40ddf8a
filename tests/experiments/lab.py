# SPDX-License-Identifier: BSD-3-Clause
"""What experiments are made of: rigs with overlays, drives and maps kept by what they were made with, programs."""
import concurrent.futures
import csv
import fcntl
import hashlib
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Failed(Exception):
    """A program that failed, or something that is missing."""


def overlay(text, changes):
    """YAML in blocks of two spaces with {"pose.mode": "fixes", ...} set; None takes a key or a section out."""
    lines = text.splitlines()
    for path, value in changes.items():
        _set(lines, path.split("."), value)
    return "\n".join(lines) + "\n"


def _set(lines, path, value):
    shown = {True: "true", False: "false"}.get(value, value) if isinstance(value, bool) else value
    begin, end = 0, len(lines)
    for depth, name in enumerate(path):
        pattern = re.compile("  " * depth + re.escape(name) + r":(\s|$)")
        at = next((i for i in range(begin, end) if pattern.match(lines[i])), None)
        if at is None:
            if value is None:
                return
            new = ["  " * (depth + i) + word + ":" for i, word in enumerate(path[depth:])]
            new[-1] += f" {shown}"
            place = begin if depth else len(lines)
            lines[place:place] = new
            return
        block_end = at + 1
        for i in range(at + 1, end):
            if lines[i].strip() and not lines[i].strip().startswith("#"):
                if len(lines[i]) - len(lines[i].lstrip()) <= 2 * depth:
                    break
                block_end = i + 1
        if depth == len(path) - 1:
            lines[at:block_end] = [] if value is None else ["  " * depth + f"{name}: {shown}"]
            return
        begin, end = at + 1, block_end


class Lab:
    """Runs programs of a build folder; keeps what they made under out/, by a digest of what went into it."""

    def __init__(self, build, out, jobs, data, is_quiet=False):
        self.build, self.out, self.jobs, self.data = pathlib.Path(build), pathlib.Path(out), jobs, pathlib.Path(data)
        self.is_quiet = is_quiet
        self._digests = {}

    def say(self, text):
        if not self.is_quiet:
            print(text, file=sys.stderr, flush=True)

    # programs

    def program(self, name):
        """The file of a program of bin/, experiments/, tests/ or benchmark/."""
        for folder in ("bin", "experiments", "tests", "benchmark"):
            if (self.build / folder / name).is_file():
                return self.build / folder / name
        raise Failed(f"{self.build} holds no program {name}: scripts/build.sh all experiments")

    def run(self, name, *arguments, may_fail=False, both=False):
        """What a program printed; both: also its errors."""
        command = [str(self.program(name)), *map(str, arguments)]
        done = subprocess.run(command, text=True, stdout=subprocess.PIPE, cwd=ROOT, check=False,
                              stderr=subprocess.STDOUT if both else subprocess.PIPE)
        if done.returncode != 0 and not may_fail:
            raise Failed(f"{' '.join(command)}: exit code {done.returncode}\n{(done.stderr or done.stdout)[-2000:]}")
        return done.stdout

    def orchard(self, *arguments, **options):
        return self.run("orchard", *arguments, **options)

    def lines(self, name, *arguments):
        """What a program printed as JSON, an object a line."""
        return [json.loads(line) for line in self.run(name, *arguments, may_fail=True).splitlines() if line[:1] == "{"]

    def each(self, items, work):
        """work(item) for each, several at once; the results in order."""
        items = list(items)
        results = [None] * len(items)
        with concurrent.futures.ThreadPoolExecutor(max_workers=self.jobs) as pool:
            futures = {pool.submit(work, item): i for i, item in enumerate(items)}
            for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
                results[futures[future]] = future.result()
                self.say(f"  {done} of {len(items)}")
        return results

    # what is kept

    def _digest_of(self, path):
        path = pathlib.Path(path)
        stat = path.stat()
        key = (str(path), stat.st_mtime_ns, stat.st_size)
        if key not in self._digests:
            self._digests[key] = hashlib.sha256(path.read_bytes()).hexdigest()
        return self._digests[key]

    def digest(self, name):
        """Of a program and, for `orchard`, of those beside it that it hands commands to."""
        program = self.program(name)
        paths = sorted(program.parent.glob("orchard*")) if name == "orchard" else [program]
        return hashlib.sha256("".join(self._digest_of(path) for path in paths).encode()).hexdigest()

    def made(self, kind, ingredients, make):
        """The folder of what make(folder) makes, made once for these ingredients, whichever jobs of whichever program ask at once."""
        text = json.dumps(ingredients, sort_keys=True)
        folder = self.out / "made" / f"{kind}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"
        if (folder / "made_of.json").is_file():
            return folder
        folder.parent.mkdir(parents=True, exist_ok=True)
        with open(folder.with_suffix(".lock"), "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # let go when the file is closed, by a killed program, too
            if (folder / "made_of.json").is_file():
                return folder
            part = folder.with_suffix(".part")
            for left in (part, folder):
                shutil.rmtree(left, ignore_errors=True)
            part.mkdir()
            make(part)
            (part / "made_of.json").write_text(text + "\n")
            part.rename(folder)
        return folder

    # rigs, drives, maps

    def rig(self, name, changes=None):
        """The text of config/NAME.yaml, or of another rig's text, with changes."""
        text = name if "\n" in name else (ROOT / "config" / f"{name}.yaml").read_text()
        return overlay(text, changes or {})

    def rig_file(self, text):
        path = self.out / "rigs" / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file():  # a file that is written again is empty for a moment, and another job may read it
            with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False, encoding="utf-8") as part:
                part.write(text)
            os.replace(part.name, path)
        return path

    def drive(self, rig, seed, scene="orchard", seconds=0, start_s=None, looks=False):
        """A simulated drive: a folder with drive.lcm, truth.csv, poses.csv and, wanted, looks.csv."""
        what = {"program": self.digest("orchard"), "rig": rig, "seed": seed, "scene": scene, "seconds": seconds,
                "start_s": start_s, "looks": self.digest("true_observations") if looks else ""}

        def make(folder):
            config = self.rig_file(rig)
            of = ["--scene", scene, "--seed", seed, "--config", config, "--duration", seconds]
            of += ["--from", start_s] if start_s is not None else []
            self.orchard("simulate", *of, "--out", folder / "drive.lcm", "--truth", folder / "truth.csv",
                         "--poses", folder / "poses.csv")
            if looks:
                self.run("true_observations", *of, "--out", folder / "looks.csv")

        return self.made("drive", what, make)

    def recording(self, name):
        """The log of a recording folder or file of ../shared/data, and that folder or file."""
        source = self.data / name
        if not source.exists():
            raise Failed(f"there is no recording {source}")
        files = sorted((str(p.relative_to(self.data)), p.stat().st_size, p.stat().st_mtime_ns)
                       for p in [source, *source.rglob("*")] if p.is_file())
        what = {"program": self.digest("orchard"), "files": files}
        return self.made("log", what, lambda folder: self.orchard("import", source, "--out", folder / "drive.lcm")), source

    def map(self, drive, rig, *options, changed=None):
        """The map of a drive's folder by a rig; changed: what else it depends on."""
        what = {"program": self.digest("orchard"), "drive": drive.name, "rig": rig, "options": [str(o) for o in options],
                "changed": changed}

        def make(folder):
            said = self.orchard("map", drive / "drive.lcm", "--config", self.rig_file(rig), "--out", folder, *options,
                                both=True)
            (folder / "said.txt").write_text(said)

        return self.made("map", what, make)

    def judged(self, folder, drive, align=True, gate_m=0.3):
        """`evaluate map` of a map against its drive's truth."""
        options = ["--poses", drive / "poses.csv", "--align"] if align else []
        return json.loads(self.orchard("evaluate", "map", folder, "--truth", drive / "truth.csv", *options, "--gate", gate_m,
                                       "--json"))

    def path(self, folder, poses, *options):
        """`evaluate trajectory` of a map, after rigid alignment unless options say otherwise."""
        return json.loads(self.orchard("evaluate", "trajectory", folder, "--truth", poses, *(options or ["--align"]), "--json"))

    def looks(self, maps, drives):
        """`evaluate_detections` over maps of drives that have looks.csv."""
        arguments = list(maps)
        for drive in drives:
            arguments += ["--observations", drive / "looks.csv", "--truth", drive / "truth.csv"]
        return json.loads(self.run("evaluate_detections", *arguments))


# figures

def mean(values):
    values = list(values)
    return sum(values) / len(values) if values else math.nan


def rms(values):
    return math.sqrt(mean(v * v for v in values))


def median(values):
    values = sorted(values)
    return mean(values[(len(values) - 1) // 2:len(values) // 2 + 1]) if values else math.nan


def rows_of(path):
    """Rows of a CSV with numbers as such."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text
    with open(path, encoding="utf-8") as file:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(file)]


def apart(a, b):
    return math.hypot(a["x_m"] - b["x_m"], a["y_m"] - b["y_m"])
