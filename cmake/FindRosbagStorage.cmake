# librosbag-storage of ROS 1: target rosbag_storage::rosbag_storage.
#
# Debian's package has no CMake files, and its headers include those of plugins, each in a folder of its own.
include(FindPackageHandleStandardArgs)
find_library(ROSBAG_STORAGE_LIBRARY rosbag_storage)
find_path(ROSBAG_STORAGE_INCLUDE_DIR rosbag/chunked_file.h)
set(rosbag_storage_variables ROSBAG_STORAGE_LIBRARY ROSBAG_STORAGE_INCLUDE_DIR)
set(rosbag_storage_libraries)
foreach(library IN ITEMS class_loader roscpp_serialization rostime cpp_common console_bridge)
  find_library(ROSBAG_${library}_LIBRARY ${library})
  list(APPEND rosbag_storage_variables ROSBAG_${library}_LIBRARY)
  list(APPEND rosbag_storage_libraries ${ROSBAG_${library}_LIBRARY})
endforeach()
find_package_handle_standard_args(RosbagStorage REQUIRED_VARS ${rosbag_storage_variables}
  REASON_FAILURE_MESSAGE "Install librosbag-storage-dev or set SONARCAL_WITH_ROS=OFF")
if(RosbagStorage_FOUND AND NOT TARGET rosbag_storage::rosbag_storage)
  set(rosbag_storage_includes ${ROSBAG_STORAGE_INCLUDE_DIR})
  foreach(package IN ITEMS pluginlib class_loader rcpputils rcutils ament_index_cpp)
    if(IS_DIRECTORY ${ROSBAG_STORAGE_INCLUDE_DIR}/${package}/${package})
      list(APPEND rosbag_storage_includes ${ROSBAG_STORAGE_INCLUDE_DIR}/${package})
    endif()
  endforeach()
  add_library(rosbag_storage::rosbag_storage UNKNOWN IMPORTED)
  set_target_properties(rosbag_storage::rosbag_storage PROPERTIES
    IMPORTED_LOCATION ${ROSBAG_STORAGE_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES "${rosbag_storage_includes}"
    INTERFACE_LINK_LIBRARIES "${rosbag_storage_libraries}")
endif()
