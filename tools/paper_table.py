#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sets the cells that the paper's Section V discusses beside ours, on simulated missions.

    paper_table.py indoor|outdoor [--seeds 1-20] [--kilter build/kilter] [--keep DIR] [--no-default]

For each seed: kilter simulate, kilter check --preset seed and kilter check with defaults. Prints, as Markdown, a row
per discussed cell (the first seed's numbers, and over all seeds how often it came out as in the paper), then the
cells that the paper does not discuss but that came out verified.

How numbers become the paper's words, since it gives colours only: a cell is verified when registration raised it by
at least a tenth (Theta >= 1.1 Gamma), it has 200 matches or more, and Gamma was low: below the median of the map's
sequential cells. A rejected cell is tested, low, and not verified. A high cell is not verified.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

GAIN = 1.1

# (source, target): what the paper says. Numbers are of the global numbering, from 1.
INDOOR = {(8, 1): "high", (7, 1): "high", (9, 1): "high",
          (13, 10): "rejected", (16, 10): "rejected", (15, 9): "rejected", (16, 2): "open",
          (14, 10): "verified", (15, 10): "verified", (17, 9): "verified", (17, 1): "verified",
          (16, 8): "verified", (17, 8): "verified",
          **{(i, i - 1): "high" for i in [*range(2, 9), *range(10, 18)]}}
OUTDOOR = {**{(i, i - 1): "high" for i in [*range(2, 14), *range(15, 31)]},
           **dict.fromkeys([(3, 2), (6, 5), (13, 12), (24, 23), (29, 28), (30, 1), (30, 2), (28, 1), (14, 12),
                            (14, 13), (15, 12), (15, 13)], "verified")}


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1, 4):
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stderr}")


def cells_of(folder):
    """Pairs of a result by (source, target), and how many submaps each robot has."""
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    number = {submap["id"]: i for i, submap in enumerate(result["submaps"], start=1)}
    counts = [robot["submaps"] for robot in result["robots"]]
    return {(number[pair["source"]], number[pair["target"]]): pair for pair in result["pairs"]}, counts


def words_of(cells):
    """What each cell of a seed-preset result says in the paper's words."""
    median = statistics.median(pair["gamma"] for pair in cells.values() if pair["kind"] == "sequential" and pair["gamma"])
    words = {}
    for key, pair in cells.items():
        if pair["gamma"] is None:
            words[key] = "untested"
        elif pair["theta"] is not None and pair["theta"] >= GAIN * pair["gamma"] and pair["gamma"] < median:
            words[key] = "verified"
        elif pair["gamma"] < median:
            words[key] = "low"
        else:
            words[key] = "high"
    return words


def agrees(paper, ours):
    return {"high": ours in ("high", "low"), "rejected": ours == "low", "verified": ours == "verified",
            "open": ours != "untested"}[paper]


def number_text(value):
    return "-" if value is None else f"{value:.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiment", choices=["indoor", "outdoor"])
    parser.add_argument("--seeds", default="1-20")
    parser.add_argument("--kilter", type=pathlib.Path, default=pathlib.Path("build/kilter"))
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--no-default", action="store_true")
    parser.add_argument("--set", action="append", default=[], help="key=value for the run with --preset seed")
    arguments = parser.parse_args()
    low, _, high = arguments.seeds.partition("-")
    seeds = range(int(low), int(high or low) + 1)
    paper = INDOOR if arguments.experiment == "indoor" else OUTDOOR
    expected_counts = [8, 9] if arguments.experiment == "indoor" else [13, 17]
    hits = dict.fromkeys(paper, 0)
    whole, stray, first, default = 0, {}, None, None
    scratch = tempfile.TemporaryDirectory()
    for seed in seeds:
        folder = (arguments.keep or pathlib.Path(scratch.name)) / f"{arguments.experiment}-{seed}"
        if not (folder / "seed" / "result.json").exists():
            run(arguments.kilter, "simulate", f"paper-{arguments.experiment}", "-o", folder, "--seed", seed, "--replace")
            settings = [word for setting in arguments.set for word in ("--set", setting)]
            run(arguments.kilter, "check", folder / "mission", "--preset", "seed", "-o", folder / "seed", *settings)
        cells, counts = cells_of(folder / "seed")
        if first is None:
            first = cells
            if not arguments.no_default:
                run(arguments.kilter, "check", folder / "mission", "-o", folder / "default")
                default = cells_of(folder / "default")[0]
        words = words_of(cells)
        good = {key: agrees(said, words.get(key, "untested")) for key, said in paper.items()}
        strays = [key for key, word in words.items() if word == "verified" and paper.get(key) != "verified"
                  and paper.get(key) != "open"]
        for key in strays:
            stray[key] = stray.get(key, 0) + 1
        for key in paper:
            hits[key] += good[key]
        complete = all(good.values()) and counts == expected_counts
        whole += complete and not strays
        print(f"seed {seed}: {counts[0]} + {counts[1]} submaps, {sum(good.values())} of {len(paper)} cells, "
              f"not: {[k for k in good if not good[k]]}, strays: {strays}", file=sys.stderr)
    print(f"| cell | paper | gamma | theta | theta/gamma | overlap | matched | ours | of {len(seeds)} seeds | by default |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    words = words_of(first)
    for key, said in sorted(paper.items()):
        pair = first.get(key)
        gain = f"{pair['theta'] / pair['gamma']:.2f}" if pair and pair["theta"] and pair["gamma"] else "-"
        numbers = "- | - | - | - | -" if pair is None else (
            f"{number_text(pair['gamma'])} | {number_text(pair['theta'])} | {gain} | {pair['overlap']:.2f} | {pair['matched']}")
        judged = default.get(key) if default else None
        offset = "" if not judged or judged["offset_m"] is None else f", {100 * judged['offset_m']:.0f} cm"
        print(f"| ({key[0]},{key[1]}) | {said} | {numbers} | {words.get(key, 'untested')} | {hits[key]} | "
              f"{judged['verdict'] + offset if judged else '-'} |")
    print(f"\nThe whole pattern holds in {whole} of {len(seeds)} seeds.")
    print("Verified, but not discussed in the paper: " +
          (", ".join(f"({a},{b}) in {n}" for (a, b), n in sorted(stray.items())) or "none"))


if __name__ == "__main__":
    main()
