#!/usr/bin/env bash
# Long: three flows on 2 ranks, particles in - out - lost - stored must be 0 in every line of the history: the 60 degree
# jet at H/dp = 20 and a basin with a body that moves, two inlets and a weir, 20,000 steps each; a tank in 3D, 4,000
# particles that slosh over its rim, a tenth of the steps. Of the jet none may be lost.
# Usage: tests/soak.sh [STEPS [DIRECTORY]]; needs a build in build/release, or in that of IMPINGE_PRESET.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

steps=${1:-20000}
root=${2:-output/soak}
mkdir -p "$root"
run=
trap '[ -z "$run" ] || kill -KILL $run 2>/dev/null || true' EXIT

# soak STEPS MOST_LOST CASE [KEY=VALUE...]: runs a case until it has made the steps, then checks its history.
soak() {
  local steps=$1 most_lost=$2 case=$3 name words=() code=0
  shift 3
  name=$(basename "$case" .toml)
  local directory=$root/$name
  local history=$directory/${name}_history.csv
  rm -rf "$directory"  # of an earlier soak
  for setting in "$@"; do words+=(--set "$setting"); done
  local start=$SECONDS
  mpirun --oversubscribe -n 2 "$bin/impinge" "$case" --set "output.directory=$directory" --set time.end=1e4 \
    --set output.average_start=0 --set checkpoint.steps=1000 "${words[@]}" >"$directory.log" 2>&1 &
  run=$!
  while kill -0 $run 2>/dev/null && [ "$(tail -n 1 "$history" 2>/dev/null | cut -d, -f1 | grep -x '[0-9]*' || echo 0)" -lt "$steps" ]; do
    sleep 1
  done
  kill -USR1 $run 2>/dev/null || true
  wait $run || code=$?
  run=
  [ $code -eq 4 ] || { echo "$name: the run ended with $code, not with a checkpoint (4):"; tail "$directory.log"; exit 1; }

  awk -F, -v name="$name" -v steps="$steps" -v most_lost="$most_lost" -v seconds=$((SECONDS - start)) '
    NR == 1 { for (k = 1; k <= NF; ++k) column[$k] = k; next }
    $column["step"] != NR - 1 { print "line " NR " is of step " $column["step"]; bad = 1 }
    $column["in"] - $column["out"] - $column["lost"] - $column["fluid"] != 0 { print "step " $column["step"] ": not balanced"; bad = 1 }
    { retries += $column["cold_solves"]; halvings += $column["halvings"]; out = $column["out"]; lost = $column["lost"]; t = $column["t"] }
    END {
      if (lost > most_lost) { print "more than " most_lost " are lost"; bad = 1 }
      printf "%s: %d steps to t = %s s in %d s, %d particles out, %d lost, %d cold solves, %d halvings: %s\n", name, NR - 1, t, seconds, out, lost, retries, halvings, bad ? "wrong" : "balanced at every step"
      exit bad || NR - 1 < steps
    }' "$history"
}

soak "$steps" 0 input/jet60-quick.toml
soak "$steps" 1000 tests/system/basin.toml output.interval=1 output.sample_interval=0.01
{
  cat <<'TOML'
geometry = "tank"
dimension = 3
particles.spacing = 0.05
tank = {size = [1.0, 1.0, 0.8], fluid_height = 0.5}
time = {end = 1.0, dt = 4e-3}
output.interval = 1
probe = [{name = "floor", position = [0.5, 0.5, 0.1]}]
gauge = [{name = "corner", point = [0.05, 0.05, 0], length = 1.6}]
TOML
  awk 'BEGIN { for (k = 0; k <= 200; ++k) printf "[[fluid.gravity_at]]\ntime = %g\nvalue = [%g, %g, -9.81]\n", k / 10, 5 * sin(0.4 * k), 3 * sin(0.23 * k) }'
} >"$root/sloshing-3d.toml"
soak $((steps / 10)) 1000 "$root/sloshing-3d.toml"
