# Install rules: the libraries with their headers, the command, and a package that
# find_package(sonarcal) finds. Headers keep their paths: #include "sim/rays/trace.h" works in both places.
include(CMakePackageConfigHelpers)

set(SONARCAL_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/sonarcal)

get_property(SONARCAL_LIBRARIES GLOBAL PROPERTY SONARCAL_LIBRARIES)
install(TARGETS ${SONARCAL_LIBRARIES} EXPORT sonarcalTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY core data_io metrics sim calib
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sonarcal
  FILES_MATCHING PATTERN "*.h")
if(SONARCAL_BUILD_APPS)
  install(DIRECTORY apps/workflow
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sonarcal/apps
    FILES_MATCHING PATTERN "*.h")
  install(TARGETS sonarcal RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  include(SonarcalDocumentation)
endif()
install(EXPORT sonarcalTargets NAMESPACE sonarcal:: DESTINATION ${SONARCAL_PACKAGE_DIR})

configure_package_config_file(cmake/sonarcalConfig.cmake.in
  ${PROJECT_BINARY_DIR}/sonarcalConfig.cmake
  INSTALL_DESTINATION ${SONARCAL_PACKAGE_DIR})
# Before 1.0 a minor version may change any interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sonarcalConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/sonarcalConfig.cmake
  ${PROJECT_BINARY_DIR}/sonarcalConfigVersion.cmake
  cmake/FindLZ4.cmake
  cmake/FindRosbagStorage.cmake
  cmake/FindZstd.cmake
  cmake/SonarcalDependencies.cmake
  DESTINATION ${SONARCAL_PACKAGE_DIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# `cpack -G DEB` in the build folder: the program with its manual pages, completion and guide. What it needs is
# read from the libraries that it links.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sonarcal)
set(CPACK_PACKAGE_CONTACT "The sonarcal authors <sonarcal@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "makes a simulated imaging sonar agree with a real one")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
  "Renders what a forward-looking imaging sonar should have seen of a scene,
measures how far that is from what it did see, and fits the simulator's
physical parameters until the two agree as well as the data allow.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-distributed")
set(CPACK_STRIP_FILES ON)
include(CPack)
