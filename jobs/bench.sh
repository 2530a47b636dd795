#!/usr/bin/env bash
# Prints what a step costs: the 60 degree jet from its steady state, by the paper's scheme and at H/DP = 80 by the
# consistent one, and a sloshing 3D block of 100 thousand fluid particles, on 1 and 2 ranks; first as runs do it, then
# with every pressure solve cold and to 1e-8.
# Usage: jobs/bench.sh [H/DP ...]    particles across the jet; default 40 80 160, and 80 400 cold
#        jobs/bench.sh --kernels     the inner loops alone, on one rank, by Google Benchmark
# Output: output/bench/: the tables warm.txt and cold.txt, their runs as JSON, kernels.txt. Takes minutes; let nothing
# else run.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

usage() {
  sed -n '2,8s/^# //p' "$0" >&2
  exit 2
}
kernels=
[ "${1:-}" != --kernels ] || { kernels=yes; shift; [ $# -eq 0 ] || usage; }
for resolution; do
  [[ $resolution =~ ^[1-9][0-9]*$ ]] || usage
done
warm=("$@")
cold=("$@")
[ $# -gt 0 ] || { warm=(40 80 160); cold=(80 400); }
set_up

root=output/bench
tests=build/$preset/tests
mkdir -p "$root"
if [ "$kernels" ]; then
  "$tests/kernel_bench" --benchmark_min_time=0.2 | tee "$root/kernels.txt"
  exit 0
fi

# measure TABLE NAME OPTIONS...: one configuration on 1 and 2 ranks
measure() {
  local table=$1 name=$2 ranks
  shift 2
  for ranks in 1 2; do
    echo "measuring $name on $ranks rank(s), $table" >&2
    run_mpi "$ranks" "$tests/step_bench" "$@" >"$root/$table-$name-x$ranks.json"
    files+=("$root/$table-$name-x$ranks.json")
  done
}

# jet TABLE H/DP OPTIONS...: the paper's scheme, with gamma/dt, the weight of the density term against the flow, the same
# for every H/DP
jet() {
  local table=$1 resolution=$2
  shift 2
  measure "$table" "jet$resolution" input/paper/jet60-A2.toml --set jet.start=steady \
    --set "particles.spacing=$(quotient 0.4 "$resolution")" --set "time.dt=$(quotient 0.016 "$resolution")" \
    --set "pressure.gamma=$(quotient 0.8 "$resolution")" "$@"
}

# consistent TABLE H/DP OPTIONS...: the consistent scheme
consistent() {
  local table=$1 resolution=$2
  shift 2
  measure "$table" "consistent$resolution" input/jet.toml --set jet.start=steady \
    --set "particles.spacing=$(quotient 0.4 "$resolution")" --set "time.dt=$(quotient 0.064 "$resolution")" "$@"
}

# tabulate TABLE "H/DP..." OPTIONS...
tabulate() {
  local table=$1 resolutions=$2 resolution files=()
  shift 2
  for resolution in $resolutions; do jet "$table" "$resolution" "$@"; done
  consistent "$table" 80 "$@"
  measure "$table" block3D input/hydrostatic-3d.toml --set 'tank.size=[0.46, 0.46, 0.7]' --set tank.fluid_height=0.47 \
    --set 'fluid.gravity=[4, 0, -9.81]' "$@"
  /usr/bin/python3 jobs/bench_table.py "${files[@]}" | tee "$root/$table.txt"
}

tabulate warm "${warm[*]}"
tabulate cold "${cold[*]}" --set pressure.tolerance=1e-8 -bench_cold -bench_warm_up 2 -bench_steps 3
