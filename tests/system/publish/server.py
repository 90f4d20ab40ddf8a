# SPDX-License-Identifier: BSD-3-Clause
"""A PostgreSQL with PostGIS of its own, in a private folder, reached by a socket in it only."""
import glob
import os
import pwd
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77


def programs():
    """Folder of initdb and pg_ctl; exits as skipped where there is no server or no PostGIS."""
    for folder in sorted(glob.glob("/usr/lib/postgresql/*/bin"), reverse=True):
        version = folder.split("/")[-2]
        if os.path.exists(f"/usr/share/postgresql/{version}/extension/postgis.control"):
            return folder
    print("skipped: no PostgreSQL server with PostGIS is installed (scripts/install_deps.sh --tests)")
    sys.exit(SKIPPED)


class Server:
    """`with Server() as server:`; runs as nobody when the test is root, since initdb refuses root."""

    def __enter__(self):
        self.bin = programs()
        self.folder = tempfile.mkdtemp(prefix="orchard_pg_")
        self.user = None
        if os.geteuid() == 0:
            self.user = "nobody"
            os.chown(self.folder, pwd.getpwnam("nobody").pw_uid, -1)
        os.chmod(self.folder, 0o755)
        self._run("initdb", "-D", self.folder + "/data", "-A", "trust", "-U", "owner", "-E", "UTF8",
                  "--locale=C", "--no-sync")
        self.start()
        self._run("psql", "-h", self.folder, "-U", "owner", "-d", "postgres", "-qc",
                  "CREATE DATABASE orchard")
        return self

    def start(self):
        self._run("pg_ctl", "-D", self.folder + "/data", "-w", "-t", "60", "-l",
                  self.folder + "/log", "-o",
                  f"-c listen_addresses='' -c unix_socket_directories='{self.folder}' -c fsync=off",
                  "start")

    def die(self):
        """Ends all of its processes at once, as a machine that loses its power."""
        subprocess.run(self._as_user([self.bin + "/pg_ctl", "-D", self.folder + "/data", "-m",
                                      "immediate", "stop"]), cwd="/", stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)

    def __exit__(self, *_):
        self.die()
        shutil.rmtree(self.folder, ignore_errors=True)

    def url(self, user="owner"):
        return f"postgresql://{user}@/orchard?host={self.folder}"

    def sql(self, text, user="owner"):
        """Lines of the answer, columns separated by "|". Raises with the server's words."""
        done = subprocess.run(["psql", "-X", "-qAt", "-v", "ON_ERROR_STOP=1", "-d", self.url(user),
                               "-c", text], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr)
        return done.stdout.strip().splitlines()

    def _as_user(self, command):
        if self.user is None:
            return command
        return ["setpriv", "--reuid", self.user, "--clear-groups", "--"] + command

    def _run(self, program, *arguments):
        done = subprocess.run(self._as_user([self.bin + "/" + program, *arguments]), cwd="/",
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{program}: {done.stdout}")
