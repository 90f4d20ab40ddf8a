# SPDX-License-Identifier: BSD-3-Clause
"""npm's packages that tests stand on, fetched once into the build folder."""
import pathlib
import shutil
import subprocess
import sys

PACKAGES = ["@mcap/core@2", "@foxglove/rosmsg@5", "@foxglove/rosmsg2-serialization@3",
            "@foxglove/rosmsg-msgs-common@3"]


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(77)


def fetch(work, packages=PACKAGES, tools=("node", "npm", "zstd", "lz4")):
    """The folder that holds node_modules; ends the test (77) when they cannot be had."""
    for tool in tools:
        if shutil.which(tool) is None:
            skip(f"{tool} is not here")
    folder = pathlib.Path(work, "npm")
    folder.mkdir(parents=True, exist_ok=True)
    if all((folder / "node_modules" / name.rsplit("@", 1)[0]).is_dir() for name in packages):
        return folder
    fetched = subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--prefix", folder,
                              *packages], capture_output=True, text=True)
    if fetched.returncode != 0:
        skip("npm cannot fetch its packages: " + fetched.stderr.strip().splitlines()[-1])
    return folder


def script(folder, name):
    """A script of this folder, beside node_modules, where node looks for packages."""
    here = pathlib.Path(__file__).parent
    copy = folder / name
    copy.write_text((here / name).read_text())
    return copy
