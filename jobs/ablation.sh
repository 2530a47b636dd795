#!/usr/bin/env bash
# What each ingredient of the consistent scheme does: switches one at a time back to the paper's, in the 60 degree jet
# from impact, and prints one table of the validation metrics.
# Usage: jobs/ablation.sh [H/DP [RANKS]]
#   H/DP   particles across the jet, a multiple of 5, default 20 (five minutes on two cores)
#   RANKS  MPI ranks, default 2
# Output: output/ablation-<H/DP>/<what is off>/, table.txt beside them. A run that is finished is not run again.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

resolution=${1:-20}
ranks=${2:-2}
if ! [[ $resolution =~ ^[1-9][0-9]*$ ]]; then
  sed -n '2,8s/^# //p' "$0" >&2
  exit 2
fi
set_up

root=output/ablation-$resolution
# ablate NAME [KEY=VALUE...]
ablate() {
  local name=$1 words=()
  shift
  for setting in "$@"; do words+=(--set "$setting"); done
  measure_jet "$ranks" "$root/$name" input/jet.toml --set "particles.spacing=$(quotient 0.4 "$resolution")" \
    --set "time.dt=$(quotient 0.064 "$resolution")" "${words[@]}"
}
ablate 0-consistent
ablate 2-walls-particles walls.model=particles
ablate 3-divergence-plain pressure.corrected_divergence=false
ablate 4-gradient-plain pressure.corrected_gradient=false
ablate 5-zero-at-particles free_surface.zero_outside=false
ablate 6-no-shifting shifting.coefficient=0
ablate 7-velocity-not-shifted shifting.correct_velocity=false
ablate 8-gamma-0.01 pressure.density_rate=0
ablate 9-collision-0.8 collision.distance=0.8
ablate a-number-density pressure.packing=false
ablate b-no-repulsion shifting.least_distance=0
ablate c-new-velocity time.mean_velocity=false
ablate d-radii-2.1-4.01 kernel.radius=2.1 kernel.laplacian_radius=4.01
ablate e-no-smoothing smoothing.rate=0
/usr/bin/python3 jobs/table.py "$root" | tee "$root/table.txt"
