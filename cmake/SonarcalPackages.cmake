# `cpack -G DEB` in the build folder makes three Debian packages:
#
#   sonarcal          the program with its manual pages, completion, cases and pages
#   python3-sonarcal  the Python module
#   libsonarcal-dev   the libraries with their headers and CMake files
#
# Dependencies of the first two are read from the libraries that they link.
set(packages program development)
set(package_of_program sonarcal)
set(package_of_python_module python3-sonarcal)
set(package_of_development libsonarcal-dev)

# Debian's own Python looks for packages in another folder than one below /usr/local.
if(SONARCAL_WITH_PYTHON AND NOT SKBUILD)
  list(APPEND packages python_module)
  get_property(SONARCAL_PYTHON_FILES GLOBAL PROPERTY SONARCAL_PYTHON_FILES)
  set(python_packages lib/python3/dist-packages)
  install(TARGETS sonarcal_python LIBRARY DESTINATION ${python_packages}/sonarcal
    COMPONENT python_module EXCLUDE_FROM_ALL)
  install(FILES ${SONARCAL_PYTHON_FILES} DESTINATION ${python_packages}/sonarcal
    COMPONENT python_module EXCLUDE_FROM_ALL)
endif()
if(NOT SONARCAL_BUILD_APPS)
  list(REMOVE_ITEM packages program)
endif()

# Files that Debian requires in the folder of every package: copyright and a compressed
# changelog. With them: notices and the bill of materials.
set(debian_dir ${PROJECT_BINARY_DIR}/debian)
string(TIMESTAMP package_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(CPACK_PACKAGE_CONTACT "The sonarcal authors <sonarcal@users.noreply.github.com>")
find_program(SONARCAL_GZIP gzip REQUIRED)
foreach(component IN LISTS packages)
  set(package ${package_of_${component}})
  file(WRITE ${debian_dir}/${package}/changelog
    "${package} (${PROJECT_VERSION}) unstable; urgency=medium\n\n"
    "  * CHANGELOG.md of the sources lists the changes.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${package_date}\n")
  execute_process(COMMAND ${SONARCAL_GZIP} -9nf ${debian_dir}/${package}/changelog COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${debian_dir}/${package}/changelog.gz ${PROJECT_SOURCE_DIR}/THIRD_PARTY_NOTICES.md
      ${PROJECT_BINARY_DIR}/sonarcal.spdx.json
    DESTINATION share/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/debian_copyright DESTINATION share/doc/${package} RENAME copyright
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sonarcal)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "makes a simulated imaging sonar agree with a real one")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL ${packages})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_STRIP_FILES ON)
set(described
  "sonarcal renders what a forward-looking imaging sonar should have seen of a
scene, measures how far that is from what it did see, and fits the
simulator's physical parameters until the two agree as well as the data
allow.\n")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PYTHON_MODULE_PACKAGE_SECTION python)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
  "${described}This package has the program, its manual pages and its documentation.")
set(CPACK_COMPONENT_PYTHON_MODULE_DESCRIPTION "${described}This package has the Python module.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
  "${described}This package has the C++ libraries, with headers and CMake files.")
foreach(component IN LISTS packages)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_of_${component}})
endforeach()

set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# For dask_batch.py.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS python3)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "python3-sonarcal, python3-distributed")
if(SONARCAL_WITH_PYTHON)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  string(JOIN ", " CPACK_DEBIAN_PYTHON_MODULE_PACKAGE_DEPENDS
    "sonarcal (= ${PROJECT_VERSION})"
    "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR})"
    "python3 (<< ${Python_VERSION_MAJOR}.${next_minor})"
    python3-numpy)
  set(CPACK_DEBIAN_PYTHON_MODULE_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_MODULE_PACKAGE_SUGGESTS python3-matplotlib)
endif()

# Packages with the headers and CMake files that cmake/SonarcalDependencies.cmake asks for: those of the list that
# the libraries need, without those of the command line, the live view and the Python module.
file(STRINGS ${PROJECT_SOURCE_DIR}/scripts/packages.txt development_packages REGEX "^build .*-dev$")
list(TRANSFORM development_packages REPLACE "^build " "")
list(REMOVE_ITEM development_packages libcli11-dev libcpp-httplib-dev pybind11-dev python3-dev)
if(NOT SONARCAL_WITH_ROS)
  list(REMOVE_ITEM development_packages libsqlite3-dev)
endif()
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ${development_packages})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS cmake)
include(CPack)
