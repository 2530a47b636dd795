#!/usr/bin/env bash
# Runs the cases of input/ that have a folder, as they are, and three others coarsely; draws them with impinge-plot, and
# makes a page of the pictures.
# Usage: jobs/gallery.sh [RANKS [CASE...]]
#   RANKS  MPI ranks, default 2
#   CASE   folders or files below input/ without .toml, default all
# Output: output/gallery/<case>/, the page output/gallery/index.html, which holds its pictures. Takes about ten minutes.
# A case that is finished is not run again; one that fails is on the page, too.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

if [ $# -gt 0 ] && ! [[ $1 =~ ^[1-9][0-9]*$ ]]; then
  sed -n '2,9s/^# //p' "$0" >&2
  exit 2
fi
ranks=${1:-2}
cases=("${@:2}")
if [ ${#cases[@]} -eq 0 ]; then
  for file in input/*/README.md; do cases+=("$(basename "$(dirname "$file")")"); done
  cases+=(jet60-quick hydrostatic shear-wave)
fi
for case in "${cases[@]}"; do
  [ -f "input/$case/$case.toml" ] || [ -f "input/$case.toml" ] || { echo "$0: input/ has no case $case" >&2; exit 2; }
done
set_up

root=output/gallery
for case in "${cases[@]}"; do
  file=input/$case/$case.toml
  [ -f "$file" ] || file=input/$case.toml
  code=0
  if ! grep -qs finished "$root/$case/status"; then
    echo "== $case"
    run_mpi "$ranks" "$bin/impinge" "$file" --set "output.directory=$root/$case" || code=$?
    [ $code -eq 0 ] || [ $code -eq 3 ] || exit $code
    if [ $code -eq 0 ]; then echo finished; else echo failed; fi >"$root/$case/status"
  fi
  "$bin/impinge-plot" "$root/$case" >"$root/$case/plot.txt"
done
/usr/bin/python3 jobs/gallery.py "$root" "${cases[@]}"
