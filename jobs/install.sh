#!/usr/bin/env bash
# Installs what Impinge needs on Debian 12 or a derivative, and nothing that is there already.
# As root or as a user with sudo. Where apt is not at hand it says what is missing and stops.
# Usage: jobs/install.sh            install what is missing
#        jobs/install.sh --list     print the packages and stop
#        jobs/install.sh --peers    install what jobs/peers.sh needs besides: OpenFOAM
#        jobs/install.sh --tools    install what tests/fuzz.sh, tests/valgrind.sh, the test of the page and films in mp4 need besides
set -euo pipefail

packages=(
  build-essential cmake ninja-build pkg-config
  libopenmpi-dev openmpi-bin libpetsc-real-dev petsc-dev libhdf5-openmpi-dev libmetis-dev libassimp-dev
  libtomlplusplus-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libgtest-dev libbenchmark-dev clang-format
  python3 python3-numpy python3-h5py python3-matplotlib python3-skimage python3-vtk9
  libjs-dygraphs libjs-three
  python3-jsonschema python3-markdown-it
  file
)
tools=(clang-16 libclang-rt-16-dev llvm valgrind libc6-dbg chromium chromium-driver python3-selenium ffmpeg)
peers=(openfoam python3-scipy)

if [ "${1:-}" = --tools ]; then
  packages+=("${tools[@]}")
elif [ "${1:-}" = --peers ]; then
  packages+=("${peers[@]}")
elif [ "${1:-}" = --list ]; then
  printf '%s\n' "${packages[@]}"
  exit 0
fi

missing=()
if command -v dpkg-query >/dev/null 2>&1; then
  for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || exit 0
else
  # Not a Debian system: the cluster's modules must bring the tools and libraries.
  for tool in cmake ninja mpicxx mpirun pkg-config python3; do
    command -v "$tool" >/dev/null 2>&1 || missing+=("$tool")
  done
  for library in PETSc fmt; do
    pkg-config --exists "$library" 2>/dev/null || missing+=("$library")
  done
  [ ${#missing[@]} -gt 0 ] || exit 0
  echo "jobs/install.sh: apt is not at hand and these are missing: ${missing[*]}" >&2
  echo "Load or install them (Debian's names: ${packages[*]}), then call again." >&2
  exit 1
fi

if ! command -v apt-get >/dev/null 2>&1; then
  echo "jobs/install.sh: apt-get is not at hand and these packages are missing: ${missing[*]}" >&2
  exit 1
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null 2>&1; then
    echo "jobs/install.sh: missing packages need root or sudo to install: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
