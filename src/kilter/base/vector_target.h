// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Functions between KILTER_BEGIN_TARGET("avx2") and KILTER_END_TARGET are compiled for the named instructions, on the
// processors that the whole program is built for. Headers are included before the first.
#define KILTER_PRAGMA(text) _Pragma(#text)
#if defined(__clang__)
#define KILTER_BEGIN_TARGET(name) \
  KILTER_PRAGMA(clang attribute push(__attribute__((target(name))), apply_to = function))
#define KILTER_END_TARGET KILTER_PRAGMA(clang attribute pop)
#else
#define KILTER_BEGIN_TARGET(name) KILTER_PRAGMA(GCC push_options) KILTER_PRAGMA(GCC target(name))
#define KILTER_END_TARGET KILTER_PRAGMA(GCC pop_options)
#endif
