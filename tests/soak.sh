#!/usr/bin/env bash
# Long: 20,000 steps of the 60 degree jet at H/dp = 20 on 2 ranks; particles in - out - stored must be 0 in every line of
# the history. Usage: tests/soak.sh [STEPS [DIRECTORY]]; needs a build in build/release.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

steps=${1:-20000}
directory=${2:-output/soak}
history=$directory/jet60-quick_history.csv
rm -f "$history"  # of an earlier soak
start=$(date +%s)
mpirun --oversubscribe -n 2 "$bin/impinge" input/jet60-quick.toml --set "output.directory=$directory" --set time.end=1e4 \
  --set output.average_start=0 --set checkpoint.steps=1000 >"$directory.log" 2>&1 &
run=$!
trap 'kill -KILL $run 2>/dev/null || true' EXIT
while kill -0 $run 2>/dev/null && [ "$(tail -n 1 "$history" 2>/dev/null | cut -d, -f1 | grep -x '[0-9]*' || echo 0)" -lt "$steps" ]; do
  sleep 1
done
kill -USR1 $run 2>/dev/null || true
code=0
wait $run || code=$?
trap - EXIT
[ $code -eq 4 ] || { echo "the run ended with $code, not with a checkpoint (4):"; tail "$directory.log"; exit 1; }

awk -F, -v steps="$steps" -v seconds=$(($(date +%s) - start)) '
  NR == 1 { for (k = 1; k <= NF; ++k) column[$k] = k; next }
  $column["step"] != NR - 1 { print "line " NR " is of step " $column["step"]; bad = 1 }
  $column["in"] - $column["out"] - $column["fluid"] != 0 || $column["lost"] != 0 { print "step " $column["step"] ": not balanced"; bad = 1 }
  { retries += $column["cold_solves"]; halvings += $column["halvings"]; out = $column["out"]; t = $column["t"] }
  END {
    printf "%d steps to t = %s s in %d s, %d particles out, %d cold solves, %d halvings: %s\n", NR - 1, t, seconds, out, retries, halvings, bad ? "not balanced" : "balanced at every step"
    exit bad || NR - 1 < steps
  }' "$history"
