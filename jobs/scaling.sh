#!/usr/bin/env bash
# Weak and strong series on 1 to 16 ranks, more than there are cores: counts per step, not times.
# Usage: jobs/scaling.sh [SERIES...]   SERIES: strong weak strong-3d weak-3d, default all; five minutes on 2 cores
#   strong, weak: a steady jet of 60 degrees, H/dp = 80; weak: H/dp = 40 to 160 with the root of the number of ranks
#   strong-3d, weak-3d: a tank of water, 32 particles an edge; weak: 16 to 40 with the cube root
# Output: output/scaling/<series>-<ranks>/, the tables in output/scaling/table.txt. A run is started twice, for 1 step
# and for 11: counts are the difference over 10, so start-up and snapshots cancel.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

series=("$@")
[ ${#series[@]} -gt 0 ] || series=(strong weak strong-3d weak-3d)
for name in "${series[@]}"; do
  if ! [[ $name =~ ^(strong|weak|strong-3d|weak-3d)$ ]]; then
    sed -n '2,8s/^# //p' "$0" >&2
    exit 2
  fi
done
set_up

root=output/scaling
mkdir -p "$root"
counter=$PWD/$root/count_mpi.so
mpicxx -std=c++20 -DOMPI_SKIP_MPICXX -O2 -shared -fPIC jobs/count_mpi.cpp -o "$counter"
export OMPI_MCA_mpi_yield_when_idle=1

# run SERIES RANKS DT CASE...: two runs and the plan
run() {
  local name=$1 ranks=$2 dt=$3 directory=$root/$1-$2 steps
  local case=("${@:4}" --set "time.dt=$dt")
  echo "== $name, $ranks ranks"
  rm -rf "$directory"
  mkdir -p "$directory"
  "$bin/impinge" "${case[@]}" --plan "$ranks" >"$directory/plan.txt"
  for steps in 1 11; do
    COUNT_MPI_FILE=$directory/counts-$steps.csv run_mpi "$ranks" env LD_PRELOAD="$counter" "$bin/impinge" "${case[@]}" \
      --set "time.end=$(awk "BEGIN {print $steps * $dt}")" --set "output.directory=$directory/run-$steps" \
      -log_view ":$directory/petsc-$steps.txt" \
      >"$directory/log-$steps.txt"
    rm "$directory/run-$steps"/*.{vtkhdf,checkpoint}
  done
}

for name in "${series[@]}"; do
  for ranks in 1 2 4 8 16; do
    case $name in
      strong) n=80 ;;
      strong-3d) n=32 ;;
      weak) n=$(awk "BEGIN {printf \"%.0f\", 40 * sqrt($ranks)}") ;;
      weak-3d) n=$(awk "BEGIN {printf \"%.0f\", 16 * $ranks ^ (1 / 3)}") ;;
    esac
    if [[ $name == *-3d ]]; then
      run "$name" "$ranks" "$(awk "BEGIN {print 1e-3 / $n}")" input/hydrostatic-3d.toml \
        --set "tank.size=[1, 1, 1]" --set tank.fluid_height=1 --set "particles.spacing=$(awk "BEGIN {printf \"%.17g\", 1 / $n}")"
    else
      run "$name" "$ranks" "$(awk "BEGIN {print 2e-4 * 80 / $n}")" input/paper/jet60-A2.toml \
        --set jet.start=steady --set "particles.spacing=$(awk "BEGIN {printf \"%.17g\", 0.4 / $n}")"
    fi
  done
done
/usr/bin/python3 jobs/scaling.py "$root" | tee "$root/table.txt"
