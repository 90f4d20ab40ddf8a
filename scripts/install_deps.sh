#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Install the packages to build and run Orchard Mapper on Debian 12 or Ubuntu 24.04.
# Run as root or as a user with sudo. Does nothing, without network, if all are installed.
#   scripts/install_deps.sh
#   scripts/install_deps.sh --tests   also packages that only tests need: a browser, a database, a cluster
#   scripts/install_deps.sh --all     also QGIS (about 1 GB)
set -euo pipefail
with_tests=no with_qgis=no
case "${1:-}" in
  --tests) with_tests=yes ;;
  --all) with_tests=yes with_qgis=yes ;;
  -h | --help) sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"; exit 0 ;;
  ?*) echo "install_deps: unknown argument $1; see $0 --help" >&2; exit 2 ;;
esac

packages=(
  # toolchain
  build-essential cmake ninja-build pkg-config
  # messages: the library, lcm-gen/lcm-logger/lcm-spy, and Java for the types' jar and, with windows, lcm-spy
  liblcm-dev liblcm-bin liblcm-java libjchart2d-java default-jdk-headless default-jre
  # mathematics, poses, rawlogs, geodesy
  libeigen3-dev libceres-dev libmetis-dev libmrpt-poses-dev libmrpt-obs-dev libgeographiclib-dev
  # elementary functions that are equal on all processors
  musl-dev
  # images
  # (libopencv-dev: the module packages alone carry no CMake config)
  libopencv-dev
  libturbojpeg0-dev libjpeg-dev
  # figures, and the font that stands in them
  libcairo2-dev libpng-dev fonts-dejavu-core
  # files
  libyaml-cpp-dev libgdal-dev zlib1g-dev nlohmann-json3-dev
  # bags of ROS
  liblz4-dev libzstd-dev libbz2-dev libsqlite3-dev
  # a database of many maps
  libpq-dev
  # digests of a farm's files
  libssl-dev
  # command line, log, tests, benchmarks
  libcli11-dev libspdlog-dev libfmt-dev libgtest-dev libgmock-dev libbenchmark-dev
  # the viewer's server
  libcpp-httplib-dev
  # manual pages
  help2man
  # network namespaces and multicast routes for demo and tests
  iproute2 util-linux
)

# What only tests start; a test without it is skipped and says so.
for_tests=(
  # what writes bags of ROS 1, and unpacks those of ROS 2
  python3-rosbag python3-sensor-msgs python3-nav-msgs python3-geometry-msgs lz4 zstd
  # gpsfake, for the GNSS driver
  gpsd gpsd-clients
  # several machines, clocks and supervisors
  python3 nftables libfaketime supervisor
  # farms: the engine that runs the steps, and a cluster of one node
  snakemake slurmctld slurmd slurm-client munge
  # what reads exported maps and rigs again
  gdal-bin python3-numpy python3-yaml python3-jsonschema
  # pages: a browser without a window, and what drives it
  chromium chromium-driver
  # what reads a PDF's words
  poppler-utils
  # orchard publish: a database
  postgresql-postgis
)
[ $with_tests = no ] || packages+=("${for_tests[@]}")
# What growers open maps with; without a window it needs no more than its library for Python.
[ $with_qgis = no ] || packages+=(python3-qgis)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
    missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "install_deps: all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "install_deps: these packages are missing, but this is neither root nor a user with sudo:" >&2
    echo "  ${missing[*]}" >&2
    echo "install_deps: ask an administrator to run: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  }
  as_root=(sudo)
fi
echo "install_deps: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
echo "install_deps: done"
