# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
include(CMakePackageConfigHelpers)
configure_package_config_file(cmake/kilterConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/kilterConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kilter)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/kilterConfigVersion.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/kilterConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/kilterConfigVersion.cmake
              cmake/KilterDependencies.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kilter)
install(EXPORT kilterTargets NAMESPACE kilter:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kilter)
