# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# Outside headers that most sources include, compiled once instead of for each: over a third of the time that a source
# takes. Where ccache is there it spares more, and finds fewer files again behind such headers: then this is off. Off by
# default, too, since only without it a build tells which include a source forgot.
option(KILTER_PRECOMPILE "Compile the most used outside headers once" OFF)
if(CMAKE_CXX_COMPILER_LAUNCHER)
  set(KILTER_PRECOMPILE OFF)
endif()

# kilter_precompile(TARGET HOST): what is in a host's headers is the same for all targets that take them, and so are
# their flags; the compiler refuses them otherwise.
function(kilter_precompile target host)
  if(KILTER_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${host})
    # Of libraries' code that comes from there g++ 12 sees overflows that it does not see in their headers.
    target_compile_options(${target} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow$<SEMICOLON>-Wno-array-bounds$<SEMICOLON>-Wno-maybe-uninitialized>)
  endif()
endfunction()

# kilter_precompile_host(NAME LINKS target... HEADERS header...)
function(kilter_precompile_host name)
  cmake_parse_arguments(H "" "" "LINKS;HEADERS" ${ARGN})
  if(NOT KILTER_PRECOMPILE)
    return()
  endif()
  set(source ${CMAKE_BINARY_DIR}/generated/${name}.cc)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Made by cmake/KilterPrecompile.cmake.\n")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE kilter_flags Eigen3::Eigen ${H_LINKS})
  target_precompile_headers(${name} PRIVATE <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <cstring> <deque>
    <filesystem> <functional> <map> <memory> <numeric> <optional> <set> <span> <string> <string_view> <tuple> <utility>
    <variant> <vector> ${H_HEADERS})
endfunction()

kilter_precompile_host(kilter_precompiled)
if(TARGET kilter_precompiled)
  set_target_properties(kilter_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()
if(KILTER_BUILD_TESTS)
  kilter_precompile_host(kilter_precompiled_tests LINKS GTest::gmock HEADERS <gmock/gmock.h> <gtest/gtest.h>)
  if(TARGET kilter_precompiled_tests)
    target_compile_options(kilter_precompiled_tests PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endif()
