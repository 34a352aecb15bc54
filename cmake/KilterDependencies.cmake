# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# Everything comes from the distribution; the same file serves our build and find_package(kilter).
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(tl-expected REQUIRED)
find_package(Threads REQUIRED)
find_package(Boost 1.74 REQUIRED)
