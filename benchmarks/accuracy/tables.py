# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Markdown tables from the answers of suite.try_mission."""
import collections

import numpy as np

import ablation
import bends
import scores
from baselines import METHODS, RADII_M

GOOD_M, BAD_M = 0.05, 0.20
NEAR_GOOD_M, NEAR_BAD_M = 0.03, 0.10
ENOUGH_OVERLAP = 0.30
TOLERANCE_M = 0.10  # the default, which p_inconsistent of drift, clean and sealed missions speaks of


def share(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def with_interval(part, whole):
    low, high = scores.wilson(part, whole)
    return f"{100 * part / whole:.1f} % ({100 * low:.1f} to {100 * high:.1f})" if whole else "-"


def number(value, digits=3):
    return f"{value:.{digits}f}" if value is not None and np.isfinite(value) else "-"


def print_table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("| --- " * len(head) + "|")
    for row in rows:
        print("| " + " | ".join(map(str, row)) + " |")
    print()


def by_group(answers):
    groups = collections.OrderedDict()
    for answer in answers:
        groups.setdefault(answer["group"], []).append(answer)
    return groups


def rows_of(answers):
    return [row for answer in answers for row in answer["rows"]]


def count(rows, verdict):
    return sum(row["verdict"] == verdict for row in rows)


def configurations(answers):
    print(f"{len(answers)} missions, configuration {', '.join(sorted({a['digest'] for a in answers}))}\n")


# Scores, larger for worse pairs; a pair that a method gives no score for gets its least bad one.

def published(row):
    return row["log_odds"]


def displacement(row):
    return row.get("offset_m") if row.get("offset_m") is not None else -1.0


def seed_gamma(row):
    gamma = row.get("gamma_literal")
    return -np.log(gamma) if gamma else -np.inf


def seed_verified(row):
    return row["verified"] if row.get("verified") is not None else -np.inf


def conflict(row):
    value = row.get("evidence conflict")
    return value if value is not None else -1.0


OURS = {"kilter's log odds": published, "its displacement alone": displacement, "free-space conflict": conflict,
        "1 / Γ (the paper's)": seed_gamma, "Θ − Γ (the paper's)": seed_verified}


def of_baseline(name):
    def score(row):
        value = row.get("baselines", {}).get(name)
        return value if value is not None and np.isfinite(value) else -np.inf
    return score


def select(answers, bad_m, good_m, least_overlap=0.0):
    """(bad rows, good rows) among the pairs whose pose the scene fixes."""
    rows = [row for row in rows_of(answers) if row["fixed"] and row["overlap"] >= least_overlap]
    return [r for r in rows if r["rms_m"] > bad_m], [r for r in rows if r["rms_m"] < good_m]


def area_of(answers, score, limits=(BAD_M, GOOD_M), least_overlap=0.0):
    bad, good = select(answers, *limits, least_overlap)
    return scores.area([score(r) for r in bad], [score(r) for r in good])


def methods(answers):
    """Every score there is; baselines with the d that does best over all missions."""
    found = dict(OURS)
    if any("baselines" in row for row in rows_of(answers)):
        for name, sizes in METHODS.items():
            best = max(sizes, key=lambda d: np.nan_to_num(area_of(answers, of_baseline(f"{name} {d}"))))
            found[f"{name} (d = {best} m)"] = of_baseline(f"{name} {best}")
        found.update(fitted_coral(answers))
    return found


def fitted_coral(answers):
    """CorAl's logistic regression on joint and separate entropy and overlap, fitted on all groups but the row's own."""
    best = max(RADII_M, key=lambda d: np.nan_to_num(area_of(answers, of_baseline(f"coral {d}"))))
    names = (f"entropy {best}", f"coral separate {best}")

    def features(row):
        values = [row.get("baselines", {}).get(name) for name in names]
        return None if any(v is None for v in values) else [*values, 1.0 - row["baselines"][f"fitness {best}"]]

    weights = {}
    for group in by_group(answers):
        bad, good = select([a for a in answers if a["group"] != group], BAD_M, GOOD_M)
        known = [(features(r), label) for some, label in ((bad, 1.0), (good, 0.0)) for r in some if features(r)]
        if len({label for _, label in known}) == 2:
            weights[group] = scores.logistic_fit(np.array([f for f, _ in known]), np.array([l for _, l in known]))
    for answer in answers:
        for row in answer["rows"]:
            row["group"] = answer["group"]

    def score(row):
        x = features(row)
        return float(np.dot([*x, 1.0], weights[row["group"]])) if x and row["group"] in weights else -np.inf
    return {f"coral, fitted on the other worlds (d = {best} m)": score}


def verdict_table(answers):
    table = []
    for name, some in [*by_group(answers).items(), ("all", answers)]:
        rows = [r for r in rows_of(some) if r["overlap"] >= ENOUGH_OVERLAP and r["fixed"]]
        bad = [r for r in rows if r["rms_m"] > BAD_M]
        good = [r for r in rows if r["rms_m"] < GOOD_M]
        errors = np.array([r["error_m"] for r in rows_of(some) if r.get("error_m") is not None
                           and r["verdict"] != "unverified" and not r["without_registration"]])
        quantiles = np.percentile(errors, [50, 90]) * 100 if len(errors) else [float("nan")] * 2
        faults = [f for a in some for f in a["faults"]]
        table.append([name, len(bad), share(count(bad, "inconsistent"), len(bad)), share(count(bad, "consistent"), len(bad)),
                      len(good), share(count(good, "inconsistent"), len(good)), share(count(good, "consistent"), len(good)),
                      share(count(rows, "unverified"), len(rows)), number(quantiles[0], 1), number(quantiles[1], 1),
                      f"{int((errors > 0.3).sum())} of {len(errors)}", f"{sum(f['found'] for f in faults)} of {len(faults)}"])
    print_table(["world", "bad", "inconsistent", "consistent", "good", "inconsistent", "consistent", "unverified",
                 "error p50 cm", "p90 cm", "> 0.3 m", "faults"], table)


def is_constraint(row):
    """As labels.is_constraint, of a row."""
    return row.get("error_m") is not None and row["verdict"] != "unverified" and not row["without_registration"]


def constraint_table(answers):
    table, heads = [], ["p50 cm", "p90 cm", "> 0.3 m"]
    for name, some in [*by_group(answers).items(), ("all", answers)]:
        rows = [r for r in rows_of(some) if is_constraint(r)]
        rigid = [r for r in rows if (r["pieces"].get("bend_m", {}).get("value") or 0.0) <= TOLERANCE_M]
        line = [name]
        for kept in (rows, rigid, [r for r in rigid if r["fixed"]]):
            errors = np.array([r["error_m"] for r in kept])
            quantiles = np.percentile(errors, [50, 90]) * 100 if len(errors) else [float("nan")] * 2
            line += [len(errors), number(quantiles[0], 1), number(quantiles[1], 1), int((errors > 0.3).sum())]
        table.append(line)
    print_table(["world", "constraints", *heads, "not bent", *heads, "and pose fixed", *heads], table)


def area_table(answers):
    groups = by_group(answers)
    told = [name for name, some in groups.items() if np.isfinite(area_of(some, published))]
    table = []
    for name, score in methods(answers).items():
        low, high = scores.bootstrap(answers, lambda some: area_of(some, score))
        bad, good = select(answers, BAD_M, GOOD_M)
        table.append([name, *(number(area_of(groups[g], score)) for g in told), number(area_of(answers, score)),
                      f"{number(low)} to {number(high)}", number(area_of(answers, score, least_overlap=ENOUGH_OVERLAP)),
                      number(area_of(answers, score, (NEAR_BAD_M, NEAR_GOOD_M))),
                      share(scores.found_at([score(r) for r in bad], [score(r) for r in good]), 1)])
    print_table(["score", *told, "all", "95 %", "overlap ≥ 30 %", "0.10/0.03", "TPR at 1 % FPR"], table)


def discovery_table(answers):
    table = []
    few, many = [], []
    for answer in answers:
        rows = answer["rows"]
        bad = np.mean([r["rms_m"] > TOLERANCE_M for r in rows]) if rows else 0.0
        (few if bad < 0.1 else many if bad > 0.3 else []).append(answer)
    for name, some in (("under 10 % bad", few), ("over 30 % bad", many), ("all", answers)):
        found = [r for r in rows_of(some) if r["verdict"] == "inconsistent"]
        false = [r for r in found if r["rms_m"] <= TOLERANCE_M]
        clearly = [r for r in found if r["rms_m"] <= GOOD_M]
        rows = rows_of(some)
        table.append([name, len(some), with_interval(sum(r["rms_m"] > TOLERANCE_M for r in rows), len(rows)), len(found),
                      with_interval(len(false), len(found)), len(clearly)])
    print_table(["missions", "how many", "truly above the tolerance", "inconsistent", "of them at most the tolerance",
                 "below 5 cm"], table)


def set_shares_table(answers, shares=(0.03, 0.40), pairs=200, draws=400):
    """Maps of `pairs` pairs, drawn anew from all missions so that the given share lies above the tolerance."""
    rows = [r for r in rows_of(answers) if r["fixed"] and r["reason"] != "not a pair"]
    above = np.array([r["rms_m"] > TOLERANCE_M for r in rows])
    p_values = np.array([float("nan") if r["p_value"] is None else r["p_value"] for r in rows])
    log_odds = np.array([r["log_odds"] for r in rows])
    if not above.any() or above.all():
        return
    rng = np.random.default_rng(1)
    table = []
    for share_above in shares:
        false, found = [], []
        for _ in range(draws):
            bad = int(round(share_above * pairs))
            drawn = np.concatenate([rng.choice(np.flatnonzero(above), bad), rng.choice(np.flatnonzero(~above), pairs - bad)])
            said = scores.discoveries(p_values[drawn])
            false.append((said & ~above[drawn]).sum() / max(said.sum(), 1))
            found.append((said & above[drawn]).sum() / bad)
        weights = np.where(above, share_above / above.mean(), (1 - share_above) / (1 - above.mean()))
        cells = []
        for prior in (0.05, share_above):
            p = 1 / (1 + np.exp(-np.clip(log_odds + np.log(prior / (1 - prior)) - ablation.PRIOR, -700, 700)))
            middle = (p > 0.05) & (p < 0.95)
            cells += [number(scores.weighted_calibration(p, above, weights)),
                      f"{number(scores.weighted_calibration(p[middle], above[middle], weights[middle]))} of {middle.sum()}"]
        table.append([f"{100 * share_above:.0f} %", f"{100 * np.mean(false):.2f} %", f"{100 * np.mean(found):.1f} %", *cells])
    print_table(["above the tolerance", "false discoveries", "found", "calibration error", "between 0.05 and 0.95",
                 "at this prior", "between 0.05 and 0.95"], table)


def wrong_place_table(answers):
    wrong = [w for a in answers for w in a["wrong"]]
    if wrong:
        print(f"Wrong places (overlap in the map ≥ 30 %, none in truth): {len(wrong)} pairs, of them consistent "
              f"{count(wrong, 'consistent')}, inconsistent {count(wrong, 'inconsistent')}, unverified "
              f"{count(wrong, 'unverified')}.\n")
    accused = [pair for a in answers for pair in a["accused"]]
    print(f"Called inconsistent without enough places in common for a label: {len(accused)} pairs, of them "
          f"{sum(pair['apart_m'] <= TOLERANCE_M for pair in accused)} at most the tolerance off by their poses.\n")


def calibration_table(answers):
    rows = [r for r in rows_of(answers) if r["fixed"]]
    p = np.array([r["p"] for r in rows])
    above = np.array([r["rms_m"] > TOLERANCE_M for r in rows])
    error, bins = scores.calibration(p, above)
    between = (p > 0.05) & (p < 0.95)
    inner, _ = scores.calibration(p[between], above[between]) if between.any() else (float("nan"), [])
    print(f"{len(rows)} pairs whose pose the scene fixes, {100 * above.mean():.1f} % above the tolerance; Brier score "
          f"{scores.brier(p, above):.4f}, log loss {scores.log_loss(np.array([r['log_odds'] for r in rows]), above):.3f}, "
          f"expected calibration error {error:.3f}; over the {int(between.sum())} pairs between 0.05 and 0.95 "
          f"{number(inner)}.\n")
    print_table(["said p", "truly above", "pairs"], [[f"{m:.3f}", f"{s:.3f}", n] for m, s, n in bins])


def doubted_line(answers):
    """How often a registration that is not believed ended beyond the tolerance."""
    rows = [r for r in rows_of(answers) if r["fixed"]]
    left = [r for r in rows if r.get("pieces") and (ablation.value(r, "displacement") or 0.0) > TOLERANCE_M
            and ablation.doubts(r)]
    above = [r for r in rows if r["rms_m"] > TOLERANCE_M]
    far = sum(r["rms_m"] > TOLERANCE_M for r in left)
    print(f"Registrations that are doubted and ended beyond the tolerance: {far} of {len(above)} pairs that are off by more, "
          f"{len(left) - far} of the {len(rows) - len(above)} others.\n")


def certificate_line(answers):
    """Whether the certificate covers the truth of the pairs that it speaks of."""
    held, of, widths = 0, 0, []
    for answer in answers:
        bound = answer["system"]["certificate_m"]
        excluded = {frozenset(pair) for pair in answer["excluded"]}
        decided = [r for r in answer["rows"] if r["verdict"] != "unverified"
                   and frozenset((r["source"], r["target"])) not in excluded]
        if bound is None or not decided:
            continue
        of += 1
        held += max(r["rms_m"] for r in decided) <= bound
        widths.append(bound)
    if of:
        print(f"The certificate covers the truth in {held} of {of} missions; its median is {100 * np.median(widths):.1f} cm.\n")


def ablation_table(answers):
    table = []
    rows = [r for r in rows_of(answers) if r["overlap"] >= ENOUGH_OVERLAP and r["fixed"]]
    bad, good = [r for r in rows if r["rms_m"] > BAD_M], [r for r in rows if r["rms_m"] < GOOD_M]
    cases = [("as the program has it", lambda r: r["verdict"], published),
             ("decided again, all pieces", ablation.decide, ablation.log_odds)]
    cases += [(f"without {name}", lambda r, n=name: ablation.decide(r, n), lambda r, n=name: ablation.log_odds(r, n))
              for name in ablation.PIECES]
    for name, decide, odds in cases:
        said = [decide(r) for r in bad], [decide(r) for r in good], [decide(r) for r in rows]
        scored = [[odds(r) if r.get("pieces") else 0.0 for r in some] for some in (bad, good)]
        wrong = [r for r, verdict in zip(rows, said[2]) if verdict == "inconsistent" and r["rms_m"] <= TOLERANCE_M]
        table.append([name, share(said[0].count("inconsistent"), len(bad)), share(said[0].count("consistent"), len(bad)),
                      share(said[1].count("inconsistent"), len(good)), share(said[1].count("consistent"), len(good)),
                      share(said[2].count("unverified"), len(rows)), len(wrong), number(scores.area(*scored), 4)])
    print_table(["evidence", "bad inconsistent", "consistent", "good inconsistent", "consistent", "unverified",
                 "inconsistent at most the tolerance apart", "AUC"], table)


def seconds_line(answers):
    seconds = [sum(a["seconds"].values()) / max(a["tested"], 1) for a in answers]
    print(f"Wall seconds a tested pair, one thread, everything included: median {np.median(seconds):.3f}.\n")


def drift(answers):
    configurations(answers)
    verdict_table(answers)
    constraint_table(answers)
    area_table(answers)
    discovery_table(answers)
    set_shares_table(answers)
    wrong_place_table(answers)
    calibration_table(answers)
    doubted_line(answers)
    certificate_line(answers)
    ablation_table(answers)
    print_table(["true bend cm", "pairs", "RMS true cm", "RMS measured cm", "median measured / true"],
                bends.rows_of(rows_of(answers), ENOUGH_OVERLAP))
    seconds_line(answers)


def sealed(answers):
    configurations(answers)
    verdict_table(answers)
    constraint_table(answers)
    wrong_place_table(answers)
    area_table(answers)
    for name, some in (*by_group(answers).items(), ("all", answers)):
        print(f"### {name}\n")
        calibration_table(some)
        set_shares_table(some)
        certificate_line(some)
    ablation_table(answers)


def points(answers):
    configurations(answers)
    verdict_table(answers)
    constraint_table(answers)
    area_table(answers)
    wrong_place_table(answers)
    calibration_table(answers)
    certificate_line(answers)
    map_table(answers)


def clean(answers):
    configurations(answers)
    map_table(answers)
    wrong_place_table(answers)
    certificate_line(answers)


def map_table(answers):
    table = []
    for name, some in [*by_group(answers).items(), ("all", answers)]:
        with_any = sum(a["system"]["inconsistent"] > 0 for a in some)
        decided = [np.mean([r["verdict"] != "unverified" for r in a["rows"]]) if a["rows"] else 0.0 for a in some]
        good = sum(a["system"]["verdict"] == "consistent" and d >= 0.7 for a, d in zip(some, decided))
        bounds = [a["system"]["certificate_m"] for a in some if a["system"]["certificate_m"] is not None]
        truly = [r["rms_m"] for r in rows_of(some)]
        table.append([name, len(some), with_any, sum(a["system"]["verdict"] == "consistent" for a in some), good,
                      share(np.mean(decided), 1), number(100 * np.median(bounds), 1) if bounds else "-",
                      number(100 * np.median(truly), 1), number(100 * np.max(truly), 1)])
    print_table(["world", "missions", "with a pair inconsistent", "map consistent", "and ≥ 70 % decided", "decided",
                 "certificate median cm", "true disagreement median cm", "largest cm"], table)
