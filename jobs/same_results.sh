#!/usr/bin/env bash
# Checks that two commits compute the same: builds both and compares the last snapshots of short runs bit for bit, a jet,
# tanks in 2D and 3D and a shear wave on 1, 2 and 3 ranks. Both run the case files of OLD.
# Usage: jobs/same_results.sh OLD [NEW]
#   OLD, NEW  commits; NEW defaults to HEAD (changes that are not committed do not count)
# Prints one line per run: "same", or the largest differences. Exit 1 if any run differs or fails. Ten minutes on two
# cores, mostly to build; leaves nothing behind.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

commits=("${1:-}" "${2:-HEAD}")
if [ $# -lt 1 ] || [ $# -gt 2 ] || ! git rev-parse --quiet --verify "$1^{commit}" >/dev/null ||
  ! git rev-parse --quiet --verify "${commits[1]}^{commit}" >/dev/null; then
  sed -n '2,7s/^# //p' "$0" >&2
  exit 2
fi
jobs/install.sh

root=$(mktemp -d)
clean_up() {
  for side in old new; do git worktree remove --force "$root/$side" 2>/dev/null || true; done
  rm -rf "$root"
}
trap clean_up EXIT

# build SIDE COMMIT
build() {
  echo "== building $2"
  git worktree add --quiet --detach "$root/$1" "$2"
  (cd "$root/$1" && cmake --preset release -Wno-dev --log-level=WARNING && cmake --build --preset release --target impinge) \
    >"$root/build.log" 2>&1 || { tail -n 30 "$root/build.log" >&2; exit 1; }
}
build old "${commits[0]}"
build new "${commits[1]}"

differ=0
# compare NAME CASE [KEY=VALUE...]
compare() {
  local name=$1 case=$2 side ranks setting words
  shift 2
  for ranks in 1 2 3; do
    for side in old new; do
      words=(--set "output.directory=$root/results/$side")
      for setting; do words+=(--set "$setting"); done
      rm -rf "$root/results/$side"
      (cd "$root/old" && run_mpi "$ranks" "$root/$side/build/release/bin/impinge" "input/$case" "${words[@]}") \
        >"$root/run.log" 2>&1 || {
        echo "$name on $ranks: the $side program fails: $(head -n 1 "$root/run.log")"
        differ=1
        continue 2
      }
    done
    echo -n "$name on $ranks: "
    /usr/bin/python3 jobs/same_results.py "$root/results/old" "$root/results/new" || differ=1
  done
}
compare jet jet60-quick.toml time.end=0.6
compare jet-paper jet60-quick.toml scheme=paper time.end=0.4 time.dt=8e-4
compare tank hydrostatic.toml time.end=0.3 output.average_start=0.1
compare tank-paper hydrostatic.toml scheme=paper time.end=0.1 output.average_start=0.05
compare tank3D hydrostatic-3d.toml time.end=0.02
compare tank3D-paper hydrostatic-3d.toml scheme=paper time.end=0.02
compare shear-wave shear-wave.toml time.end=0.1
exit $differ
