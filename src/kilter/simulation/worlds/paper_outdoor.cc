// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/worlds/worlds.h"
namespace kilter {
Scene make_paper_outdoor(const SceneOptions& options) { return make_carpark(options); }
}  // namespace kilter
