# SPDX-License-Identifier: BSD-3-Clause
"""How large a tree is: lines, files, named constants, keys, words."""
import collections
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/system/house"))
import constants_test  # noqa: E402

CORE = ["lib/geometry", "lib/laser", "lib/vision", "lib/detection", "lib/pose", "lib/mapping", "lib/bus", "lib/io/log",
        "lib/io/config"]
CONSTANT = re.compile(r"^ *(static |inline )*(constexpr|const) [A-Za-z_:0-9<>, ]+ k[A-Z][A-Za-z0-9_]*( =|\{|\[)", re.M)


def sources(tree, *folders):
    return [path for folder in folders for path in sorted((tree / folder).rglob("*.[ch]pp"))]


def lines(paths):
    return sum(path.read_bytes().count(b"\n") for path in paths)


def keys(build, *options):
    """Lines of --print-config that give a value, without the simulator's."""
    program = pathlib.Path(build) / "bin/orchard-detector"
    if not build or not program.is_file():
        return None
    said = subprocess.run([program, "--print-config", *options], text=True, capture_output=True, check=False).stdout
    room, number = "", 0
    for line in said.splitlines():
        room = line.split(":")[0] if re.match(r"[a-z_]+:", line) else room
        number += room != "simulation" and re.match(r" +[a-z_0-9]+: *[^# ]", line) is not None
    return number


def measured(tree, build):
    """{what: number}, in the order to show."""
    tree = pathlib.Path(tree)
    numbers = {"lines of lib and procs": lines(sources(tree, "lib", "procs")),
               "lines of the core": lines(sources(tree, *CORE)),
               "lines of tests": lines(sources(tree, "tests"))}
    rooms = [constants_test.count(tree, room) for room in constants_test.ROOMS]
    numbers["tuned constants (lib/*/tuning.hpp)"] = sum(tuned for _, _, tuned in rooms)
    numbers["constants of the core neither tuned nor marked"] = sum(len(unmarked) for _, unmarked, _ in rooms)
    numbers["named constants in lib and procs"] = sum(len(CONSTANT.findall(path.read_text()))
                                                      for path in sources(tree, "lib", "procs"))
    shown, every = keys(build), keys(build, "--all")
    if shown is not None:
        numbers["keys for users"], numbers["keys for experts"] = shown, max(0, every - shown)
    numbers["words of README.md"] = len((tree / "README.md").read_text().split())
    numbers["words of tests/RESULTS.md"] = len((tree / "tests/RESULTS.md").read_text().split())
    numbers["files of lib and procs"] = len(sources(tree, "lib", "procs"))
    units = collections.Counter(path.parent for path in {p.with_suffix("") for p in sources(tree, "lib", "procs")})
    most = units.most_common(1)[0][1]
    numbers["most units in a folder"] = most
    for kind in ("lib", "procs", "tests"):
        for room in sorted(path for path in (tree / kind).iterdir() if path.is_dir()):
            numbers[f"lines of {kind}/{room.name}"] = lines(sources(tree, f"{kind}/{room.name}"))
    return numbers


def show(now, before=None, rev=""):
    if before is not None:
        print(f"{'':48} {rev[:9]:>9} {'now':>9}")
    for what in dict.fromkeys([*now, *(before or {})]):
        old = f" {(before or {}).get(what, '-'):>9}" if before is not None else ""
        print(f"{what:48}{old} {now.get(what, '-'):>9}")
