// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Numbers as people say them.
import { Quaternion, Vector3 } from "three";
import type { Archive, Pair, Pose } from "./archive.js";

export function centimetres(metres: number | null): string {
  if (metres === null) return "not measured";
  const cm = 100 * metres;
  if (cm > 0 && cm < 0.1) return `${cm.toPrecision(1)} cm`;
  return cm < 10 ? `${cm.toFixed(1)} cm` : `${Math.round(cm)} cm`;
}

export const sentence = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);

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

const kLeastWay = 0.1; // shorter ways have no direction. [m]
const kStride = 0.5; // between points that tell how straight a way is: poses jitter. [m]
const kStraight = 0.95; // of a way, its ends are so far apart: it turns by less than about 60 degrees

/** Where a robot's clouds were taken from one scan to another; null where the path does not tell. */
function wayBetween(path: Float64Array, scans: number, first: number, last: number): Vector3[] | null {
  const points = path.length / 3;
  if (!(scans > 1) || points < 2) return null;
  const step = Math.ceil((scans - 1) / (points - 1)); // a long path has every so manieth scan, and the last
  const way: Vector3[] = [];
  for (let i = Math.ceil(first / step); i < points && i * step <= last; i++) way.push(new Vector3().fromArray(path, 3 * i).setZ(0));
  return way;
}

function isStraight(way: Vector3[]): boolean {
  let at = way[0];
  let length = 0;
  for (const point of way) {
    const metres = point.distanceTo(at!);
    if (metres < kStride && point !== way[way.length - 1]) continue;
    length += metres;
    at = point;
  }
  return way.length === 0 || way[0]!.distanceTo(at!) >= kStraight * length;
}

/** Which way the robot went through a submap: level, unit length; null where it stood still, turned by much or nobody
 * knows. */
export function heading(archive: Archive, submap: number): Vector3 | null {
  const { robots, submaps } = archive.result;
  const own = submaps[submap]!;
  if (own.first_scan === null || own.last_scan === null) return null; // the pose of a finished cloud tells of no way
  const next = submaps[submap + 1];
  const number = robots.findIndex((robot) => robot.name === own.robot);
  const path = archive.paths[number] ?? new Float64Array(0);
  const goesOn = next?.robot === own.robot;
  const end = goesOn ? translation(next.T_world_submap) : new Vector3().fromArray(path, path.length - 3);
  const start = translation(own.T_world_submap).setZ(0);
  const chord = end.clone().setZ(0).sub(start);
  if (!(chord.length() > kLeastWay)) return null;
  const way = wayBetween(path, robots[number]?.scans ?? 0, own.first_scan, goesOn ? (next.first_scan ?? own.last_scan) : Infinity);
  if (way && !isStraight([start, ...way, end.setZ(0)])) return null;
  return chord.normalize();
}

/** The offset as the source's robot would feel it, or along the world's axes. [m] */
export type Parts = { along: number; across: number; up: number } | { x: number; y: number; z: number };

export function partsInWorld(archive: Archive, number: number): { x: number; y: number; z: number } | null {
  const pair = archive.result.pairs[number]!;
  if (!pair.offset_vector) return null;
  const target = archive.result.submaps[archive.pairs[number]!.target]!;
  const { x, y, z } = new Vector3(...pair.offset_vector).applyQuaternion(rotation(target.T_world_submap));
  return { x, y, z };
}

export function parts(archive: Archive, number: number): Parts | null {
  const world = partsInWorld(archive, number);
  const ahead = heading(archive, archive.pairs[number]!.source);
  if (!world || !ahead) return world;
  const { x, y, z } = world;
  return { along: x * ahead.x + y * ahead.y, across: y * ahead.x - x * ahead.y, up: z };
}

/** "120 cm back, 85 cm to the left, 6 cm up", or where that is not known "x-120 y+85 cm in world axes". */
export function shift(given: Parts | null): string {
  if (!given) return "";
  const robot = "along" in given;
  const all: [number, string, string][] = robot
    ? [
        [given.along, "ahead", "back"],
        [given.across, "to the left", "to the right"],
        [given.up, "up", "down"],
      ]
    : [
        [given.x, "x+", "x-"],
        [given.y, "y+", "y-"],
        [given.z, "z+", "z-"],
      ];
  const largest = Math.max(...all.map(([metres]) => Math.abs(metres)));
  const told = all.filter(([metres]) => Math.abs(metres) >= Math.max(0.005, 0.04 * largest));
  if (told.length === 0) return "";
  if (robot) return told.map(([metres, more, less]) => `${centimetres(Math.abs(metres))} ${metres > 0 ? more : less}`).join(", ");
  const digits = largest < 0.1 ? 1 : 0;
  const along = told.map(([metres, more, less]) => `${metres > 0 ? more : less}${(100 * Math.abs(metres)).toFixed(digits)}`);
  return `${along.join(" ")} cm in world axes`;
}

/** How the source would have to turn about the middle of what both saw, along the world's axes, its length the angle; null
 * where no registered pose tells. [rad] */
export function turn(archive: Archive, number: number): Vector3 | null {
  const pair = archive.result.pairs[number]!;
  const target = archive.result.submaps[archive.pairs[number]!.target]!;
  if (!pair.T_target_source_registered) return null;
  const by = rotation(pair.T_target_source_registered).multiply(rotation(pair.T_target_source).invert());
  const axis = new Vector3(by.x, by.y, by.z);
  const sine = axis.length();
  if (sine === 0) return axis;
  const angle = 2 * Math.atan2(sine, Math.abs(by.w)) * (by.w < 0 ? -1 : 1);
  return axis.multiplyScalar(angle / sine).applyQuaternion(rotation(target.T_world_submap));
}

/** "turned 2.4 degrees to the left" as seen from above, or "tilted by 2.4 degrees, front down": about a level axis, told
 * by the robot's way or the world's axes. */
export function turnInWords(by: Vector3, ahead: Vector3 | null): string {
  const angle = (180 / Math.PI) * by.length();
  const degrees = `${angle.toFixed(angle < 1 ? 2 : 1)} degrees`;
  if (Math.abs(by.z) >= Math.hypot(by.x, by.y)) return `turned ${degrees} to the ${by.z > 0 ? "left" : "right"}`;
  const x = ahead ?? new Vector3(1, 0, 0);
  const roll = by.x * x.x + by.y * x.y;
  const pitch = by.y * x.x - by.x * x.y; // about what lies to the left
  if (Math.abs(pitch) >= Math.abs(roll)) return `tilted by ${degrees}, ${ahead ? "front" : "its side towards x+"} ${pitch > 0 ? "down" : "up"}`;
  return `tilted by ${degrees}, ${ahead ? "left side" : "its side towards y+"} ${roll > 0 ? "up" : "down"}`;
}

export const kindInWords = {
  sequential: "one piece of a robot's way and the next",
  local: "a robot that came back to a place it had seen",
  global: "two robots at the same place",
} as const;
