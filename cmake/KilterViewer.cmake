# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# The report's page: viewer/ type-checked, bundled and written as a C++ source, KILTER_VIEWER_SOURCE. Without node and
# npm, or with -DKILTER_VIEWER=OFF, it is empty and report.html only says so.
option(KILTER_VIEWER "Build the viewer of report.html (needs node 18 and npm)" ON)
set(KILTER_VIEWER_SOURCE)
if(NOT KILTER_VIEWER)
  return()
endif()
find_program(KILTER_NODE node)
find_program(KILTER_NPM npm)
if(NOT KILTER_NODE OR NOT KILTER_NPM)
  message(WARNING "node and npm were not found: kilter is built without the viewer, and report.html will only say so. "
    "Install them (Debian: nodejs npm), or hush this with -DKILTER_VIEWER=OFF.")
  return()
endif()

set(viewer ${PROJECT_SOURCE_DIR}/viewer)
set(packages ${viewer}/node_modules/.package-lock.json)
file(GLOB viewer_files CONFIGURE_DEPENDS ${viewer}/src/*)
set(KILTER_VIEWER_SOURCE ${PROJECT_BINARY_DIR}/viewer/viewer_page.cc)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/viewer)
# Several builds share node_modules, so it is only made when it is older than the list of packages. Here and not while
# building: where the packages cannot be had (no network), kilter is still built.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${viewer}/package-lock.json)
if(${viewer}/package-lock.json IS_NEWER_THAN ${packages})
  message(STATUS "Installing what the viewer is made of (npm ci)")
  execute_process(COMMAND ${KILTER_NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
    WORKING_DIRECTORY ${viewer} RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE words)
  if(NOT status EQUAL 0)
    set(KILTER_VIEWER_SOURCE)
    message(WARNING "npm ci could not fetch what the viewer is made of: kilter is built without it, and report.html will "
      "only say so. Configure again once npm can (hush this with -DKILTER_VIEWER=OFF). Its words:\n${words}")
    return()
  endif()
  file(TOUCH ${packages})
endif()
add_custom_command(OUTPUT ${KILTER_VIEWER_SOURCE} BYPRODUCTS ${PROJECT_BINARY_DIR}/viewer/page.html
  COMMAND ${KILTER_NODE} node_modules/typescript/bin/tsc --noEmit
  COMMAND ${KILTER_NODE} build.mjs ${PROJECT_BINARY_DIR}/viewer/page.html ${KILTER_VIEWER_SOURCE}
  DEPENDS ${packages} ${viewer_files} ${viewer}/build.mjs ${viewer}/tsconfig.json
  WORKING_DIRECTORY ${viewer}
  COMMENT "Bundling the viewer"
  VERBATIM)
set_property(GLOBAL PROPERTY KILTER_HAS_VIEWER TRUE)
