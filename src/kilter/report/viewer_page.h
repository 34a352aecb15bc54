// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace kilter {

/// The report's page with its script and style inside, and the marks @PALETTE@ and @ARCHIVE@ where data go; built from
/// viewer/. Empty where kilter was built without it.
[[nodiscard]] std::string viewer_page();

}  // namespace kilter
