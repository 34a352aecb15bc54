// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace kilter {

/// report.html: one page with everything inside, that opens from disk and asks nothing of any network.
///
/// \param archive  the bytes of a whole result.kilter; they go in packed and in base64, so no name in them is ever
///                 read as HTML.
/// Equal archives give equal bytes. Where kilter was built without its viewer, the page says so and how to get one.
[[nodiscard]] std::string report_html(std::string_view archive);

}  // namespace kilter
