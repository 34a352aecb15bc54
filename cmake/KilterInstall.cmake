# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# After `cmake --install`, find_package(kilter) offers kilter::MODULE for each module and kilter::kilter for all.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kilter)

get_property(modules GLOBAL PROPERTY KILTER_MODULES)
add_library(kilter_everything INTERFACE)
add_library(kilter::kilter ALIAS kilter_everything)
set_target_properties(kilter_everything PROPERTIES EXPORT_NAME kilter)
target_link_libraries(kilter_everything INTERFACE ${modules})
install(TARGETS kilter_everything EXPORT kilterTargets)

configure_package_config_file(cmake/kilterConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/kilterConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/kilterConfigVersion.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/kilterConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/kilterConfigVersion.cmake
              cmake/KilterDependencies.cmake
  DESTINATION ${package_dir})
install(EXPORT kilterTargets NAMESPACE kilter:: DESTINATION ${package_dir})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
