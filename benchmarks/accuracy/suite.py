# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The labelled suite: missions whose truth is known, what kilter says of them, and one row per pair.

Two sorts of missions. *Drift*: a world of `kilter simulate` with its planted faults. *Injected*: any mission whose true
poses are known (simulated, or real with reference poses), checked under poses that are true but for errors put in here:
each robot's odometry slips once, at a border between two submaps, by a given length and angle. Pairs on one side of
every slip stay good, pairs across a slip are off by it, and both are judged in one run, as in a real mission.
"""
import dataclasses
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import baselines
import clouds
import labels

WORLDS = ("office", "carpark", "warehouse", "tunnel", "tunnel-niches", "clean-office", "clean-carpark")
OF_POINTS = ("office", "carpark", "warehouse", "clean-office", "clean-carpark")
SEALED = ("stairs", "forest")  # for calibration only, until somebody looks
UNSEEN = ("village", "factory")  # made last, for the same
# Length [m] and angle [rad] of the errors that CorAl and FACT inject.
SIZES = ((0.05, 0.005), (0.1, 0.01), (0.2, 0.03), (0.3, 0.03))
# How an injected error lies in the slipping robot's own frame (x ahead, y left, z up).
DIRECTIONS = ("planar", "ahead", "left", "up", "roll", "pitch", "yaw", "any")


@dataclasses.dataclass(frozen=True)
class Mission:
    """One run of check. `root` holds mission/ and truth/."""
    group: str  # the table row it belongs to
    name: str
    root: pathlib.Path
    sets: tuple = ()
    injected: tuple | None = None  # (length_m, angle_rad, direction, draw)
    work: pathlib.Path | None = None  # where its results go
    points: bool = False  # checked as finished clouds (clouds.py) instead of scans


class Kilter:
    def __init__(self, program):
        self.program = pathlib.Path(program).resolve()
        here = pathlib.Path(__file__).resolve().parent
        scripts = ("labels.py", "suite.py", "baselines.py", "acceptance_index.py", "clouds.py")
        parts = [self.program] + [here / name for name in scripts]
        self.stamp = hashlib.sha256(b"".join(part.read_bytes() for part in parts)).hexdigest()[:16]

    def run(self, *words, accept=(0,)):
        done = subprocess.run([str(self.program), *map(str, words)], capture_output=True, text=True, check=False)
        if done.returncode not in accept:
            sys.exit(f"kilter {' '.join(map(str, words))}: status {done.returncode}\n{done.stderr}")
        return done.returncode

    def simulate(self, world, seed, folder):
        """Once per folder."""
        if not (folder / "truth" / "faults.json").exists():
            self.run("simulate", world, "-o", folder, "--seed", seed, "--replace", "--quiet")

    def check(self, mission, out, *more, sets=()):
        words = [word for each in sets for word in ("--set", each)]
        self.run("check", mission, "-o", out, "--quiet", "--jobs", 1, *words, *more, accept=(0, 1, 4))
        return labels.read_result(out)

    def submaps(self, mission, out, *more, sets=()):
        words = [word for each in sets for word in ("--set", each)]
        self.run("submaps", mission, "-o", out, "--quiet", "--jobs", 1, *words, *more)


def write_tum(path, rotations, positions):
    """Poses as TUM rows, the time being the scan's number."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8") as file:
        for k, (R, t) in enumerate(zip(rotations, positions)):
            q = labels.quaternion_of(R)
            file.write(f"{k} {t[0]:.9f} {t[1]:.9f} {t[2]:.9f} {q[0]:.12f} {q[1]:.12f} {q[2]:.12f} {q[3]:.12f}\n")


def rotation_about(axis, angle_rad):
    """Rodrigues."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle_rad) * K + (1 - np.cos(angle_rad)) * K @ K


def draw_error(length_m, angle_rad, direction, rng):
    """4x4 motion in a robot's own frame. Single axes carry the length or the angle alone."""
    sign = rng.choice((-1.0, 1.0))
    axes = np.eye(3)
    unit = lambda: (lambda v: v / np.linalg.norm(v))(rng.normal(size=3))  # noqa: E731
    shift, axis, angle = {
        "planar": (length_m * np.array([1.0, 1.0, 0.0]) / np.sqrt(2), axes[2], angle_rad),
        "ahead": (length_m * axes[0], axes[2], 0.0), "left": (length_m * axes[1], axes[2], 0.0),
        "up": (length_m * axes[2], axes[2], 0.0), "roll": (np.zeros(3), axes[0], angle_rad),
        "pitch": (np.zeros(3), axes[1], angle_rad), "yaw": (np.zeros(3), axes[2], angle_rad),
        "any": (length_m * unit(), unit(), angle_rad)}[direction]
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_about(axis, sign * angle), sign * shift
    return T


def inject(mission, submaps, folder):
    """True poses but for one slip a robot, written to folder/ROBOT/poses.tum. Where a submap's robot had slipped by then
    is told per submap: a dict id -> 4x4 motion of the world under it."""
    length_m, angle_rad, direction, draw = mission.injected
    moved = {}
    for number, robot in enumerate(sorted({s["robot"] for s in submaps})):
        of_robot = [s for s in submaps if s["robot"] == robot]
        rotations, positions = labels.read_poses(mission.root / "truth" / robot / "poses.tum")
        rng = np.random.default_rng([draw, number, DIRECTIONS.index(direction), round(1000 * length_m)])
        first = of_robot[int(rng.integers(1, len(of_robot)))]["first_scan"] if len(of_robot) > 1 else len(rotations)
        motion = np.eye(4)
        if first < len(rotations):
            P = np.eye(4)
            P[:3, :3], P[:3, 3] = rotations[first], positions[first]
            motion = P @ draw_error(length_m, angle_rad, direction, rng) @ np.linalg.inv(P)
        slipped = np.arange(len(rotations)) >= first
        write_tum(folder / robot / "poses.tum",
                  np.where(slipped[:, None, None], motion[:3, :3] @ rotations, rotations),
                  np.where(slipped[:, None], positions @ motion[:3, :3].T + motion[:3, 3], positions))
        moved.update({s["id"]: motion if s["first_scan"] >= first else np.eye(4) for s in of_robot})
    return moved


def said_of(pair):
    """What a result says of one pair; of one that was never tested, nothing."""
    if pair is None:
        return {"verdict": "unverified", "reason": "not a pair", "log_odds": 0.0, "p": 0.5}
    evidence = {f"evidence {name}": value["value"] for name, value in pair["evidence"].items()}
    return {"verdict": pair["verdict"], "reason": pair["reason"], "p_value": pair["p_value"],
            "log_odds": pair["log_odds"] if pair["log_odds"] is not None else 0.0,
            "p": pair["p_inconsistent"] if pair["p_inconsistent"] is not None else 0.5,
            "offset_m": pair["offset_m"], "interval_m": pair["offset_interval_m"],
            "gamma_literal": pair["gamma_literal"], "verified": pair["verified"], **evidence,
            "pieces": pair["evidence"],
            "without_registration": labels.without_registration(pair)}


def rows_of(mission, result, truth, moved):
    said = {(p["source"], p["target"]): p for p in result["pairs"]}
    for label in truth.pairs():
        pair = said.get((label["source"], label["target"]))
        row = {key: label[key] for key in ("source", "target", "kind", "overlap", "cells", "rms_m", "p95_m", "bend_m")}
        row["fixed"] = bool(label["shares"][0] >= labels.LEAST_SHARE)
        row.update(said_of(pair))
        if moved is not None:
            row["same"] = bool(np.array_equal(moved[label["source"]], moved[label["target"]]))
            row["across"] = not row["same"] and any(
                np.array_equal(moved[label[end]], np.eye(4)) for end in ("source", "target"))
        if pair and pair["T_target_source_registered"]:
            error_m, all_m, degrees, x = labels.pose_error(label, labels.to_matrix(pair["T_target_source_registered"]))
            row.update(error_m=error_m, error_all_m=all_m, error_deg=degrees)
        yield row


def fault_rows(mission, result):
    """Planted events, and whether an inconsistent pair has a submap that holds the event or lies next to it."""
    path = mission.root / "truth" / "faults.json"
    if mission.injected or not path.exists():
        return []
    index = {submap["id"]: i for i, submap in enumerate(result["submaps"])}
    bad = [p for p in result["pairs"] if p["verdict"] == "inconsistent"]
    rows = []
    for fault in json.loads(path.read_text(encoding="utf-8"))["faults"]:
        at = [i for i, s in enumerate(result["submaps"])
              if s["robot"] == fault["robot"] and s["first_scan"] <= fault["scan"] <= s["last_scan"]]
        found = any(abs(index[pair[end]] - i) <= 1 and pair[end].split("/")[0] == fault["robot"]
                    for pair in bad for end in ("source", "target") for i in at)
        rows.append({**fault, "found": found})
    return rows


def check_reference(mission, kilter, out):
    """The mission under its true poses, for its cuts."""
    if not (out / "result.json").exists():
        kilter.check(mission.root / "mission", out, "--poses", mission.root / "truth", sets=mission.sets)


def try_mission(mission, kilter, wants_baselines):
    """Everything the tables need of one run, kept beside it and used again while program and labels are the same."""
    work = mission.work or mission.root
    kept = work / "rows.json"
    stamp = [kilter.stamp, list(mission.sets), list(mission.injected or ()), wants_baselines, mission.points]
    if kept.exists():
        answer = json.loads(kept.read_text(encoding="utf-8"))
        if answer["stamp"] == stamp:
            return answer
    moved = None
    scans, poses = mission.root / "mission", mission.root / "mission"
    if mission.injected:
        reference = work.parent / f"{mission.root.name}-true"
        check_reference(mission, kilter, reference)
        poses = work / "poses"
        moved = inject(mission, labels.read_result(reference)["submaps"], poses)
        result = kilter.check(scans, work / "out", "--poses", poses, "--cuts", reference, sets=mission.sets)
    elif mission.points:
        cuts = clouds.write_mission(scans, work / "clouds", write_tum)
        result = kilter.check(work / "clouds", work / "out", sets=mission.sets)
        for submap in result["submaps"]:
            submap["first_scan"], submap["last_scan"] = cuts[submap["robot"], submap["index"] - 1]
    else:
        result = kilter.check(scans, work / "out", sets=mission.sets)
    truth = labels.Truth(scans, mission.root / "truth", poses, result["submaps"])
    rows = list(rows_of(mission, result, truth, moved))
    if wants_baselines:
        with tempfile.TemporaryDirectory() as maps:
            kilter.submaps(scans, maps, "--poses", poses, "--cuts", work / "out", sets=mission.sets)
            baselines.add(rows, truth, pathlib.Path(maps))
    wrong = [{"source": w["source"], "target": w["target"], "map_overlap": w["map_overlap"],
              **said_of(next((p for p in result["pairs"]
                              if (p["source"], p["target"]) == (w["source"], w["target"])), None))}
             for w in truth.wrong_places()]
    # The storey above, the next aisle: what no label speaks of must not be accused either.
    labelled = {(row["source"], row["target"]) for row in rows}
    number = {submap["id"]: k for k, submap in enumerate(result["submaps"])}
    accused = [{"source": p["source"], "target": p["target"], "reason": p["reason"],
                "apart_m": truth.apart_by_pose(number[p["source"]], number[p["target"]])}
               for p in result["pairs"]
               if p["verdict"] == "inconsistent" and (p["source"], p["target"]) not in labelled]
    system = result["system"]
    answer = {"stamp": stamp, "group": mission.group, "name": mission.name, "digest": result["config_digest"],
              "rows": rows, "wrong": wrong, "accused": accused, "faults": fault_rows(mission, result),
              "system": {key: system[key] for key in ("verdict", "certificate_m", "inconsistent", "tested")},
              "excluded": system.get("certificate_excludes", []),
              "seconds": result["run"]["seconds"], "tested": len(result["pairs"])}
    work.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(answer, default=float), encoding="utf-8")
    return answer
