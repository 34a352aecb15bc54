# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
#
# kilter_module(NAME HEADERS ... SOURCES ... TESTS ... USES module... LINKS target... PRIVATE_LINKS target...)
#
# One folder, one target: static library kilter_NAME (alias kilter::NAME) and, when it has TESTS, one
# GoogleTest program kilter_NAME_test. HEADERS are installed and must compile alone: one with a source of its name does,
# since that includes it first (tools/check_tree.py asks), the others are compiled by a test (tests/CMakeLists.txt). A
# header that only the module itself needs is listed under SOURCES. USES names modules of lower floors
# (tools/check_layers.py checks the includes); LINKS and PRIVATE_LINKS name outside libraries.
function(kilter_module name)
  cmake_parse_arguments(M "" "" "HEADERS;SOURCES;TESTS;USES;LINKS;PRIVATE_LINKS" ${ARGN})
  set(target kilter_${name})
  add_library(${target} STATIC ${M_SOURCES})
  add_library(kilter::${name} ALIAS ${target})
  set(alone ${M_HEADERS})
  foreach(source IN LISTS M_SOURCES)
    string(REGEX REPLACE "[.]cc$" ".h" header ${source})
    list(REMOVE_ITEM alone ${header})
  endforeach()
  set(with_source ${M_HEADERS})
  list(REMOVE_ITEM with_source ${alone})
  target_sources(${target} PUBLIC
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${with_source}
    FILE_SET without_source TYPE HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${alone})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
    VERIFY_INTERFACE_HEADER_SETS ${KILTER_BUILD_TESTS} INTERFACE_HEADER_SETS_TO_VERIFY without_source)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set(uses ${M_USES})
  list(TRANSFORM uses PREPEND kilter::)
  target_link_libraries(${target} PUBLIC ${uses} ${M_LINKS} PRIVATE $<BUILD_INTERFACE:kilter_flags> ${M_PRIVATE_LINKS})
  kilter_precompile(${target} kilter_precompiled)
  set_property(GLOBAL APPEND PROPERTY KILTER_MODULES ${target})
  install(TARGETS ${target} EXPORT kilterTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    FILE_SET without_source DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

  if(KILTER_BUILD_TESTS AND M_TESTS)
    add_executable(${target}_test ${M_TESTS})
    target_compile_options(${target}_test PRIVATE $<$<CONFIG:Release>:-O1>)  # up to two fifths less to compile than with -O3
    target_link_libraries(${target}_test PRIVATE ${target} $<BUILD_INTERFACE:kilter_flags> kilter_testing GTest::gmock GTest::gtest_main)
    kilter_precompile(${target}_test kilter_precompiled_tests)
    set_target_properties(${target}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
    include(GoogleTest)
    gtest_discover_tests(${target}_test TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
      PROPERTIES LABELS unit TIMEOUT 1200 ENVIRONMENT "KILTER_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
  endif()
endfunction()

# kilter_program(NAME SOURCES ... USES module... LINKS target...)
#
# A program for users: hardened, written to the top of the build folder, installed to bin.
function(kilter_program name)
  cmake_parse_arguments(P "" "" "SOURCES;USES;LINKS" ${ARGN})
  add_executable(${name} ${P_SOURCES})
  set(uses ${P_USES})
  list(TRANSFORM uses PREPEND kilter::)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${uses} ${P_LINKS} kilter_flags kilter_hardened_link)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# kilter_fuzz(NAME SOURCES ... USES module... LINKS target...)
#
# With KILTER_BUILD_FUZZ a libFuzzer target kilter_NAME_fuzz in build-fuzz/fuzz; its seeds are the files of
# fuzz/corpus/NAME, its words those of fuzz/dictionaries/NAME.dict. Else a test corpus.NAME that tries its seeds.
function(kilter_fuzz name)
  cmake_parse_arguments(F "" "" "SOURCES;USES;LINKS" ${ARGN})
  set(uses ${F_USES})
  list(TRANSFORM uses PREPEND kilter::)
  if(KILTER_BUILD_FUZZ)
    set(target kilter_${name}_fuzz)
    add_executable(${target} ${F_SOURCES})
    target_link_options(${target} PRIVATE -fsanitize=fuzzer)
  else()
    set(target kilter_${name}_replay)
    add_executable(${target} ${F_SOURCES} replay.cc)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    add_test(NAME corpus.${name} COMMAND ${target} ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name})
    set_tests_properties(corpus.${name} PROPERTIES LABELS unit TIMEOUT 300)
  endif()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${target} PRIVATE ${uses} ${F_LINKS} kilter_flags)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
endfunction()
