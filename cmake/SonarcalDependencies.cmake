# Every third-party package in one place. The same file is used by the installed package
# (cmake/sonarcalConfig.cmake.in), so a consumer finds what the build found.
include(CMakeFindDependencyMacro)

find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(fmt)
find_dependency(nlohmann_json 3.11)
find_dependency(LibArchive)
find_dependency(OpenCV COMPONENTS core imgproc imgcodecs videoio calib3d aruco)
find_dependency(OpenSSL)
find_dependency(PNG)
find_dependency(SQLite3)
find_dependency(TIFF)
find_dependency(ZLIB)
find_dependency(TinyGLTF)
find_dependency(pugixml)
find_dependency(yaml-cpp)
find_dependency(assimp 5.2)
# Debian's package names what a static assimp would link (draco, minizip) and does not depend on it.
set_target_properties(assimp::assimp PROPERTIES INTERFACE_LINK_LIBRARIES "")
# Debian's package has no CMake files for what is used of ROS 1, and its headers include those of plugins, each
# in a folder of its own.
find_library(ROSBAG_STORAGE_LIBRARY rosbag_storage REQUIRED)
find_path(ROSBAG_STORAGE_INCLUDE_DIR rosbag/chunked_file.h REQUIRED)
set(sonarcal_rosbag_includes ${ROSBAG_STORAGE_INCLUDE_DIR})
foreach(package IN ITEMS pluginlib class_loader rcpputils rcutils ament_index_cpp)
  if(IS_DIRECTORY ${ROSBAG_STORAGE_INCLUDE_DIR}/${package}/${package})
    list(APPEND sonarcal_rosbag_includes ${ROSBAG_STORAGE_INCLUDE_DIR}/${package})
  endif()
endforeach()
set(sonarcal_rosbag_libraries)
foreach(library IN ITEMS class_loader roscpp_serialization rostime cpp_common console_bridge)
  find_library(ROSBAG_${library}_LIBRARY ${library} REQUIRED)
  list(APPEND sonarcal_rosbag_libraries ${ROSBAG_${library}_LIBRARY})
endforeach()
if(NOT TARGET rosbag_storage::rosbag_storage)
  add_library(rosbag_storage::rosbag_storage UNKNOWN IMPORTED)
  set_target_properties(rosbag_storage::rosbag_storage PROPERTIES
    IMPORTED_LOCATION ${ROSBAG_STORAGE_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES "${sonarcal_rosbag_includes}"
    INTERFACE_LINK_LIBRARIES "${sonarcal_rosbag_libraries}")
endif()
find_dependency(TBB)
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_dependency(embree 3)
endif()
find_dependency(Ceres 2.1)
