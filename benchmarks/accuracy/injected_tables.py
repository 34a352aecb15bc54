# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Markdown tables of missions with injected errors, by size and by direction."""
import numpy as np

import scores
from tables import (ENOUGH_OVERLAP, by_group, configurations, count, displacement, number, print_table, published, rows_of,
                    share)


def print_all(answers):
    configurations(answers)
    table, by_direction = [], []
    groups = by_group(answers)

    def chosen(some, size=None, direction=None):
        rows = [r for a in some if (size is None or a["stamp"][2][:2] == list(size))
                and (direction is None or a["stamp"][2][2] == direction)
                for r in a["rows"] if r["fixed"] and r["overlap"] >= ENOUGH_OVERLAP]
        return [r for r in rows if r["across"]], [r for r in rows if r["same"]]

    sizes = sorted({tuple(a["stamp"][2][:2]) for a in answers})
    for name, some in groups.items():
        good = chosen(some)[1]
        for size in sizes:
            bad, _ = chosen(some, size, None)
            both = chosen([a for a in some if a["stamp"][2][2] in ("planar", "any")], size)[0]
            line = [name, f"{size[0]} m, {size[1]} rad", len(both)]
            for score in (published, displacement):
                line.append(share(scores.found_at([score(r) for r in both], [score(r) for r in good]), 1))
            line += [share(count(both, "inconsistent"), len(both)), share(count(both, "consistent"), len(both)),
                     len(good), share(count(good, "inconsistent"), len(good)), share(count(good, "consistent"), len(good))]
            table.append(line)
            for direction in sorted({a["stamp"][2][2] for a in some}):
                bad, _ = chosen(some, size, direction)
                if bad:
                    by_direction.append([name, f"{size[0]} m, {size[1]} rad", direction, len(bad),
                                         number(100 * float(np.median([r["rms_m"] for r in bad])), 1),
                                         share(scores.found_at([published(r) for r in bad], [published(r) for r in good]), 1),
                                         share(count(bad, "inconsistent"), len(bad)), share(count(bad, "consistent"), len(bad))])
    print("Pairs across one slip against pairs on one side of all, directions `planar` and `any`:\n")
    print_table(["mission", "error", "across", "TPR at 1 % FPR, log odds", "displacement alone", "inconsistent", "consistent",
                 "good", "inconsistent", "consistent"], table)
    print("By direction:\n")
    print_table(["mission", "error", "direction", "across", "median true cm", "TPR at 1 % FPR", "inconsistent", "consistent"],
                by_direction)
