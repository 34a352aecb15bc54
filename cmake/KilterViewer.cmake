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
# Several builds share node_modules, so it is only made when it is older than the list of packages.
add_custom_command(OUTPUT ${packages}
  COMMAND ${KILTER_NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
  COMMAND ${CMAKE_COMMAND} -E touch ${packages}
  DEPENDS ${viewer}/package-lock.json
  WORKING_DIRECTORY ${viewer}
  COMMENT "Installing what the viewer is made of (npm ci); -DKILTER_VIEWER=OFF builds without it"
  VERBATIM)
add_custom_command(OUTPUT ${KILTER_VIEWER_SOURCE} BYPRODUCTS ${PROJECT_BINARY_DIR}/viewer/page.html
  COMMAND ${KILTER_NODE} node_modules/typescript/bin/tsc --noEmit
  COMMAND ${KILTER_NODE} build.mjs ${PROJECT_BINARY_DIR}/viewer/page.html ${KILTER_VIEWER_SOURCE}
  DEPENDS ${packages} ${viewer_files} ${viewer}/build.mjs ${viewer}/tsconfig.json
  WORKING_DIRECTORY ${viewer}
  COMMENT "Bundling the viewer"
  VERBATIM)
