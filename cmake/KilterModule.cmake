# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
#
# kilter_module(NAME HEADERS ... SOURCES ... TESTS ... USES module... LINKS target... PRIVATE_LINKS target...)
#
# One folder, one target: static library kilter_NAME (alias kilter::NAME) and, when it has TESTS, one
# GoogleTest program kilter_NAME_test. USES names modules of lower floors (tools/check_layers.py checks the
# includes); LINKS and PRIVATE_LINKS name outside libraries.
function(kilter_module name)
  cmake_parse_arguments(M "" "" "HEADERS;SOURCES;TESTS;USES;LINKS;PRIVATE_LINKS" ${ARGN})
  set(target kilter_${name})
  add_library(${target} STATIC ${M_SOURCES} ${M_HEADERS})
  add_library(kilter::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set(uses ${M_USES})
  list(TRANSFORM uses PREPEND kilter::)
  target_link_libraries(${target} PUBLIC ${uses} ${M_LINKS} PRIVATE $<BUILD_INTERFACE:kilter_flags> ${M_PRIVATE_LINKS})
  set_property(GLOBAL APPEND PROPERTY KILTER_MODULES ${target})
  install(TARGETS ${target} EXPORT kilterTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  foreach(header IN LISTS M_HEADERS)
    install(FILES ${header} DESTINATION include/kilter/${name})
  endforeach()

  if(KILTER_BUILD_TESTS AND M_TESTS)
    add_executable(${target}_test ${M_TESTS})
    target_link_libraries(${target}_test PRIVATE ${target} $<BUILD_INTERFACE:kilter_flags> kilter_testing GTest::gmock GTest::gtest_main)
    set_target_properties(${target}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
    include(GoogleTest)
    gtest_discover_tests(${target}_test TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60 PROPERTIES LABELS unit)
  endif()
endfunction()
