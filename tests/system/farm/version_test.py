# SPDX-License-Identifier: BSD-3-Clause
"""Results belong to the programs that made them: after an upgrade a season is made anew as a whole, or
kept as a whole. Usage: version_test.py SOURCE_TREE BIN."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

from small_drive import make_drive

SOURCE, BIN = sys.argv[1], pathlib.Path(sys.argv[2])
DATES = ["2026-01-01", "2026-02-01"]
CHANGED = "the programs or the Snakefile have changed"


def install(folder):
    """A copy of the programs that a farm runs."""
    folder.mkdir()
    for program in ("orchard", "orchard-maps", "orchard-gis"):
        shutil.copy(BIN / program, folder / program)
    return folder


def upgrade(program):
    """Other bytes of the same behaviour: what follows the sections of an ELF file is not loaded."""
    with open(program, "ab") as file:
        file.write(b"another build")


def main():
    if shutil.which("snakemake") is None:
        print("skipped: snakemake is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        farm, programs = folder / "farm", install(folder / "bin")

        def orchard(*arguments, programs=programs):
            done = subprocess.run([programs / "orchard", "farm", *arguments], capture_output=True,
                                  text=True)
            assert done.returncode == 0, f"{arguments}: {done.stdout}{done.stderr}"
            return done

        def num_made(*options, programs=programs):
            said = orchard("run", farm, "--cores", "2", *options, programs=programs)
            return int(said.stdout.split()[0])

        def status():
            return json.loads(orchard("status", farm, "--json").stdout)

        def is_noted(done):
            return CHANGED in done.stderr

        def published():
            return {date: (farm / "maps" / "north" / date).resolve().name for date in DATES}

        orchard("init", farm)
        log = str(folder / "drive.lcm")
        for i, date in enumerate(DATES):
            make_drive(SOURCE, str(programs / "orchard"), log, rate_hz=6.0 + i)
            orchard("add", farm, log, "--block", "north", "--date", date, "--robot", "mule")
        steps = num_made("--keep-version")  # there is none to be kept
        assert steps == 2 + 2 + 1 + 2, steps
        orchard("publish", farm)
        first = published()
        assert num_made(programs=install(folder / "elsewhere")) == 0, "the same bytes elsewhere"

        for program in ("orchard", "orchard-maps", "orchard-gis"):
            before = published()
            upgrade(programs / program)
            # until a run decides, the old season stands as a whole, and says so
            now = status()
            assert all(step["open"] == 0 for step in now["steps"].values()), now
            assert any(CHANGED in note for note in now["notes"]), now
            assert is_noted(orchard("publish", farm)) and published() == before
            assert num_made("--keep-version") == 0 and published() == before
            assert num_made() == steps, "another " + program
            assert not is_noted(orchard("publish", farm))
            assert not set(published().values()) & set(before.values()), published()
        assert len({*published().values(), *first.values()}) == 4

        with open(farm / "Snakefile", "a") as file:
            file.write("# other steps\n")
        assert num_made("--keep-version") == 0
        assert num_made() == steps, "another Snakefile"

        # what is added to a kept season is named by the kept version, so that it is one graph
        upgrade(programs / "orchard")
        make_drive(SOURCE, str(programs / "orchard"), log, rate_hz=9.0)
        orchard("add", farm, log, "--block", "south", "--date", DATES[0], "--robot", "mule")
        assert num_made("--keep-version") == 3, "a map, a date, a report"
    print("PASSED")
    return 0


if __name__ == "__main__":
    sys.exit(main())
