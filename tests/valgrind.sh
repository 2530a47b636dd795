#!/usr/bin/env bash
# Runs a coarse jet, and a basin with a moving body, two inlets and all tables, on 2 ranks under valgrind's memcheck:
# invalid reads and writes, values that were never set, memory that is lost. Fails if it finds anything that is not the
# libraries' own.
# Usage: tests/valgrind.sh
# Output: output/valgrind/: the run's files, and a log of memcheck for each rank.
set -euo pipefail
cd "$(dirname "$0")/.."
export IMPINGE_PRESET=valgrind
. jobs/common.sh

jobs/install.sh --tools
set_up

root=output/valgrind
rm -rf "$root"
mkdir -p "$root"
export OMPI_MCA_mpi_yield_when_idle=1
code=0

# check NAME CASE [KEY=VALUE...]
check() {
  local name=$1 case=$2 words=()
  shift 2
  for setting in "$@"; do words+=(--set "$setting"); done
  run_mpi 2 valgrind --error-exitcode=9 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite \
    --num-callers=40 --keep-debuginfo=yes --suppressions=/usr/share/openmpi/openmpi-valgrind.supp \
    --suppressions=tests/valgrind.supp --log-file="$root/$name-rank-%q{OMPI_COMM_WORLD_RANK}.log" \
    "$bin/impinge" "$case" "${words[@]}" --set "output.directory=$root/$name" || code=$?
}

# H/dp = 5, 25 steps, 3 snapshots with the averaged wall pressure.
check jet input/jet60-quick.toml particles.spacing=0.08 time.dt=0.01 time.end=0.2 output.interval=0.1 \
  output.average_start=0.05
check basin tests/system/basin.toml particles.spacing=0.05 time.end=0.02 output.interval=0.01 checkpoint.steps=10
grep -H -E 'ERROR SUMMARY|definitely lost:' "$root"/*-rank-*.log
if [ $code -ne 0 ]; then
  echo "tests/valgrind.sh: see $root/*-rank-*.log" >&2
  exit 1
fi
