#!/usr/bin/env bash
# Measures both schemes against the analytic jet at several resolutions, 30, 60 and 90 degrees, from the impacting column
# (to 5 s, averaged from 4 s on) and from the analytic state (to 2.5 s, from 2 s on); prints a table, draws error against
# spacing.
# Usage: jobs/convergence.sh [H/DP...]
#   H/DP   particles across the jet, multiples of 5; default 20 40 80 (hours on two cores; 20 alone: ten minutes)
# Variables: RANKS (default 2), SCHEMES (default "consistent paper"), ANGLES (default "30 60 90"), STARTS (default "impact
# steady"). dt = 0.16 dp/U with the consistent scheme, 0.04 dp/U with the paper's.
# Output: output/convergence/<scheme>-<start>-<angle>-<H/dp>/, table.md, error.png and force.png beside them. A run that
# is finished is not run again.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

resolutions_of "20 40 80" "$@" || {
  sed -n '2,12s/^# //p' "$0" >&2
  exit 2
}
set_up

root=output/convergence
for resolution in "${resolutions[@]}"; do
  for scheme in ${SCHEMES:-consistent paper}; do
    step=0.064
    [ "$scheme" = consistent ] || step=0.016
    for start in ${STARTS:-impact steady}; do
      end=5.0
      [ "$start" = impact ] || end=2.5
      for angle in ${ANGLES:-30 60 90}; do
        measure_jet "${RANKS:-2}" "$root/$scheme-$start-$angle-$resolution" input/jet.toml --set "scheme=$scheme" \
          --set "jet.start=$start" --set "jet.angle=$angle" --set "time.end=$end" \
          --set "particles.spacing=$(quotient 0.4 "$resolution")" --set "time.dt=$(quotient $step "$resolution")"
      done
    done
  done
done
/usr/bin/python3 jobs/convergence.py "$root" | tee "$root/table.md"
