# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pairs of simulated missions, registered from starts of known error.

The submaps are built at the true poses, so each is rigid and the truth of a pair is one pose: what is off at the end is
registration's own error. Which pairs overlap, and which directions the scene fixes, is decided by the other benchmark's
labels.py from the truth alone.
"""
import hashlib
import json
import pathlib
import subprocess
import sys
import zlib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "accuracy"))
import labels  # noqa: E402  (the neighbouring benchmark's)

ENOUGH_OVERLAP = 0.30
NEAR_M, NEAR_DEG = 0.02, 0.2  # success
STARTS = {"0.1 m, 1 deg": (0.1, 1.0), "0.3 m, 3 deg": (0.3, 3.0), "0.6 m, 6 deg": (0.6, 6.0), "1 m, 10 deg": (1.0, 10.0)}
FAR_START = "5 m, 30 deg"
FAR_M, FAR_DEG = 5.0, 30.0
BAY_M = 2.7  # of the simulated warehouse, along its rows: the world's x


def run(*command, accept=(0,)):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode not in accept:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stderr}")
    return done.stdout


def to_pose(T):
    """x y z qx qy qz qw of a matrix."""
    trace = np.trace(T[:3, :3])
    if trace > 0:
        s = 2 * np.sqrt(trace + 1)
        q = [(T[2, 1] - T[1, 2]) / s, (T[0, 2] - T[2, 0]) / s, (T[1, 0] - T[0, 1]) / s, s / 4]
    else:
        i = int(np.argmax(np.diag(T[:3, :3])))
        j, k = (i + 1) % 3, (i + 2) % 3
        s = 2 * np.sqrt(1 + T[i, i] - T[j, j] - T[k, k])
        q = [0.0] * 4
        q[i], q[j], q[k] = s / 4, (T[j, i] + T[i, j]) / s, (T[k, i] + T[i, k]) / s
        q[3] = (T[k, j] - T[j, k]) / s
    return [*T[:3, 3], *q]


def turn(axis, angle_rad):
    x, y, z = axis / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle_rad) * K + (1 - np.cos(angle_rad)) * K @ K


def motion_about(centre, shift, rotation):
    """p -> centre + rotation (p - centre) + shift, as a matrix."""
    T = np.eye(4)
    T[:3, :3] = rotation
    T[:3, 3] = centre + shift - rotation @ centre
    return T


def mounted_askew(level, folder):
    """A mission as robots would record it whose sensors are mounted 2 to 4 degrees off level and up to 40 degrees off
    ahead, each its own way: poses turned, points turned back. Nothing else changes, but that floors and walls no longer
    lie along a submap's lattice."""
    for poses in level.glob("*/*/poses.tum"):
        rng = np.random.default_rng(zlib.crc32(f"{level.name} {poses.parent.name}".encode()))
        about = rng.uniform(0, 2 * np.pi)
        mount = turn(np.array([np.cos(about), np.sin(about), 0.0]), np.radians(rng.uniform(2, 4))) @ turn(
            np.array([0.0, 0.0, 1.0]), np.radians(rng.uniform(-40, 40)))
        out = folder / poses.parent.relative_to(level)
        (out / "scans").mkdir(parents=True, exist_ok=True)
        lines = []
        for line in poses.read_text(encoding="utf-8").splitlines():
            T = labels.to_matrix([float(word) for word in line.split()[1:]])
            T[:3, :3] = T[:3, :3] @ mount
            lines.append(" ".join([line.split()[0], *(repr(float(x)) for x in to_pose(T))]))
        (out / "poses.tum").write_text("\n".join(lines) + "\n", encoding="utf-8")
        for scan in (poses.parent / "scans").glob("*.bin"):
            points = np.fromfile(scan, np.float32).reshape(-1, 4)
            points[:, :3] = points[:, :3].astype(float) @ mount
            points.tofile(out / "scans" / scan.name)
    (folder / "truth" / "faults.json").write_bytes((level / "truth" / "faults.json").read_bytes())


def size_of(options, world):
    """What asks for the size of a world; the paper's have their own."""
    return () if world.startswith("paper") else ("--scale", options.scale)


class Mission:
    """One simulated world without faults, its submaps at their true poses, and the program that registers them."""

    def __init__(self, options, world, seed, folder):
        self.world, self.seed = world, seed
        if not (folder / "truth" / "faults.json").exists():
            run(options.kilter, "simulate", world, "-o", folder, "--seed", seed, "--fault", "none",
                *size_of(options, world), "--replace", "--quiet")
        if options.askew:
            level, folder = folder, folder.with_name(folder.name + "-askew")
            if not (folder / "truth" / "faults.json").exists():
                mounted_askew(level, folder)
        self.folder = folder
        command = [options.program, folder / "mission", folder / "truth", *options.set]
        self.program = subprocess.Popen([str(word) for word in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True)
        line = self.program.stdout.readline()
        if not line:
            sys.exit(f"{folder}: no submaps")
        self.submaps = json.loads(line)
        self.number = {submap["id"]: k for k, submap in enumerate(self.submaps)}
        self.pairs = self.labelled(line)

    def close(self):
        self.program.stdin.close()
        self.program.wait()

    def labelled(self, line):
        """Pairs with enough true overlap; kept beside the mission, since reading all scans takes longest."""
        kept = self.folder / f"pairs-{hashlib.sha1(line.encode()).hexdigest()[:12]}.json"
        if not kept.exists():
            truth = labels.Truth(self.folder / "mission", self.folder / "truth", self.folder / "truth", self.submaps)
            names = ("source", "target", "kind", "overlap", "R", "t", "fixed", "centre", "unscale", "shares")
            rows = [{name: np.asarray(pair[name]).tolist() for name in names} for pair in truth.pairs(ENOUGH_OVERLAP)]
            kept.write_text(json.dumps(rows), encoding="utf-8")
        rows = json.loads(kept.read_text(encoding="utf-8"))
        return [{k: np.array(v) if isinstance(v, list) else v for k, v in row.items()} for row in rows]

    def rng(self, pair, start):
        """Each pair and start has its own numbers, however many others there are."""
        return np.random.default_rng(zlib.crc32(f"{self.world} {self.seed} {pair['source']} {pair['target']} {start}".encode()))

    def start_of(self, pair, start):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = pair["R"], pair["t"]
        rng = self.rng(pair, start)
        if start == FAR_START:  # in the plane and about the vertical: robots know which way is down
            up = np.array([0.0, 0.0, 1.0]) @ labels.to_matrix(
                self.submaps[self.number[pair["target"]]]["T_world_submap"])[:3, :3]
            level = np.cross(up, rng.normal(size=3))
            sign = rng.choice([-1.0, 1.0])
            return motion_about(pair["centre"], FAR_M * level / np.linalg.norm(level),
                                turn(up, sign * np.radians(FAR_DEG))) @ T
        metres, degrees = STARTS[start]
        direction, axis = rng.normal(size=3), rng.normal(size=3)
        return motion_about(pair["centre"], metres * direction / np.linalg.norm(direction),
                            turn(axis, np.radians(degrees))) @ T

    def slid(self, pair, bays):
        """The truth moved along the rows of a warehouse."""
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = pair["R"], pair["t"]
        along = labels.to_matrix(self.submaps[self.number[pair["target"]]]["T_world_submap"])[:3, :3].T[:, 0]
        return motion_about(pair["centre"], bays * BAY_M * along, np.eye(3)) @ T

    def ask(self, method, pairs, starts):
        """One answer a pair, in order."""
        if not pairs:
            return []
        lines = [f"{method} {self.number[pair['source']]} {self.number[pair['target']]} " +
                 " ".join(repr(float(x)) for x in to_pose(start)) for pair, start in zip(pairs, starts)]
        self.program.stdin.write("\n".join(lines) + "\n\n")
        self.program.stdin.flush()
        return [json.loads(self.program.stdout.readline()) for _ in lines]

    def trial(self, pair, start, said):
        """A row: what was asked, what was said, how far it is from the truth."""
        row = {"world": self.world, "seed": self.seed, "start": start, "source": pair["source"], "target": pair["target"],
               "overlap": pair["overlap"], "fixed": int(round(np.trace(pair["fixed"]))), "shares": pair["shares"].tolist()}
        row |= {key: value for key, value in said.items() if key not in ("covariance", "T_target_source")}
        row["error_m"] = None
        if said["T_target_source"] is not None:
            T = labels.to_matrix(said["T_target_source"])
            row["error_m"], row["error_all_m"], _, x = labels.pose_error(pair, T)
            observable = pair["unscale"] @ (pair["fixed"] @ np.linalg.solve(pair["unscale"], x))
            row["off_m"] = float(np.linalg.norm(observable[:3]))
            row["off_deg"] = float(np.degrees(np.linalg.norm(observable[3:])))
            if "covariance" in said:
                row |= calibration_row(pair, T, x, np.array(said["covariance"]).reshape(6, 6))
        row["success"] = bool(row["error_m"] is not None and row["off_m"] < NEAR_M and row["off_deg"] < NEAR_DEG)
        return row


def calibration_row(pair, T, x, covariance):
    """Error and covariance in lengths along the overlap's principal axes (ascending), translations then rotations times
    RMS distance from the axis; and both projected on what the scene fixes."""
    c = pair["centre"]
    skew = np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]])
    inverse = np.linalg.inv(T)
    R, t = inverse[:3, :3], inverse[:3, 3]
    adjoint = np.zeros((6, 6))
    adjoint[:3, :3] = adjoint[3:, 3:] = R
    adjoint[:3, 3:] = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]]) @ R
    to_origin = np.eye(6)
    to_origin[:3, 3:] = skew
    to_scaled = np.linalg.inv(adjoint @ to_origin @ pair["unscale"])
    return {"s": np.linalg.solve(pair["unscale"], x).tolist(), "S": (to_scaled @ covariance @ to_scaled.T).tolist(),
            "projector": pair["fixed"].tolist()}
