# SPDX-License-Identifier: BSD-3-Clause
"""The rows of the table in tests/RESULTS.md."""
import os

PAGE = "tests/RESULTS.md"
BEGIN = "<!-- field: written by tests/experiments/field.sh --write -->"
END = "<!-- end of field -->"
HEAD = ["| measurement | what | measured | wanted | |", "|---|---|---|---|---|"]


class Row:
    """One line: what was measured, what is wanted, and whether it is so (None: nothing is wanted)."""

    def __init__(self, name, what, measured, wanted="", met=None):
        self.name, self.what, self.measured, self.wanted, self.met = name, what, measured, wanted, met

    def verdict(self):
        return {None: "", True: "met", False: "**MISSED**"}[self.met]

    def line(self):
        cells = [f"`{self.name}`", self.what, self.measured, self.wanted, self.verdict()]
        text = "| " + " | ".join(str(cell).replace("|", "/") for cell in cells) + " |"
        return text.replace(os.getcwd() + "/", "")  # nothing of one machine


def write(rows, order):
    """Puts rows between the marks of the page; measurements that were not made keep their lines."""
    with open(PAGE) as file:
        page = file.read()
    if BEGIN not in page or END not in page:
        raise SystemExit(f"field: {PAGE} has lost its marks of field")
    before, rest = page.split(BEGIN, 1)
    old, after = rest.split(END, 1)
    lines = {}
    for line in old.splitlines():
        if line.startswith("| `"):
            lines.setdefault(line.split("`")[1], []).append(line)
    for name in {row.name for row in rows}:
        lines[name] = [row.line() for row in rows if row.name == name]
    table = HEAD + [line for name in order if name in lines for line in lines[name]]
    temporary = PAGE + ".new"
    with open(temporary, "w") as file:
        file.write(before + BEGIN + "\n\n" + "\n".join(table) + "\n\n" + END + after)
    os.replace(temporary, PAGE)
