#!/usr/bin/env bash
# Weak and strong series, on more ranks than there are cores: counts per step, not times.
# Usage: [RANKS="1 2 4 8 16"] jobs/scaling.sh [SERIES...]
#   SERIES: strong weak strong-3d weak-3d, default all; ten minutes on 2 cores
#   strong, weak: a steady jet of 60 degrees, H/dp = 80; weak: H/dp = 40 to 160 with the root of the number of ranks
#   strong-3d, weak-3d: water set free in a tank under a gravity that is not upright, 32 particles an edge; weak: 16 to
#     40 with the cube root
# Output: output/scaling/<series>-<ranks>/, the tables in output/scaling/table.txt. A run is started twice, the second
# time for some ten steps more: counts are the difference over these steps, so start-up and snapshots cancel.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

series=("$@")
[ ${#series[@]} -gt 0 ] || series=(strong weak strong-3d weak-3d)
for name in "${series[@]}"; do
  if ! [[ $name =~ ^(strong|weak|strong-3d|weak-3d)$ ]]; then
    sed -n '2,9s/^# //p' "$0" >&2
    exit 2
  fi
done
set_up

root=output/scaling
mkdir -p "$root"
counter=$PWD/$root/count_mpi.so
mpicxx -std=c++20 -DOMPI_SKIP_MPICXX -O2 -shared -fPIC jobs/count_mpi.cpp -o "$counter"
export OMPI_MCA_mpi_yield_when_idle=1

read -ra all_ranks <<<"${RANKS:-1 2 4 8 16}"

# run SERIES RANKS DT STEPS CASE...: the plan and the two runs, to STEPS and STEPS + 10 times DT
run() {
  local name=$1 ranks=$2 dt=$3 steps=$4 directory=$root/$1-$2 part
  local case=("${@:5}" --set "time.dt=$dt")
  local -A end=([first]=$(product "$steps" "$dt") [second]=$(product $((steps + 10)) "$dt"))
  echo "== $name, $ranks ranks"
  rm -rf "$directory"
  mkdir -p "$directory"
  "$bin/impinge" "${case[@]}" --plan "$ranks" >"$directory/plan.txt"
  for part in first second; do
    COUNT_MPI_FILE=$directory/counts-$part.csv run_mpi "$ranks" env LD_PRELOAD="$counter" "$bin/impinge" "${case[@]}" \
      --set "time.end=${end[$part]}" --set "output.interval=${end[$part]}" --set "output.directory=$directory/run-$part" \
      -log_view ":$directory/petsc-$part.txt" \
      >"$directory/log-$part.txt"
    rm "$directory/run-$part"/*.{vtkhdf,checkpoint}
  done
}

for name in "${series[@]}"; do
  for ranks in "${all_ranks[@]}"; do
    case $name in
      strong) n=80 ;;
      strong-3d) n=32 ;;
      weak) n=$(awk "BEGIN {printf \"%.0f\", 40 * sqrt($ranks)}") ;;
      weak-3d) n=$(awk "BEGIN {printf \"%.0f\", 16 * $ranks ^ (1 / 3)}") ;;
    esac
    if [[ $name == *-3d ]]; then
      run "$name" "$ranks" "$(quotient 0.2 "$n")" 10 input/hydrostatic-3d.toml \
        --set "fluid.gravity=[4, 0, -9.81]" --set "tank.size=[1, 1, 2]" --set tank.fluid_height=1 \
        --set "particles.spacing=$(quotient 1 "$n")"
    else
      run "$name" "$ranks" "$(quotient 0.016 "$n")" 1 input/paper/jet60-A2.toml \
        --set jet.start=steady --set "particles.spacing=$(quotient 0.4 "$n")"
    fi
  done
done
/usr/bin/python3 jobs/scaling.py "$root" | tee "$root/table.txt"
