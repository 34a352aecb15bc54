#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sets the cells that the paper's Section V discusses beside ours, on simulated missions.

    paper_table.py indoor|outdoor [--seeds 1-20,23] [--kilter build/kilter] [--keep DIR] [--no-default]
                    [--set KEY=VALUE]

For each seed: kilter simulate, kilter check --preset seed and kilter check with defaults. Prints, as Markdown, a row
per discussed cell: the medians over the seeds, and in how many of them it came out as in the paper; then the cells
that the paper does not discuss but that came out verified. With --keep, results that are there already are used
again (and scans are deleted, since they are large).

How numbers become the paper's words, since it gives colours only. A cell is
  low       if its Gamma is below the median of the map's sequential cells;
  verified  if it is low, registration raises it by a fifth or more (Theta >= 1.2 Gamma) and moves by more than a voxel;
  rejected  if it is low and not verified;
  high      if it is not verified: the paper's text says of these cells only that nothing is wrong with them.

The pattern holds for a seed if there are as many submaps as in the paper, every discussed cell is as the paper says
and no other cell is verified. Both experiments run with local_min_gap=3: the paper tests (13,10), so its k is at most
3, and with less the neighbours of a slip's neighbours would be tested too, which it does not discuss.
"""
import argparse
import collections
import json
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

GAIN = 1.2
VOXEL_M = 0.1

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
    sequential = [pair["gamma"] for pair in cells.values() if pair["kind"] == "sequential" and pair["gamma"]]
    low = statistics.median(sequential)
    words = {}
    for key, pair in cells.items():
        if pair["gamma"] is None:
            words[key] = "untested"
        elif pair["gamma"] >= low:
            words[key] = "high"
        elif pair["theta"] is not None and pair["theta"] >= GAIN * pair["gamma"] and pair["offset_m"] > VOXEL_M:
            words[key] = "verified"
        else:
            words[key] = "low"
    return words


def agrees(paper, ours):
    return {"high": ours in ("high", "low"), "rejected": ours == "low", "verified": ours == "verified",
            "open": ours != "untested"}[paper]


def results_of(arguments, seed, folder):
    """The cells of one seed by the preset and by default (None if not asked for), and the counts of submaps."""
    found = {}
    for name, options in (("seed", ["--preset", "seed", *arguments.settings]), ("default", [])):
        if name == "default" and arguments.no_default:
            continue
        if not (folder / name / "result.json").exists():
            if not (folder / "mission" / "a" / "scans").is_dir():
                scene = f"paper-{arguments.experiment}"
                run(arguments.kilter, "simulate", scene, "-o", folder, "--seed", seed, "--replace")
            run(arguments.kilter, "check", folder / "mission", "-o", folder / name, *options)
        found[name] = cells_of(folder / name)
    for scans in (folder / "mission").glob("*/scans"):
        shutil.rmtree(scans)
    return found["seed"][0], found.get("default", (None,))[0], found["seed"][1]


def median_text(values, form="{:.0f}"):
    values = [value for value in values if value is not None]
    return form.format(statistics.median(values)) if values else "-"


def default_text(pairs):
    """The commonest verdict of the default configuration, its count, and the median offset."""
    verdict, count = collections.Counter(pair["verdict"] for pair in pairs).most_common(1)[0]
    offset = median_text([pair["offset_m"] and 100 * pair["offset_m"] for pair in pairs if pair["verdict"] == verdict])
    return f"{verdict} {count}" + ("" if offset == "-" else f", {offset} cm")


def print_row(key, said, seeds, hits):
    pairs = [cells[key] for cells, _ in seeds if key in cells]
    judged = [default[key] for _, default in seeds if default and key in default]
    gain = median_text([p["theta"] / p["gamma"] if p["theta"] and p["gamma"] else None for p in pairs], "{:.2f}")
    numbers = [median_text([pair[name] for pair in pairs]) for name in ("gamma", "theta")]
    print(f"| ({key[0]},{key[1]}) | {said} | {numbers[0]} | {numbers[1]} | {gain} | "
          f"{median_text([pair['overlap'] for pair in pairs], '{:.2f}')} | "
          f"{median_text([pair['matched'] for pair in pairs])} | {hits} | {default_text(judged) if judged else '-'} |")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiment", choices=["indoor", "outdoor"])
    parser.add_argument("--seeds", default="1-20")
    parser.add_argument("--kilter", type=pathlib.Path, default=pathlib.Path("build/kilter"))
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--no-default", action="store_true")
    parser.add_argument("--set", action="append", default=[], help="key=value for the run with --preset seed")
    arguments = parser.parse_args()
    ranges = [part.partition("-") for part in arguments.seeds.split(",")]
    arguments.seeds = [seed for low, _, high in ranges for seed in range(int(low), int(high or low) + 1)]
    arguments.kilter = arguments.kilter.resolve()
    arguments.settings = [word for setting in ["local_min_gap=3", *arguments.set] for word in ("--set", setting)]
    return arguments


def main():
    arguments = parse_arguments()
    paper, expected_counts = (INDOOR, [8, 9]) if arguments.experiment == "indoor" else (OUTDOOR, [13, 17])
    hits, strays, seeds, whole = collections.Counter(), collections.Counter(), [], 0
    with tempfile.TemporaryDirectory() as scratch:
        for seed in arguments.seeds:
            folder = (arguments.keep or pathlib.Path(scratch)) / f"{arguments.experiment}-{seed}"
            cells, default, counts = results_of(arguments, seed, folder)
            seeds.append((cells, default))
            words = words_of(cells)
            wrong = [key for key, said in paper.items() if not agrees(said, words.get(key, "untested"))]
            stray = [key for key, word in words.items() if word == "verified" and paper.get(key, "high") == "high"]
            hits.update(key for key in paper if key not in wrong)
            strays.update(key for key in stray if key not in paper)
            whole += not wrong and not stray and counts == expected_counts
            print(f"seed {seed}: {counts[0]} + {counts[1]} submaps, {len(paper) - len(wrong)} of {len(paper)} cells, "
                  f"not: {wrong}, strays: {stray}", file=sys.stderr)
    print(f"| cell | paper | Γ | Θ | Θ/Γ | overlap | matched | as the paper, of {len(seeds)} | by default |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for key, said in sorted(paper.items()):
        print_row(key, said, seeds, hits[key])
    print(f"\nThe whole pattern holds in {whole} of {len(seeds)} seeds; {sum(hits.values())} of "
          f"{len(seeds) * len(paper)} single cells are as in the paper.")
    print("Verified, but not discussed in the paper: " +
          (", ".join(f"({a},{b}) in {n}" for (a, b), n in sorted(strays.items())) or "none") + ".")


if __name__ == "__main__":
    main()
