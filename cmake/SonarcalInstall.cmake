# Install rules: the rooms as libraries with their headers, the command, and a package that
# find_package(sonarcal) finds. Headers keep their paths: #include "sim/trace.h" works in both places.
include(CMakePackageConfigHelpers)

set(SONARCAL_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/sonarcal)

get_property(SONARCAL_LIBRARIES GLOBAL PROPERTY SONARCAL_LIBRARIES)
install(TARGETS ${SONARCAL_LIBRARIES} EXPORT sonarcalTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY data_io metrics sim calib
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sonarcal
  FILES_MATCHING PATTERN "*.h")
if(SONARCAL_BUILD_APPS)
  install(TARGETS sonarcal RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
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
  cmake/SonarcalDependencies.cmake
  DESTINATION ${SONARCAL_PACKAGE_DIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
