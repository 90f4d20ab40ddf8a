#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that in the rooms below each named number outside of tuning.hpp says what kind it is.

constants_test.py SOURCE_TREE [--list ROOM]   (--list: the unmarked ones of a room)
A number is `physical:` (with its source) or `derived:` (with its formula, or why this size): the word stands in the
comment on its line or in the nearest comment above it in the same block without blank lines, which may head
several. What was tuned stands in lib/ROOM/tuning.hpp. unmarked_constants.txt beside this file says how many of a
room may still be unmarked; that may only fall. Exit code 1 where there are more."""
import pathlib
import re
import sys

ROOMS = ["geometry", "laser", "vision", "detection", "pose", "mapping", "calibration"]
NUMBER = r"(?:double|float|int|unsigned|long|bool|char|auto|Eigen::Index|std::u?int\d+_t|std::size_t|std::ptrdiff_t|std::array<(?:double|float|int|bool|std::\w+)\b[^>]*>)"
CONSTANT = re.compile(r"^\s*(?:(?:static|inline) )*(?:constexpr|const)(?: (?:static|inline|unsigned))* " + NUMBER +
                      r" (k[A-Z]\w*)\s*(?:=|\{|\[|$)")
MARK = re.compile(r"\b(?:physical|derived):")


def sources(folder):
    return sorted(path for path in folder.rglob("*") if path.suffix in (".hpp", ".cpp"))


def constants_in(lines):
    """(line number, name, is marked) of each named number in lines of C++."""
    found = []
    heading, heading_goes_on = "", False  # the nearest comment of this block
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text:
            heading, heading_goes_on = "", False
            continue
        if text.startswith("//"):
            heading = heading + " " + text if heading_goes_on else text
            heading_goes_on = True
            continue
        heading_goes_on = False
        constant = CONSTANT.match(line)
        if constant:
            own = line[line.find("//"):] if "//" in line else ""
            found.append((number, constant.group(1), bool(MARK.search(own) or MARK.search(heading))))
    return found


def count(tree, room):
    """(named numbers outside of tuning.hpp, the unmarked ones as "file:line: name", tuned numbers) of a room."""
    folder = pathlib.Path(tree) / "lib" / room
    all_numbers, unmarked, tuned = 0, [], 0
    for path in sources(folder):
        constants = constants_in(path.read_text(encoding="utf-8").splitlines())
        if path.name == "tuning.hpp":
            tuned += len(constants)
            continue
        all_numbers += len(constants)
        unmarked += [f"{path.relative_to(tree)}:{line}: {name}" for line, name, marked in constants if not marked]
    return all_numbers, unmarked, tuned


def check_itself():
    """Sees marks on the line and above a block, and none beyond a blank line or another comment."""
    lines = ["// physical: a data sheet", "constexpr double kA_m = 1;", "  static constexpr int kB = 2;", "",
             "constexpr std::size_t kC =", "  3;  // derived: of nothing, too late",
             "inline constexpr double kD = 4;  // derived: 2 kA_m", "// physical: g,", "// of the earth",
             "constexpr std::array<double, 2> kE{9.81, 0};", "// chosen", "constexpr double kF = 5;",
             "std::string kG = text;"]
    expected = [("kA_m", True), ("kB", True), ("kC", False), ("kD", True), ("kE", True), ("kF", False)]
    assert [(name, marked) for _, name, marked in constants_in(lines)] == expected, constants_in(lines)


def main():
    check_itself()
    if len(sys.argv) not in (2, 4) or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    tree = pathlib.Path(sys.argv[1])
    if len(sys.argv) == 4:
        print("\n".join(count(tree, sys.argv[3])[1]))
        return
    allowed = {}
    for line in (pathlib.Path(__file__).parent / "unmarked_constants.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            room, number = line.split()
            allowed[room] = int(number)
    failed = False
    for room in ROOMS:
        all_numbers, unmarked, tuned = count(tree, room)
        may = allowed.get(room, 0)
        print(f"{room}: {tuned} tuned, {all_numbers} others, {len(unmarked)} of them unmarked (allowed: {may})")
        if len(unmarked) > may:
            failed = True
            print("VIOLATED: mark as physical: or derived:, or move to tuning.hpp, of these:")
            print("\n".join("  " + line for line in unmarked))
        elif len(unmarked) < may:
            print(f"  write {room} {len(unmarked)} into unmarked_constants.txt")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
