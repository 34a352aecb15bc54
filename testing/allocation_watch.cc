// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "testing/allocation_watch.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <new>

namespace {

thread_local std::size_t largest = 0;
thread_local std::size_t left = std::numeric_limits<std::size_t>::max();

void* allocate(std::size_t size) {
  largest = std::max(largest, size);
  // Refused here, since sanitizers stop the program where a plain malloc says no.
  if (size > std::size_t{1} << 40 || left == 0) return nullptr;
  --left;
  return std::malloc(size == 0 ? 1 : size);
}

}  // namespace

namespace kilter_testing {

std::size_t& largest_allocation() { return largest; }
std::size_t& allocations_left() { return left; }

}  // namespace kilter_testing

void* operator new(std::size_t size) {
  if (void* block = allocate(size)) return block;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void operator delete(void* block) noexcept { std::free(block); }
void operator delete[](void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete[](void* block, std::size_t) noexcept { std::free(block); }
