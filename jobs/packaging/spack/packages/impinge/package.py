# A recipe for Spack, to build Impinge with a cluster's MPI. From a clone of the repository:
#
#   spack repo add jobs/packaging/spack
#   spack install impinge ^openmpi       # or the MPI that packages.yaml names
#   spack load impinge

import pathlib

from spack.package import *

try:  # Spack 1.0 and newer
    from spack_repo.builtin.build_systems.cmake import CMakePackage
except ImportError:
    pass


class Impinge(CMakePackage):
    """Distributed-memory MPS (moving particle semi-implicit) solver for free-surface flow."""

    # The clone that this recipe is in.
    git = pathlib.Path(__file__).resolve().parents[5].as_uri()

    license("MIT")

    version("main", branch="main")

    variant("tests", default=False, description="Build the tests, for spack install --test=root")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("python@3.9:", type=("build", "run"))

    depends_on("mpi")
    depends_on("petsc@3.18: +mpi+hypre+double~complex")
    depends_on("hdf5@1.10: +mpi")
    depends_on("metis@5:")
    depends_on("assimp@5:")
    depends_on("fmt")
    depends_on("tomlplusplus", type="build")
    depends_on("cli11", type="build")
    depends_on("nlohmann-json", type="build")
    depends_on("googletest", type="build", when="+tests")

    depends_on("py-numpy", type=("build", "run"))
    depends_on("py-h5py", type=("build", "run"))
    depends_on("py-matplotlib", type=("build", "run"))
    depends_on("py-scikit-image", type="run")

    generator("ninja")

    def setup_run_environment(self, env):
        env.prepend_path("PYTHONPATH", self.prefix.share.impinge)

    def cmake_args(self):
        # Spack's compiler wrapper names the processor.
        return [self.define("IMPINGE_NATIVE", False), self.define_from_variant("BUILD_TESTING", "tests")]
