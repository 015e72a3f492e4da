# Every third-party package in one place. The same file is used by the installed package
# (cmake/sonarcalConfig.cmake.in), so a consumer finds what the build found.
include(CMakeFindDependencyMacro)

find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(fmt)
find_dependency(nlohmann_json 3.11)
find_dependency(OpenCV COMPONENTS core imgproc imgcodecs calib3d aruco)
find_dependency(OpenSSL)
find_dependency(PNG)
find_dependency(TIFF)
find_dependency(ZLIB)
find_dependency(TinyGLTF)
find_dependency(assimp 5.2)
# Debian's package names what a static assimp would link (draco, minizip) and does not depend on it.
set_target_properties(assimp::assimp PROPERTIES INTERFACE_LINK_LIBRARIES "")
find_dependency(TBB)
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_dependency(embree 3)
endif()
find_dependency(Ceres 2.1)
