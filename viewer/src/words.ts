// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Numbers as people say them.
import { Quaternion, Vector3 } from "three";
import type { Archive, Pair, Pose, Submap } from "./archive.js";

export function centimetres(metres: number | null): string {
  if (metres === null) return "not measured";
  const cm = 100 * metres;
  return cm < 10 ? `${cm.toFixed(1)} cm` : `${Math.round(cm)} cm`;
}

export function interval(pair: Pair): string {
  if (!pair.offset_interval_m) return "";
  const [low, high] = pair.offset_interval_m;
  const digits = (pair.offset_m ?? 0) < 0.1 ? 1 : 0;
  return `${(100 * low).toFixed(digits)} to ${(100 * high).toFixed(digits)} cm`;
}

export function degrees(pair: Pair): string {
  return pair.offset_deg === null ? "" : `${pair.offset_deg.toFixed(1)}°`;
}

export function probability(p: number | null): string {
  if (p === null) return "no probability";
  if (p > 0.995) return "practically certain to be too far apart";
  if (p < 0.005) return "practically certain not to be too far apart";
  return `too far apart with probability ${p.toFixed(2)}`;
}

export function shortProbability(p: number | null): string {
  if (p === null) return "";
  if (p > 0.995) return "> 0.99";
  if (p < 0.005) return "< 0.01";
  return p.toFixed(2);
}

export function large(value: number | null): string {
  if (value === null) return "none";
  return Math.abs(value) >= 1e4 || (value !== 0 && Math.abs(value) < 0.01) ? value.toExponential(2) : value.toPrecision(4);
}

export const rotation = (pose: Pose): Quaternion => new Quaternion(pose[3], pose[4], pose[5], pose[6]);
export const translation = (pose: Pose): Vector3 => new Vector3(pose[0], pose[1], pose[2]);

/** Which way the robot went through a submap: level, unit length; world x where it stood still. */
export function heading(archive: Archive, submap: number): Vector3 {
  const submaps = archive.result.submaps;
  const own = submaps[submap]!;
  const other = [submaps[submap + 1], submaps[submap - 1]].find((next) => next?.robot === own.robot);
  if (!other) return new Vector3(1, 0, 0);
  const sign = other.index > own.index ? 1 : -1;
  const way = translation(other.T_world_submap).sub(translation(own.T_world_submap)).multiplyScalar(sign).setZ(0);
  return way.length() > 0.1 ? way.normalize() : new Vector3(1, 0, 0);
}

export interface Parts {
  along: number;
  across: number;
  up: number;
}

/** The offset as the source's robot would feel it: ahead, to its left, up. [m] */
export function parts(archive: Archive, number: number): Parts | null {
  const pair = archive.result.pairs[number]!;
  const picture = archive.pairs[number]!;
  if (!pair.offset_vector) return null;
  const target = archive.result.submaps[picture.target]!;
  const shift = new Vector3(...pair.offset_vector).applyQuaternion(rotation(target.T_world_submap));
  const ahead = heading(archive, picture.source);
  const left = new Vector3(-ahead.y, ahead.x, 0);
  return { along: shift.dot(ahead), across: shift.dot(left), up: shift.z };
}

/** "120 cm back, 85 cm to the left, 6 cm up" */
export function shift(given: Parts | null): string {
  if (!given) return "";
  const all: [number, string, string][] = [
    [given.along, "ahead", "back"],
    [given.across, "to the left", "to the right"],
    [given.up, "up", "down"],
  ];
  const largest = Math.max(...all.map(([metres]) => Math.abs(metres)));
  return all
    .filter(([metres]) => Math.abs(metres) >= Math.max(0.005, 0.04 * largest))
    .map(([metres, more, less]) => `${centimetres(Math.abs(metres))} ${metres > 0 ? more : less}`)
    .join(", ");
}

function scans(submap: Submap): string {
  return submap.first_scan === null ? submap.id : `scans ${submap.first_scan} to ${submap.last_scan} of ${submap.robot}`;
}

export const kindInWords = {
  sequential: "one piece of a robot's way and the next",
  local: "a robot that came back to a place it had seen",
  global: "two robots at the same place",
} as const;

/** What would decide a pair that is not decided. */
function undecided(pair: Pair): string {
  const says = (words: string) => pair.reason.includes(words);
  if (says("no free space speaks against the map")) {
    return "Not decided: what lies near each other here was seen from opposite sides, such as a floor and the ceiling below. Nothing speaks against the map.";
  }
  if (says("too little overlap")) return "Not decided: the two saw too little in common. Another pass through here would settle it.";
  if (says("direction that nothing")) {
    return "Not decided: along the dashed axis the two could be apart and nobody would see it. A pass that sees something across it would settle it.";
  }
  if (says("registration failed")) return "Not decided: the two could not be brought together. Look at both clouds here: they may be of different places, or far apart.";
  if (says("conflicts")) return "Not decided: even once registered the two contradict each other. Something moved here, or they are of different places.";
  if (says("no rigid motion mends")) return "Not decided: one of the two is bent inside, by about as much as you can live with. Shorter submaps would tell where.";
  if (says("too uncertain")) return "Not decided: what both saw tells the offset no better than that. Another pass through here would settle it.";
  if (correctionOpen(pair) && pair.offset_m !== null) {
    return `Not decided: it would also fit ${centimetres(pair.offset_m)} off, but something speaks against that, as said below. Look at both clouds and judge.`;
  }
  return "Not decided: look at both clouds and judge.";
}

/** Evidence that has a log ratio only where it decides without a registration that is believed: free space alone, a pose
 * that fits better, neighbours. */
const WITNESSES = ["conflict", "support", "agreeing"];

/** Whether the right pose is not known, though a registration may have ended somewhere: a witness says that the map's is
 * wrong, or nothing was decided since the registration is not believed. Such a pair has no constraint. */
export function correctionOpen(pair: Pair): boolean {
  if (pair.verdict === "unverified" && pair.p_value === null) return true;
  return WITNESSES.some((name) => (pair.evidence[name]?.log_ratio ?? null) !== null);
}

/** What to do about a pair, in plain words. */
export function action(archive: Archive, number: number): string {
  const pair = archive.result.pairs[number]!;
  const target = archive.result.submaps[archive.pairs[number]!.target]!;
  const source = archive.result.submaps[archive.pairs[number]!.source]!;
  if (pair.verdict === "unverified") return undecided(pair);
  if (pair.verdict === "consistent") return "Nothing to mend here at the tolerance asked for.";
  const both = `${scans(target)} and ${scans(source)}`;
  if (correctionOpen(pair)) {
    return `${both} do not fit as the map has them; what would mend it is not known, and constraints.g2o has no link here. Mend the others around it first, then check again.`;
  }
  switch (pair.kind) {
    case "sequential":
      return `The poses of ${both} do not fit each other: look at the odometry there and, where many pairs of ${source.robot} say so, at its sensor's mounting and time stamps.`;
    case "local":
      return `${source.robot} came back and put this place elsewhere: a link between ${both} is missing or wrong, or its way there is bent.`;
    case "global":
      return `The maps of ${target.robot} and ${source.robot} do not fit here: add the link from constraints.g2o, or look for a wrong one, between ${both}.`;
  }
}
