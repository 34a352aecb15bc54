# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether covariances say how far registrations are off."""
import numpy as np

AXES = ("short", "middle", "long", "about short", "about middle", "about long")
CHI2_95 = (3.841, 5.991, 7.815, 9.488, 11.070, 12.592)
CLEARLY_FIXED = 0.9  # of a unit twist along an axis, for it to count as observable


def basis_of(projector):
    values, vectors = np.linalg.eigh(projector)
    return vectors[:, values > 0.5]


def is_inside(row):
    """Whether a row's truth lies in the 95 % ellipsoid, on what the scene fixes."""
    s, S, P = (np.array(row[key]) for key in ("s", "S", "projector"))
    F = basis_of(P)
    z, Z = F.T @ s, F.T @ S @ F
    return F.shape[1] == 0 or float(z @ np.linalg.solve(Z, z)) <= CHI2_95[F.shape[1] - 1]


def calibration(rows):
    """For rows with s, S and projector: NEES per degree of freedom over all and per axis (None where no pair fixes it),
    share of truths inside the 95 % ellipsoid, and its median volume over that of the empirical error's."""
    nees, inside = [], []
    per_axis = [[] for _ in AXES]
    by_rank = {}
    for row in rows:
        s, S, P = (np.array(row[key]) for key in ("s", "S", "projector"))
        F = basis_of(P)
        rank = F.shape[1]
        if rank == 0:
            continue
        z, Z = F.T @ s, F.T @ S @ F
        square = float(z @ np.linalg.solve(Z, z))
        nees.append(square / rank)
        inside.append(square <= CHI2_95[rank - 1])
        for k in range(6):
            if P[k, k] >= CLEARLY_FIXED:
                along = P[:, k]
                per_axis[k].append(float((along @ s) ** 2 / (along @ S @ along)))
        by_rank.setdefault(rank, []).append((P @ s, np.linalg.slogdet(Z)[1]))
    volumes = []
    for rank, some in by_rank.items():
        if len(some) < 4 * rank:
            continue
        errors = np.array([error for error, _ in some])
        scatter = np.linalg.eigvalsh(errors.T @ errors / len(errors))[-rank:]
        volumes.append((len(some), np.exp(0.5 * (np.median([log_volume for _, log_volume in some]) - np.log(scatter).sum()))))
    return {"pairs": len(nees), "nees": mean(nees), "median_nees": float(np.median(nees)) if nees else None,
            "axes": [mean(values) if len(values) >= 10 else None for values in per_axis],
            "inside_95": mean(inside), "volume": max(volumes)[1] if volumes else None}


def mean(values):
    return float(np.mean(values)) if len(values) else None
