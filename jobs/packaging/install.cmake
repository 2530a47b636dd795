# What `cmake --install` and the .deb put where. All places are relative to the prefix, and the programs find each other
# and the schema from their own place: an installation can be moved.

include(GNUInstallDirs)
set(IMPINGE_ZSH_DIRECTORY ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where completions of zsh go")
set(IMPINGE_PYTHON_DIRECTORY "" CACHE STRING "Where Python finds modules by itself; empty: share/impinge alone has it")

# Libraries outside of the system's directories, as a cluster's modules have them, are found again.
set_target_properties(impinge impinge-validate PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)

install(TARGETS impinge impinge-validate)
install(PROGRAMS ${python_programs} TYPE BIN)
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/man/ TYPE MAN)
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/bash-completion TYPE DATA)
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/zsh/site-functions/ DESTINATION ${IMPINGE_ZSH_DIRECTORY})
install(FILES ${schema} src/programs/impinge.py src/programs/impinge_space.py src/programs/impinge_compare.py
              src/programs/impinge_paraview.py src/programs/report.html DESTINATION ${CMAKE_INSTALL_DATADIR}/impinge)
if(IMPINGE_PYTHON_DIRECTORY)
  foreach(name impinge.py impinge_space.py impinge_compare.py)
    file(RELATIVE_PATH module /${IMPINGE_PYTHON_DIRECTORY} /${CMAKE_INSTALL_DATADIR}/impinge/${name})
    file(CREATE_LINK ${module} ${PROJECT_BINARY_DIR}/${name} SYMBOLIC)
    install(FILES ${PROJECT_BINARY_DIR}/${name} DESTINATION ${IMPINGE_PYTHON_DIRECTORY})
  endforeach()
endif()
# Documents and cases keep their places to each other, so that their links hold.
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE TYPE DOC)
install(FILES jobs/packaging/CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR}/jobs/packaging)
install(DIRECTORY docs input TYPE DOC)

set(CPACK_PACKAGE_CONTACT "Impinge maintainers <maintainers@users.noreply.h-seed-b7950a59.example>")
# Where Debian looks for licence and changelog.
install(FILES LICENSE TYPE DOC RENAME copyright)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/changelog @ONLY
     CONTENT "impinge (@PROJECT_VERSION@) stable; urgency=medium\n\n  * CHANGELOG.md has the changes.\n\n -- @CPACK_PACKAGE_CONTACT@  @date@\n")
file(ARCHIVE_CREATE OUTPUT ${PROJECT_BINARY_DIR}/changelog.gz PATHS ${PROJECT_BINARY_DIR}/changelog FORMAT raw
     COMPRESSION GZip COMPRESSION_LEVEL 9)
install(FILES ${PROJECT_BINARY_DIR}/changelog.gz TYPE DOC)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGE_DESCRIPTION
    "Impinge computes jets, dam breaks, sloshing and other flows with a free surface
on any number of MPI ranks. impinge-validate measures a jet against the exact
solution, impinge-plot draws a run, impinge-report writes a page about it.")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS
    "openmpi-bin, python3, python3-h5py, python3-matplotlib, python3-numpy, libjs-dygraphs, libjs-three")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-skimage")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "bash-completion, ffmpeg, paraview")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/jobs/packaging/prerm)
include(CPack)
