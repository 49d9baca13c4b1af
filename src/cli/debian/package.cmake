# Read by cpack (CPACK_PROJECT_CONFIG_FILE, see ../packaging.cmake): the packages, and what is Debian's about them.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY OFF)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
# As Debian's own tools take it.
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
if("$ENV{DEBFULLNAME}" STREQUAL "" OR "$ENV{DEBEMAIL}" STREQUAL "")
  set(CPACK_DEBIAN_PACKAGE_MAINTAINER "aurasim maintainers <aurasim@aurasim.invalid>")
endif()

set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME aurasim)
# The first line of each is its synopsis; that of the top-level CMakeLists.txt would be put before both.
set(CPACK_DEBIAN_UNSPECIFIED_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION_SUMMARY}
Each node owns one region of the world and runs Bullet for the bodies in it;
nodes find each other and talk over DDS, on one machine or many, and hand
bodies over before two of them can touch across a border. In deterministic
mode the result has the same bits on one node and on many.

With a viewer for the browser, launch files and scenes, and systemd units for
hosts of their own, which are not enabled.")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_DEPENDS adduser)
# The discovery server (dds.discovery: server), clocks that agree.
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "aurasim-import, fastdds-tools, chrony")
set(own ${CMAKE_CURRENT_LIST_DIR})
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_CONTROL_EXTRA "${own}/conffiles;${own}/postinst;${own}/prerm;${own}/postrm")

set(CPACK_DEBIAN_IMPORT_PACKAGE_NAME aurasim-import)
set(CPACK_DEBIAN_IMPORT_DESCRIPTION "models of other programs for aurasim
URDF, SDF, MJCF and mesh files become scene files of aurasim, and its scenes
SDF files, by the fields' own libraries. It is what `aurasim import` and
`aurasim export` run.")
set(CPACK_DEBIAN_IMPORT_PACKAGE_DEPENDS "aurasim (= ${CPACK_PACKAGE_VERSION})")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libaurasim-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_DESCRIPTION "C++ programs that drive a world of aurasim
A library, its headers and find_package(aurasim): join or launch a run, see
its bodies, act, and step the world in lock-step with a program.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "aurasim (= ${CPACK_PACKAGE_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_CONTROL_EXTRA "${own}/triggers")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-aurasim)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "Python programs that drive a world of aurasim
The module `aurasim`: join or launch a run, see its bodies as numpy arrays,
act, and step the world in lock-step with a program.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "aurasim (= ${CPACK_PACKAGE_VERSION}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy")

# A wheel is made by pip (src/python).
list(REMOVE_ITEM CPACK_COMPONENTS_ALL wheel)

set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PRE_BUILD_SCRIPTS ${own}/finish.cmake)
