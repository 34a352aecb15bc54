# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""How much of what no rigid motion mends is seen: the bend of a pair as measured against the truth's."""
import numpy as np

import ablation

EDGES_M = (0.0, 0.03, 0.05, 0.08, 0.15, 0.3, 10.0)
FEWEST = 8  # pairs of a row
NOT_BELIEVED = ("ask for another correction", "no registration around it confirms", "ambiguous", "lost overlap",
                "still conflicts", "agrees no better", "conflicts more there")


def rows_of(rows, least_overlap):
    """(range in cm, pairs, true RMS in cm, measured RMS in cm, median of measured / true) of pairs whose pose the scene
    fixes and whose registration is believed, by true bend."""
    seen = [r for r in rows if r["fixed"] and r["overlap"] >= least_overlap and r.get("pieces")
            and ablation.value(r, "bend_m") is not None and not any(words in r["reason"] for words in NOT_BELIEVED)]
    for low, high in zip(EDGES_M, EDGES_M[1:]):
        some = [r for r in seen if low <= r["bend_m"] < high]
        if len(some) < FEWEST:
            continue
        true = np.array([r["bend_m"] for r in some])
        said = np.array([ablation.value(r, "bend_m") for r in some])
        yield (f"{100 * low:.0f} to {100 * high:.0f}", len(some), f"{100 * np.sqrt((true**2).mean()):.1f}",
               f"{100 * np.sqrt((said**2).mean()):.1f}", f"{np.median(said / true):.2f}")
