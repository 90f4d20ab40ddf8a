# SPDX-License-Identifier: BSD-3-Clause
"""A farm's dates in a real PostgreSQL with PostGIS: published once each, again where people corrected
one, and what the database refuses is named and made up for. Usage: publish_test.py SOURCE_TREE BIN."""
import json
import shutil
import subprocess
import sys
import tempfile

SOURCE, ORCHARD = sys.argv[1], sys.argv[2] + "/orchard"
sys.path.insert(0, SOURCE + "/tests/system/publish")
import server as postgres  # noqa: E402
from small_drive import make_drive  # noqa: E402

DATES = ["2026-01-01", "2026-02-01"]


def run(*arguments, expected=0):
    done = subprocess.run([ORCHARD, *arguments], capture_output=True, text=True)
    assert done.returncode == expected, f"{arguments}: {done.returncode}: {done.stdout}{done.stderr}"
    return done.stdout


def make_farm(folder):
    """A block driven on two dates, a few metres each."""
    farm = folder + "/farm"
    run("farm", "init", farm)
    for i, date in enumerate(DATES):
        make_drive(SOURCE, ORCHARD, folder + "/drive.lcm", rate_hz=6.0 + i)
        run("farm", "add", farm, folder + "/drive.lcm", "--block", "north", "--date", date,
            "--robot", "mule")
    return farm


def set_database(farm, url):
    with open(farm + "/farm.yaml", "w") as file:
        file.write(f'publish_to: "{url}"\n')


def status(farm):
    return json.loads(run("farm", "status", farm, "--json"))


def main():
    if shutil.which("snakemake") is None:
        print("skipped: snakemake is not installed")
        return 77
    with postgres.Server() as server, tempfile.TemporaryDirectory() as folder:
        farm = make_farm(folder)
        # nobody listens there: all but the publishing is made, and why not is named
        set_database(farm, f"postgresql://owner@/orchard?host={folder}")
        run("farm", "run", farm, "--cores", "2", expected=1)
        now = status(farm)
        assert now["steps"]["publish"] == {"good": 0, "set_aside": 0, "open": 2}, now
        assert now["steps"]["report"]["good"] == 2, now
        refused = [f for f in now["findings"] if f["what"] == "not published"]
        assert sorted(f["of"] for f in refused) == ["north/" + d for d in DATES], now
        assert all(f["reason"] for f in refused), refused

        set_database(farm, server.url())
        made = run("farm", "run", farm, "--cores", "2")
        assert made.startswith("2 steps made"), made
        assert status(farm)["findings"] == [], status(farm)
        assert server.sql("SELECT block, date FROM orchard.visit ORDER BY date") == [
            f"north|{d}" for d in DATES]
        run("farm", "publish", farm)
        for date in DATES:
            with open(f"{farm}/maps/north/{date}/map.csv") as file:
                num = sum(line.split(",")[1] == "tree" for line in file)
            assert num > 0 and server.sql(
                f"SELECT count(*) FROM orchard.tree WHERE date = '{date}' AND class = 'tree'") == [
                    str(num)], (date, num)
        assert run("farm", "run", farm).startswith("0 steps made")

        # a correction of the last date is published, and nothing else but its report and changes is
        # made anew
        tree = server.sql(f"SELECT min(id) FROM orchard.tree WHERE date = '{DATES[1]}'")[0]
        run("edit", "delete", f"{farm}/maps/north/{DATES[1]}", tree, "--who", "ana")
        assert run("farm", "run", farm).startswith("3 steps made")
        assert server.sql(f"SELECT count(*) FROM orchard.tree WHERE id = {tree} AND date = '{DATES[1]}'"
                          ) == ["0"]
    print("PASSED")
    return 0


if __name__ == "__main__":
    sys.exit(main())
