// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cassert>

/// A documented precondition. Broken contracts are defects of the caller, not events of the world.
#define KILTER_EXPECTS(condition) assert(condition)
