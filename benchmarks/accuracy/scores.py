# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of merit of scores and probabilities, with intervals over missions."""
import numpy as np


def area(bad, good):
    """Area under the ROC curve of a score that should be larger for bad pairs; ties count half, nan where one is empty."""
    if not len(bad) or not len(good):
        return float("nan")
    ordered = np.sort(np.asarray(good, float))
    bad = np.asarray(bad, float)
    below = np.searchsorted(ordered, bad, "left")
    not_above = np.searchsorted(ordered, bad, "right")
    return float((0.5 * (below + not_above)).sum() / (len(bad) * len(good)))


def found_at(bad, good, false_share=0.01):
    """Share of bad pairs above the score that at most `false_share` of the good ones exceed."""
    if not len(bad) or not len(good):
        return float("nan")
    allowed = int(np.floor(false_share * len(good)))
    limit = np.sort(np.asarray(good, float))[::-1][allowed]
    return float((np.asarray(bad, float) > limit).mean())


def curve(bad, good):
    """(false positive share, true positive share) at every distinct score, from strict to lenient."""
    limits = np.unique(np.concatenate([bad, good]))[::-1]
    high_bad, high_good = np.sort(bad), np.sort(good)
    true = 1.0 - np.searchsorted(high_bad, limits, "left") / len(bad)
    false = 1.0 - np.searchsorted(high_good, limits, "left") / len(good)
    return np.concatenate([[0.0], false]), np.concatenate([[0.0], true])


def bootstrap(missions, figure, draws=500, seed=1):
    """2.5 and 97.5 % quantiles of figure(list of missions) when missions are drawn anew, with replacement."""
    rng = np.random.default_rng(seed)
    values = [figure([missions[i] for i in rng.integers(0, len(missions), len(missions))]) for _ in range(draws)]
    values = [value for value in values if np.isfinite(value)]
    return tuple(np.percentile(values, [2.5, 97.5])) if values else (float("nan"),) * 2


def wilson(found, of):
    """95 % interval of a share (Wilson 1927)."""
    if of == 0:
        return float("nan"), float("nan")
    z = 1.959964
    share = found / of
    middle = (share + z * z / (2 * of)) / (1 + z * z / of)
    half = z * np.sqrt(share * (1 - share) / of + z * z / (4 * of * of)) / (1 + z * z / of)
    return max(0.0, middle - half), min(1.0, middle + half)


def brier(p, above):
    return float(np.mean((np.asarray(p) - np.asarray(above, float)) ** 2))


def log_loss(log_odds, above, most=1e3):
    """Mean of -ln of the probability given to what was true; log odds are cut at +-most so that one lost pair counts as
    `most` and not as infinity."""
    signed = np.where(above, 1.0, -1.0) * np.clip(log_odds, -most, most)
    return float(np.mean(np.logaddexp(0.0, -signed)))


def calibration(p, above, bins=10):
    """Expected calibration error with equal-width bins, and the rows (bin's mean p, share above, count)."""
    p, above = np.asarray(p, float), np.asarray(above, float)
    at = np.minimum((p * bins).astype(int), bins - 1)
    rows = [(p[at == k].mean(), above[at == k].mean(), int((at == k).sum())) for k in range(bins) if (at == k).any()]
    return weighted_calibration(p, above, np.ones(len(p)), bins), rows


def discoveries(p_values, alpha=0.01):
    """Which of them Benjamini and Hochberg (1995) call discoveries at level alpha; nan is a test that was not made."""
    p = np.asarray(p_values, float)
    ordered = np.sort(p[np.isfinite(p)])
    passed = np.flatnonzero(ordered <= alpha * np.arange(1, len(ordered) + 1) / max(len(ordered), 1))
    return p <= ordered[passed[-1]] if len(passed) else np.zeros(len(p), bool)


def weighted_calibration(p, above, weights, bins=10):
    """Expected calibration error where each pair stands for `weights` of them."""
    p, above, weights = (np.asarray(some, float) for some in (p, above, weights))
    at = np.minimum((p * bins).astype(int), bins - 1)
    parts = [abs((weights * (p - above))[at == k].sum()) for k in range(bins)]
    return sum(parts) / weights.sum() if len(p) else float("nan")


def logistic_fit(features, above, ridge=1e-3, rounds=50):
    """Weights (last one the constant) of a logistic regression by Newton's method; the ridge spares the constant."""
    X = np.hstack([features, np.ones((len(features), 1))])
    w = np.zeros(X.shape[1])
    R = np.diag([ridge] * (len(w) - 1) + [1e-3])
    for _ in range(rounds):
        p = 1.0 / (1.0 + np.exp(-np.clip(X @ w, -30, 30)))
        H = (X * (p * (1 - p))[:, None]).T @ X + R
        w = w + np.linalg.solve(H, X.T @ (above - p) - R @ w)
    return w
