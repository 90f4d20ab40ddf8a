# SPDX-License-Identifier: BSD-3-Clause
"""Names in a farm: those of people pass through Snakemake and the shell as they are; what is no drive
gives a note and stops nothing. Usage: names_test.py SOURCE_TREE BIN."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from small_drive import make_drive

SOURCE, ORCHARD = sys.argv[1], sys.argv[2] + "/orchard"
DATE = "2026-04-30"
NAMES = ["north", "Müller's \"old\" block", "$(touch made) `touch made`; touch made & *", "-x --y",
         "~ #[1] %s 'a", "Яблоки 林檎"]


class Names(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.farm = self.folder / "the farm of Müller's"
        self.drive = str(self.folder / "drive one's.lcm")
        make_drive(SOURCE, ORCHARD, self.drive)
        self.orchard("init", self.farm)

    def orchard(self, command, *arguments, code=0):
        done = subprocess.run([ORCHARD, "farm", command, *arguments], capture_output=True, text=True,
                              cwd=self.folder, errors="surrogateescape")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def add(self, block, date=DATE, robot="mule", code=0):
        return self.orchard("add", self.farm, self.drive, f"--block={block}", f"--date={date}",
                            f"--robot={robot}", code=code)

    def status(self):
        return json.loads(self.orchard("status", self.farm, "--json").stdout)

    def test_of_people_pass_through_all_steps(self):
        if shutil.which("snakemake") is None:
            self.skipTest("snakemake is not installed")
        for name in NAMES:
            self.add(name, robot=name)
        shutil.copy(self.drive + ".yaml", self.farm / "rigs" / f"{NAMES[1]}.yaml")
        self.orchard("run", self.farm, "--cores", "2")
        now = self.status()
        self.assertEqual(now["findings"], [])
        self.assertEqual(now["notes"], [])
        # a rig of its own makes one map, one date more
        self.assertEqual([now["steps"][kind]["good"] for kind in ("map", "date", "report")],
                         [2, 2, len(NAMES)])
        self.orchard("publish", self.farm)
        for name in NAMES:
            self.assertTrue((self.farm / "maps" / name / DATE / "map.csv").is_file(), name)
            self.assertIn("<html", (self.farm / "reports" / name / DATE / "report.html").read_text())
        self.assertEqual(list(self.folder.rglob("made")), [])

    def test_that_cannot_be_used_give_a_note_and_stop_nothing(self):
        self.add("north")
        logs = self.farm / "logs"
        foreign = {logs / "notes.txt": "logs/BLOCK/DATE/ROBOT/NAME.lcm",
                   logs / "north" / "Thumbs.db": "logs/BLOCK/DATE/ROBOT/NAME.lcm",
                   logs / "north" / DATE / "rows.csv": "logs/BLOCK/DATE/ROBOT/NAME.lcm",
                   logs / "north" / DATE / "mule" / "drive.txt": "NAME.lcm"}
        dates = {"2026-13-45": "like 2026-04-30", "2026-4-30": "write 2026-04-30",
                 "30.4.2026": "like 2026-04-30", "2026-02-29": "not a date that exists"}
        for path in foreign:
            path.write_text("x")
        for date, advice in dates.items():
            path = logs / "north" / date
            shutil.copytree(logs / "north" / DATE / "mule", path / "mule")
            foreign[path] = advice
        for name, advice in {"a{b}": "\"{\"", os.fsdecode(b"M\xfcller"): "UTF-8",
                             "red\x1b[31m": "printable"}.items():
            shutil.copytree(logs / "north" / DATE, logs / name / DATE)
            foreign[logs / name] = advice
        for hidden in (logs / ".DS_Store", logs / "north" / ".DS_Store"):
            hidden.write_text("x")

        now = self.status()
        self.assertEqual((now["num_blocks"], now["num_dates"], now["num_drives"]), (1, 1, 1))
        said = self.orchard("status", self.farm).stderr
        self.assertNotIn("\x1b", said)
        for path, advice in foreign.items():
            inside = str(path.relative_to(self.farm)).replace("\x1b", "?")
            lines = [line for line in said.splitlines() if f"note: {inside} is ignored" in line]
            self.assertEqual(len(lines), 1, (inside, said))
            self.assertIn(advice, lines[0])
        self.assertIn("note: logs/.DS_Store and other names are hidden and ignored", said)
        self.assertEqual(len(now["notes"]), len(foreign) + 1)

    def test_that_cannot_be_used_are_not_added(self):
        for block, date, words in [("a/b", DATE, "--block"), ("..", DATE, "--block"),
                                   ("north", "2026-13-45", "--date"),
                                   ("north", "2026-4-30", "write 2026-04-30")]:
            self.assertIn(words, self.add(block, date, code=3).stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
