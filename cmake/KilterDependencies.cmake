# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# Everything comes from the distribution; the same file serves our build and find_package(kilter).
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(tl-expected REQUIRED)
find_package(Threads REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(ZLIB REQUIRED)

# Not every distribution's liblzf brings a CMake or pkg-config file.
if(NOT TARGET LZF::LZF)
  find_path(LZF_INCLUDE_DIR liblzf/lzf.h REQUIRED)
  find_library(LZF_LIBRARY lzf REQUIRED)
  mark_as_advanced(LZF_INCLUDE_DIR LZF_LIBRARY)
  add_library(LZF::LZF UNKNOWN IMPORTED)
  set_target_properties(LZF::LZF PROPERTIES
    IMPORTED_LOCATION "${LZF_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${LZF_INCLUDE_DIR}")
endif()
# Bags are packed with these and stored in SQLite. Not every distribution's brings a CMake file.
find_package(BZip2 REQUIRED)
find_package(SQLite3 REQUIRED)
foreach(packing LZ4:lz4frame.h:lz4 ZSTD:zstd.h:zstd)
  string(REPLACE ":" ";" packing "${packing}")
  list(GET packing 0 name)
  list(GET packing 1 header)
  list(GET packing 2 library)
  if(NOT TARGET ${name}::${name})
    find_path(${name}_INCLUDE_DIR ${header} REQUIRED)
    find_library(${name}_LIBRARY ${library} REQUIRED)
    mark_as_advanced(${name}_INCLUDE_DIR ${name}_LIBRARY)
    add_library(${name}::${name} UNKNOWN IMPORTED)
    set_target_properties(${name}::${name} PROPERTIES
      IMPORTED_LOCATION "${${name}_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${${name}_INCLUDE_DIR}")
  endif()
endforeach()
# Optional: the simulator casts its rays with it. Debian 12 has Embree 3, Ubuntu 24.04 has Embree 4.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 QUIET)
endif()
