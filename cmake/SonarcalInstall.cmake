# Install rules: the libraries with their headers, the command, and a package that
# find_package(sonarcal) finds. Headers keep their paths: #include "sim/rays/trace.h" works in both places.
include(CMakePackageConfigHelpers)

set(SONARCAL_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/sonarcal)

get_property(SONARCAL_LIBRARIES GLOBAL PROPERTY SONARCAL_LIBRARIES)
install(TARGETS ${SONARCAL_LIBRARIES} EXPORT sonarcalTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY core data_io metrics sim calib
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sonarcal COMPONENT development
  FILES_MATCHING PATTERN "*.h")
if(SONARCAL_BUILD_APPS)
  install(DIRECTORY apps/workflow
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sonarcal/apps COMPONENT development
    FILES_MATCHING PATTERN "*.h")
  install(TARGETS sonarcal RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  include(SonarcalDocumentation)
endif()
install(EXPORT sonarcalTargets NAMESPACE sonarcal:: DESTINATION ${SONARCAL_PACKAGE_DIR}
  COMPONENT development)

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
  cmake/FindZstd.cmake
  cmake/SonarcalDependencies.cmake
  DESTINATION ${SONARCAL_PACKAGE_DIR} COMPONENT development)
install(FILES LICENSE THIRD_PARTY_NOTICES.md ${PROJECT_BINARY_DIR}/sonarcal.spdx.json
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)

include(SonarcalPackages)
