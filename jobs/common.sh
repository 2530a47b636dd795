# Sourced by the scripts beside it, from the repository's root.

# Open MPI refuses root unless told twice.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

# The presets build into directories of their own.
preset=${IMPINGE_PRESET:-release}
bin=build/$preset/bin

# Installs what is missing, configures and builds.
set_up() {
  jobs/install.sh
  cmake --preset "$preset" -Wno-dev --log-level=WARNING
  cmake --build --preset "$preset"
}

# run_mpi RANKS COMMAND...
run_mpi() {
  local ranks=$1
  shift
  [ "$ranks" -le "$(nproc)" ] || export OMPI_MCA_mpi_yield_when_idle=1  # ranks that wait leave the cores to the others
  mpirun --oversubscribe -n "$ranks" "$@"
}

# resolutions_of DEFAULTS [WORD...]: the words, or the defaults without any, as the array resolutions; fails where one is
# no count.
resolutions_of() {
  local defaults=$1 word
  shift
  read -ra resolutions <<<"${*:-$defaults}"
  for word in "${resolutions[@]}"; do [[ $word =~ ^[1-9][0-9]*$ ]] || return 1; done
}

# quotient A B: A / B, to 15 digits
quotient() { awk "BEGIN {printf \"%.15g\", $1 / $2}"; }

# product A B: A B, likewise
product() { awk "BEGIN {printf \"%.15g\", $1 * $2}"; }

# measure_jet RANKS DIR CASE [WORD...]: runs a jet into DIR and validates it, unless it is finished there. A run that
# diverges is a result, too.
measure_jet() {
  local ranks=$1 directory=$2 code=0
  shift 2
  if grep -qs '"status": "\(finished\|failed\)"' "$directory/validation/validation.json"; then return; fi
  echo "== $directory"
  run_mpi "$ranks" "$bin/impinge" "$@" --set "output.directory=$directory" || code=$?
  [ $code -eq 0 ] || [ $code -eq 3 ] || exit $code
  "$bin/impinge-validate" "$directory"
}
