# Every third-party package in one place. The same file is used by the installed package
# (cmake/sonarcalConfig.cmake.in), so a consumer finds what the build found.
include(CMakeFindDependencyMacro)

find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(fmt)
find_dependency(nlohmann_json 3.11)
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
# Debian's package asks for more of ROS than the one class of librosbag that is used.
find_library(ROSBAG_STORAGE_LIBRARY rosbag_storage REQUIRED)
find_path(ROSBAG_STORAGE_INCLUDE_DIR rosbag/chunked_file.h REQUIRED)
if(NOT TARGET rosbag_storage::rosbag_storage)
  add_library(rosbag_storage::rosbag_storage UNKNOWN IMPORTED)
  set_target_properties(rosbag_storage::rosbag_storage PROPERTIES
    IMPORTED_LOCATION ${ROSBAG_STORAGE_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${ROSBAG_STORAGE_INCLUDE_DIR})
endif()
find_dependency(TBB)
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_dependency(embree 3)
endif()
find_dependency(Ceres 2.1)
