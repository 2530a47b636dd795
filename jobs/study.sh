#!/usr/bin/env bash
# Runs the paper's cases at a given resolution and prints one table of their validation metrics.
# Usage: jobs/study.sh H/DP [RANKS [CASE...]]
#   H/DP   particles across the jet, a multiple of 5; dt = 2e-4 s x 80 / (H/DP)
#   RANKS  MPI ranks, default 2
#   CASE   files below input/paper without .toml, default all
# Output: output/study-<H/DP>/<case>/, the table in output/study-<H/DP>/table.txt. A case that is finished is not run
# again; a case that diverges is part of the table. B2 is A2 under another name and is computed once.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

if [ $# -lt 1 ] || ! [[ $1 =~ ^[1-9][0-9]*$ ]]; then
  sed -n '2,9s/^# //p' "$0" >&2
  exit 2
fi
resolution=$1
ranks=${2:-2}
cases=("${@:3}")
if [ ${#cases[@]} -eq 0 ]; then
  for file in input/paper/*.toml; do
    case=$(basename "$file" .toml)
    [[ $case == *-B2 ]] || cases+=("$case")
  done
fi
set_up

root=output/study-$resolution
for case in "${cases[@]}"; do
  measure_jet "$ranks" "$root/$case" "input/paper/$case.toml" --set "particles.spacing=$(quotient 0.4 "$resolution")" \
    --set "time.dt=$(quotient 0.016 "$resolution")"
done
/usr/bin/python3 jobs/table.py "$root" | tee "$root/table.txt"
