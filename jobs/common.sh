# Sourced by the scripts beside it, from the repository's root.

# Open MPI refuses root unless told twice.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

bin=build/release/bin

# Installs what is missing, configures and builds.
set_up() {
  jobs/install.sh
  cmake --preset "${IMPINGE_PRESET:-release}" -Wno-dev --log-level=WARNING
  cmake --build --preset "${IMPINGE_PRESET:-release}"
}

# run_mpi RANKS COMMAND...
run_mpi() {
  local ranks=$1
  shift
  mpirun --oversubscribe -n "$ranks" "$@"
}

# quotient A B: A / B, to 15 digits
quotient() { awk "BEGIN {printf \"%.15g\", $1 / $2}"; }
