# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""What each piece of evidence is worth: pairs decided again from what result.json says of them, without one piece.

The rules are those of docs/verdicts.md on one pair: `inconsistent` above 99 % (by free space alone: at p below 1 %),
`consistent` below 5 %, and what makes the registration doubtful in between. Shares so differ a little from the program's,
which holds false discoveries over the whole map and knows the spread behind each null; the table's first row shows how
much.
"""
import math

TOLERANCE_M = 0.10
SURE = math.log(0.99 / 0.01)
PRIOR = math.log(0.05 / 0.95)

PIECES = ("bend", "neighbours", "ambiguity", "kept overlap", "conflict once registered", "gain of support",
          "sides seen by both", "free space alone", "conflict that a motion mends", "a better fit elsewhere",
          "believed neighbours")
OF_NEIGHBOURS = ("neighbours", "believed neighbours")
WHATEVER_IT_IS = 0.25  # share of conflict, above the typical, that needs no motion to speak


def value(row, name, key="value"):
    return row["pieces"].get(name, {}).get(key)


def free_space(row, without):
    """How strongly free space speaks, if it does."""
    said = value(row, "conflict", "log_ratio")
    if said is None or without == "free space alone":
        return None
    mended = value(row, "conflict") - (value(row, "conflict", "null") or 0.0) < WHATEVER_IT_IS
    return None if mended and without == "conflict that a motion mends" else said


def log_odds(row, without=""):
    """Of a disagreement above the tolerance, at the prior; 0 where nothing was measured. What a doubt bounds is told by the
    displacement alone once the doubt is taken away."""
    believed = without == "bend" or (without and doubts(row) == {without})
    said = value(row, "displacement" if believed else "disagreement", "log_ratio")
    alone = free_space(row, without)
    neighbours = value(row, "agreeing", "log_ratio") if said is None and without not in OF_NEIGHBOURS else None
    ratios = [ratio for ratio in (said, alone, neighbours) if ratio is not None]
    return max(ratios) + PRIOR if ratios else 0.0


def support_grew(row):
    start, end = value(row, "support"), value(row, "support", "null")
    before, after = value(row, "conflict") or 0.0, value(row, "conflict_registered") or 0.0
    if after > 1.5 * before:
        return False
    gone = before - after >= 0.002 and after <= 0.5 * before  # and not by chance, which result.json cannot tell
    factor = 3.0 if after > 1.1 * before else 1.1 if gone else 1.3
    return end - factor * start > 3.0 * math.sqrt(end + factor * factor * start)


def doubts(row):
    """Pieces of evidence that forbid to believe the registration."""
    found = set()
    moved = value(row, "displacement") > TOLERANCE_M
    if "ask for another correction" in row["reason"] or "no registration around it confirms" in row["reason"]:
        found.add("neighbours")
    if (value(row, "ambiguity") or 0.0) > 0.7 and (value(row, "agreeing") or 0.0) < 2:
        found.add("ambiguity")
    if "registration lost overlap" in row["reason"]:
        found.add("kept overlap")
    bent = (value(row, "bend_m") or 0.0) > TOLERANCE_M
    after, typical = value(row, "conflict_registered"), value(row, "conflict_registered", "null")
    asked = not found  # a reason names the first doubt; how widely conflict is spread over the map it does not say
    high = "still conflicts" in row["reason"] if asked else after is not None and after > typical + 0.03
    if high and (moved or not bent):
        found.add("conflict once registered")
    if moved and not support_grew(row):
        found.add("gain of support")
    if "few voxels show a side that both saw, and no free space" in row["reason"]:
        found.add("sides seen by both")
    return found


def decide(row, without=""):
    if not row.get("pieces"):
        return "unverified"
    odds = log_odds(row, without)
    alone = free_space(row, without)
    if alone is not None:
        return "inconsistent" if alone > SURE else "unverified"
    if value(row, "support", "log_ratio") is not None and without not in ("neighbours", "a better fit elsewhere"):
        return "inconsistent"
    if value(row, "agreeing", "log_ratio") is not None and without not in OF_NEIGHBOURS:
        return "inconsistent"
    if value(row, "displacement") is None or doubts(row) - {without}:
        return "unverified"
    hidden = "could hide" in row["reason"]  # by a direction that nothing fixes
    return "inconsistent" if odds > SURE else "consistent" if odds < PRIOR - math.log(19) and not hidden else "unverified"
