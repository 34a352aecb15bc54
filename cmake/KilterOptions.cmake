# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# Build options and the flags shared by every target of ours.
option(KILTER_BUILD_TESTS "Build unit and integration tests" ${PROJECT_IS_TOP_LEVEL})
option(KILTER_BUILD_FUZZ "Build libFuzzer targets (clang only)" OFF)
option(KILTER_BENCHMARK_OTHERS "Compare with PCL, Open3D and others in benchmarks, where installed" OFF)
option(KILTER_WARNINGS_AS_ERRORS "Treat warnings as errors" ${PROJECT_IS_TOP_LEVEL})
option(KILTER_HARDENING "Compile and link with the hardening flags of a distribution" ON)
set(KILTER_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
option(KILTER_COVERAGE "Instrument for line coverage" OFF)

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
if(PROJECT_IS_TOP_LEVEL)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
  include(CheckPIESupported)
  check_pie_supported()
  find_program(KILTER_CCACHE ccache)
  if(KILTER_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${KILTER_CCACHE})
  endif()
endif()

# Bits must not depend on the optimiser's mood: no fused multiply-add contraction, no fast-math.
add_library(kilter_flags INTERFACE)
target_compile_features(kilter_flags INTERFACE cxx_std_20)
target_compile_options(kilter_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off
  $<$<BOOL:${KILTER_WARNINGS_AS_ERRORS}>:-Werror>)
# Eigen asks the processor for fused operations by name, where this says that it has them: on 64-bit ARM always.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  target_compile_options(kilter_flags INTERFACE -U__ARM_FEATURE_FMA)
endif()
# g++ 12 reports overlapping copies inside std::string that cannot happen (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(kilter_flags INTERFACE -Wno-restrict)
endif()
if(KILTER_SANITIZE)
  target_compile_options(kilter_flags INTERFACE
    -fsanitize=${KILTER_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # What sanitizers add to the code leads g++ to see overflows and unset values in libraries' headers.
  target_compile_options(kilter_flags INTERFACE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow$<SEMICOLON>-Wno-array-bounds$<SEMICOLON>-Wno-maybe-uninitialized>)
  target_link_options(kilter_flags INTERFACE -fsanitize=${KILTER_SANITIZE})
endif()
if(KILTER_BUILD_FUZZ)
  target_compile_options(kilter_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(KILTER_COVERAGE)
  target_compile_options(kilter_flags INTERFACE --coverage -fprofile-update=atomic)
  target_link_options(kilter_flags INTERFACE --coverage)
endif()

# Files are not to be trusted, so what reads them is built like a distribution builds its services. Sanitizers bring
# their own checks and do not go with _FORTIFY_SOURCE; undefined first, since some distributions define it already.
add_library(kilter_hardened_link INTERFACE)
if(KILTER_HARDENING AND NOT KILTER_SANITIZE AND NOT KILTER_COVERAGE)
  include(CheckCXXCompilerFlag)
  check_cxx_compiler_flag(-fcf-protection KILTER_HAS_CF_PROTECTION)
  check_cxx_compiler_flag(-fstack-clash-protection KILTER_HAS_STACK_CLASH_PROTECTION)
  target_compile_options(kilter_flags INTERFACE -fstack-protector-strong
    $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE$<SEMICOLON>-D_FORTIFY_SOURCE=3>
    $<$<BOOL:${KILTER_HAS_CF_PROTECTION}>:-fcf-protection>
    $<$<BOOL:${KILTER_HAS_STACK_CLASH_PROTECTION}>:-fstack-clash-protection>)
  target_link_options(kilter_hardened_link INTERFACE LINKER:-z,relro,-z,now,-z,noexecstack)
endif()
