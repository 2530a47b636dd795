#!/usr/bin/env bash
# Measures Impinge against exact solutions and experiments: runs cases of input/ on one core each, as many at a time as
# there are cores, compares them by their compare.py, prints one table and makes a page of tables and pictures.
# Usage: jobs/experiments.sh [CASE...] [--fine]
#   CASE    folders below input/ with a compare.py, default all
#   --fine  also the resolutions that docs/results/experiments.md shows (hours); default: ten minutes on two cores
# Output: output/experiments/<case>/<run>/ and page.md beside them; with --fine the page docs/results/experiments.md and the
# figures of the cases. A page keeps the cases that are not measured again, and a run that is finished is not run again.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

# The table of all runs, each a call of `run` with LEVEL CASE RUN [KEY=VALUE...]: coarse or fine, the folder below input/,
# the name of the run's directory, and what is set over the case file. A case's last run is its finest.
table_of_runs() {
  local level n ratio
  run coarse rotating-square 100
  run fine rotating-square 200 particles.spacing=0.005 time.dt=1.5e-3

  for n in 20 40 80; do
    level=$([ $n = 20 ] && echo coarse || echo fine)
    [ $n = 80 ] || run $level drop $n "particles.spacing=$(quotient 1 $n)" "time.dt=$(quotient 0.2 $n)" time.end=45.67374 \
      output.interval=0.2283687
    run $level drop no-force-$n "particles.spacing=$(quotient 1 $n)" "time.dt=$(quotient 0.1 $n)" time.end=0.8 \
      output.interval=0.02 fluid.central_force=0 'fluid.region[1].gradient=[1, 0, 0, -1]'
  done

  for n in 80 160; do
    level=$([ $n = 80 ] && echo coarse || echo fine)
    for ratio in 0.5 1 2 4; do
      run $level block $ratio-$n "particles.spacing=$(quotient 1 $n)" "time.dt=$(quotient 0.1 $n)" "time.end=$(quotient 2 $n)" \
        "fluid.region[1].high=[0.5, $(quotient 1 $ratio)]" "fluid.region[1].translate=[0, $(quotient 1.5 $n)]"
    done
  done

  for n in 40 80; do
    level=$([ $n = 40 ] && echo coarse || echo fine)
    for ratio in 2 1 0.5; do
      run $level dam-break-start $ratio-$n "particles.spacing=$(quotient 0.5 $n)" \
        "fluid.region[1].high=[$(quotient $ratio 2), 0.5]" "probe[2].position=[$(quotient $ratio 4), 0]"
    done
  done

  for n in 30 60; do
    level=$([ $n = 30 ] && echo coarse || echo fine)
    run $level standing-wave $n "particles.spacing=$(quotient 1 $n)" "time.dt=$(quotient 0.12 $n)"
    run $level standing-wave viscous-$n "particles.spacing=$(quotient 1 $n)" "time.dt=$(quotient 0.12 $n)" \
      fluid.viscosity=0.0125284 time.end=6.4
    run $level sway $n "particles.spacing=$(quotient 0.5 $n)" "time.dt=$(quotient 0.12 $n)"
  done

  run coarse taylor-green 50
  run fine taylor-green 100 particles.spacing=0.01 time.dt=2e-3
  run fine taylor-green no-density-term-100 particles.spacing=0.01 time.dt=2e-3 pressure.density_rate=0 pressure.gamma=0 \
    kernel.laplacian_radius=3.1

  for n in 20 40; do
    level=$([ $n = 20 ] && echo coarse || echo fine)
    run $level wave-maker piston-$n "particles.spacing=$(quotient 0.4 $n)" "time.dt=$(quotient 0.1 $n)"
    run $level wave-maker flap-$n "particles.spacing=$(quotient 0.4 $n)" "time.dt=$(quotient 0.1 $n)" \
      'motion[1].amplitude=[0, 0]' 'motion[1].angle=-2.8624'
    run $level solitary-wave $n "particles.spacing=$(quotient 1 $n)" "time.dt=$(quotient 0.16 $n)"
  done

  for n in 20 40; do
    level=$([ $n = 20 ] && echo coarse || echo fine)
    for ratio in 1 2; do
      run $level short-plate $ratio-$n "particles.spacing=$(quotient 0.1 $n)" "time.dt=$(quotient 0.008 $n)" \
        "wall[1].points=[[0, -$(quotient $ratio 20)], [0, $(quotient $ratio 20)]]"
    done
    run $level wedge $n "particles.spacing=$(quotient 0.1 $n)" "time.dt=$(quotient 0.008 $n)"
  done

  # Five runs that differ by chance.
  for n in 30 60; do
    level=$([ $n = 30 ] && echo coarse || echo fine)
    for step in 1 0.99 0.98 0.97 0.96; do
      run $level dam-break $n-$step "particles.spacing=$(quotient 0.3 $n)" "time.dt=$(quotient "$step" $((n * 100 / 3)))"
    done
  done
  for n in 20 40; do
    level=$([ $n = 20 ] && echo coarse || echo fine)
    run $level martin-moyce $n "particles.spacing=$(quotient 0.05715 $n)" "time.dt=$(quotient 0.01 $n)"
    run $level martin-moyce $n-square "particles.spacing=$(quotient 0.05715 $n)" "time.dt=$(quotient 0.01 $n)" \
      'fluid.region[1].high=[0.05715, 0.05715]'
    run $level koshizuka-oka $n "particles.spacing=$(quotient 0.146 $n)" "time.dt=$(quotient 0.02 $n)"
  done

  run coarse sloshing-impact 15
  run fine sloshing-impact 23 particles.spacing=0.004 time.dt=1.5e-3
  run coarse swaying-tank 20
  run fine swaying-tank 40 particles.spacing=0.015 time.dt=2e-3
  run coarse ciem-flume 20
  run coarse slow-jet 10
  run fine slow-jet 50 particles.spacing=0.002 time.end=2.0 output.average_start=1.0
  run coarse violent-sloshing 15
  run coarse dam-break-box 15
  run fine dam-break-box 20 particles.spacing=0.0275 time.dt=3e-3
  run fine shallow-bore 8 particles.spacing=3.75e-3
  run fine bore-on-column 6
}

root=output/experiments
fine=no
chosen=()
for word in "$@"; do
  case $word in
    --fine) fine=yes ;;
    *)
      [ -f "input/$word/compare.py" ] || { sed -n '2,9s/^# //p' "$0" >&2; exit 2; }
      chosen+=("$word")
      ;;
  esac
done
set_up

# compute CASE RUN [KEY=VALUE...]: one run, its CPU time in cpu_seconds beside it. A run that diverges is a result, too.
compute() {
  local case=$1 directory=$root/$1/$2 words=() code=0
  shift 2
  [ ! -f "$directory/cpu_seconds" ] || return 0
  for setting in "$@"; do words+=(--set "$setting"); done
  mkdir -p "$directory"
  echo "== $directory"
  local TIMEFORMAT='%U %S'
  { time run_mpi 1 "$bin/impinge" "input/$case/$case.toml" "${words[@]}" --set "output.directory=$directory" \
    >"$directory/run.log" 2>&1; } 2>"$directory/time" || code=$?
  [ $code -eq 0 ] || [ $code -eq 3 ] || { cat "$directory/run.log" >&2; return $code; }
  awk '{print $1 + $2}' "$directory/time" >"$directory/cpu_seconds"
}

# The runs that are chosen, in the table's order.
runs=()
run() {
  local level=$1
  shift
  [ "$level" = coarse ] || [ $fine = yes ] || return 0
  [ ${#chosen[@]} -eq 0 ] || [[ " ${chosen[*]} " == *" $1 "* ]] || return 0
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do sleep 0.2; done
  compute "$@" &
  runs+=("$1/$2")
}
table_of_runs
wait
for run in "${runs[@]}"; do [ -f "$root/$run/cpu_seconds" ] || exit 1; done  # it has told why

page=$root/page.md
[ $fine = no ] || page=docs/results/experiments.md
/usr/bin/python3 jobs/experiments.py "$root" "$page" "${runs[@]}"
