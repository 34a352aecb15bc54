# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# Others' libraries, judges in tests and opponents in benchmarks; the program never links them. They are found by the
# names of their files: the CMake packages that Debian ships for PCL (VTK, MPI) and rosbag (pluginlib, ament) ask for
# languages and Python modules that reading a file needs none of.

# kilter_find_other(NAME HEADERS header... [FOLDERS folder...] LIBRARIES library...)
# Makes the target kilter_NAME, or none where something of it is not installed. FOLDERS are tried below /usr/include.
function(kilter_find_other name)
  cmake_parse_arguments(T "" "" "HEADERS;FOLDERS;LIBRARIES" ${ARGN})
  if(TARGET kilter_${name})
    return()
  endif()
  set(includes)
  set(libraries)
  foreach(header IN LISTS T_HEADERS)
    string(MAKE_C_IDENTIFIER KILTER_${name}_${header} variable)
    find_path(${variable} ${header} PATH_SUFFIXES ${T_FOLDERS})
    list(APPEND includes ${${variable}})
  endforeach()
  foreach(library IN LISTS T_LIBRARIES)
    find_library(KILTER_${name}_${library} ${library})
    list(APPEND libraries ${KILTER_${name}_${library}})
  endforeach()
  if("${includes};${libraries}" MATCHES "NOTFOUND")
    return()
  endif()
  add_library(kilter_${name} INTERFACE IMPORTED GLOBAL)
  target_include_directories(kilter_${name} SYSTEM INTERFACE ${includes})
  target_link_libraries(kilter_${name} INTERFACE ${libraries} Eigen3::Eigen)
endfunction()

# Debian: libpcl-dev; the folder carries the version.
function(kilter_find_pcl)
  kilter_find_other(pcl HEADERS pcl/io/pcd_io.h FOLDERS pcl-1.15 pcl-1.14 pcl-1.13 pcl-1.12
    LIBRARIES pcl_io pcl_io_ply pcl_common)
endfunction()

# Debian: libpcl-dev again.
function(kilter_find_pcl_kdtree)
  kilter_find_other(pcl_kdtree HEADERS pcl/kdtree/kdtree_flann.h flann/flann.hpp
    FOLDERS pcl-1.15 pcl-1.14 pcl-1.13 pcl-1.12 LIBRARIES pcl_kdtree pcl_common flann_cpp lz4)
endfunction()

# Debian: libdynamicedt3d-dev.
function(kilter_find_dynamic_edt)
  kilter_find_other(dynamic_edt HEADERS dynamicEDT3D/dynamicEDTOctomap.h LIBRARIES dynamicedt3d octomap octomath)
endfunction()

# Debian: libopen3d-dev.
function(kilter_find_open3d)
  kilter_find_other(open3d HEADERS open3d/io/PointCloudIO.h LIBRARIES Open3D fmt)
endfunction()

# Debian: librosbag-storage-dev libsensor-msgs-dev libnav-msgs-dev libtf2-msgs-dev.
function(kilter_find_rosbag)
  kilter_find_other(rosbag
    HEADERS rosbag/bag.h pluginlib/class_loader.hpp class_loader/class_loader.hpp rcutils/logging_macros.h
      rcpputils/asserts.hpp ament_index_cpp/get_package_prefix.hpp
    FOLDERS pluginlib class_loader rcutils rcpputils ament_index_cpp
    LIBRARIES rosbag_storage roscpp_serialization rostime cpp_common console_bridge class_loader rcutils)
endfunction()
