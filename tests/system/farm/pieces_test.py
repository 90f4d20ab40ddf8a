# SPDX-License-Identifier: BSD-3-Clause
"""A drive in the pieces that `orchard record` writes is mapped as if it had not been split, and damage
in any of them is reported. Usage: pieces_test.py SOURCE_TREE BIN."""
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

from small_drive import make_drive

SOURCE, ORCHARD = sys.argv[1], sys.argv[2] + "/orchard"
DATE = "2026-04-30"
EVENT = struct.Struct(">IqqII")  # of lcm-logger: sync word, number, time, sizes of channel and data


def split(path, num):
    """Bytes of the pieces of a log, cut between events."""
    data, at, pieces = path.read_bytes(), 0, [b""]
    while at < len(data):
        sync, _, _, channel, size = EVENT.unpack_from(data, at)
        assert sync == 0xEDA1DA01
        end = at + EVENT.size + channel + size
        if len(pieces) < num and at >= len(data) * len(pieces) / num:
            pieces.append(b"")
        pieces[-1] += data[at:end]
        at = end
    return pieces


def orchard(*arguments):
    done = subprocess.run([ORCHARD, *arguments], capture_output=True, text=True)
    assert done.returncode == 0, f"{arguments}: {done.stdout}{done.stderr}"
    return done.stdout


def main():
    if shutil.which("snakemake") is None:
        print("skipped: snakemake is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        farm, log = folder / "farm", folder / "drive.lcm"
        make_drive(SOURCE, ORCHARD, str(log))
        pieces = split(log, 3)
        orchard("farm", "init", farm)

        def add(block, names):
            for name, data in names.items():
                (folder / name).write_bytes(data)
                orchard("farm", "add", farm, folder / name, "--block", block, "--date", DATE,
                        "--robot", "mule")

        middle = len(pieces[1]) // 2
        torn = pieces[1][:middle] + b"\xff" * 5000 + pieces[1][middle + 5000:]
        recorded = ["drive-000.lcm", "drive-001.lcm", "drive-002.lcm"]
        add("whole", {"drive.lcm": log.read_bytes()})
        add("split", dict(zip(recorded, pieces)))
        add("torn", dict(zip(recorded, [pieces[0], torn, pieces[2]])))
        add("lost", {recorded[0]: pieces[0], recorded[2]: pieces[2]})
        orchard("farm", "run", farm, "--cores", "2")
        orchard("farm", "publish", farm)

        now = json.loads(orchard("farm", "status", farm, "--json"))
        assert now["num_drives"] == 4, now
        assert now["steps"]["map"] == {"good": 4, "set_aside": 0, "open": 0}, now
        for name in ("map.csv", "trajectory.csv"):
            maps = [(farm / "maps" / block / DATE / name).read_bytes() for block in ("whole", "split")]
            assert maps[0] == maps[1], name + " of the pieces differs from that of the whole"
        found = {(f["what"], f["of"]): f["reason"] for f in now["findings"]}
        assert set(found) == {("damaged", f"torn/{DATE}/mule/drive"),
                              ("pieces", f"lost/{DATE}/mule/drive")}, found
        assert "drive-001.lcm" in found["damaged", f"torn/{DATE}/mule/drive"], found
        assert "nothing was recorded for" in found["pieces", f"lost/{DATE}/mule/drive"], found
        assert len(now["notes"]) == 1 and "pieces 1 are missing" in now["notes"][0], now["notes"]
    print("PASSED")
    return 0


if __name__ == "__main__":
    sys.exit(main())
