// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Functions between KILTER_BEGIN_TARGET("avx2") and KILTER_END_TARGET are compiled for the named instructions, on the
// processors that the whole program is built for. Headers are included before the first. What is named here,
// vector_path.cc asks the processor for.
#define KILTER_PRAGMA(text) _Pragma(#text)
#if defined(__clang__)
#define KILTER_BEGIN_TARGET(name) \
  KILTER_PRAGMA(clang attribute push(__attribute__((target(name))), apply_to = function))
#define KILTER_END_TARGET KILTER_PRAGMA(clang attribute pop)
#else
#define KILTER_BEGIN_TARGET(name) KILTER_PRAGMA(GCC push_options) KILTER_PRAGMA(GCC target(name))
#define KILTER_END_TARGET KILTER_PRAGMA(GCC pop_options)
#endif

// What is called `name` in that of the namespaces baseline, avx2 and avx512 which a VectorPath stands for; the latter
// two are there on x86-64 alone.
#if defined(__x86_64__)
#define KILTER_OF_PATH(path, name) \
  ((path) == VectorPath::kAvx512 ? avx512::name : (path) == VectorPath::kAvx2 ? avx2::name : baseline::name)
#else
#define KILTER_OF_PATH(path, name) (static_cast<void>(path), baseline::name)
#endif
