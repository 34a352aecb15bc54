# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# Builds on another machine for 64-bit ARM, preset `aarch64`. scripts/cross makes the folder with that machine's
# libraries; what was built runs in qemu-user, where that is installed.
set(KILTER_AARCH64_ROOT ${CMAKE_CURRENT_LIST_DIR}/../build-aarch64/root CACHE PATH "64-bit ARM's libraries and headers")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES KILTER_AARCH64_ROOT)
cmake_path(SET CMAKE_SYSROOT NORMALIZE "${KILTER_AARCH64_ROOT}")
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
find_program(KILTER_QEMU_AARCH64 NAMES qemu-aarch64 qemu-aarch64-static)
if(KILTER_QEMU_AARCH64)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${KILTER_QEMU_AARCH64} -L ${CMAKE_SYSROOT})
endif()
# Tests are listed when they run: without qemu-user they can still be built.
set(CMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE PRE_TEST)
