// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Where submaps lie, how high their walls are, and what of a map fits a picture of it.
import { Matrix4, Vector3 } from "three";
import type { Archive } from "./archive.js";
import { rotation, translation } from "./words.js";

/** Around the sensor's height: walls without floor and ceiling. [m] */
export const kWalls = [-0.7, 0.9] as const;
export const kEverything = [-1e9, 1e9] as const;

// A finished cloud has no sensor: one is taken to have stood so far above its floor, which few points lie below. [m]
const kSensorAboveFloor = 1.2;
const kBelowFloor = 0.05;
const kLeastInWalls = 0.05; // of all points: with fewer between them the picture would look empty
const kSampled = 2000; // points of a cloud that stand for all of it
const kSampledOfAll = 20_000; // points of a map
const kUnit = new Vector3(1, 1, 1);

/** The value below which a share of the numbers lies; puts them in order. */
export function percentile(numbers: number[], share: number): number {
  numbers.sort((a, b) => a - b);
  return numbers[Math.min(numbers.length - 1, Math.floor(share * numbers.length))] ?? 0;
}

export function meanOf(points: Vector3[]): Vector3 {
  const sum = new Vector3();
  for (const point of points) sum.add(point);
  return sum.divideScalar(Math.max(1, points.length));
}

/** From a cloud's points to the world less some place of it: the large numbers are gone before floats are. */
export function worldFromCloud(archive: Archive, submap: number, less: Vector3): Matrix4 {
  const pose = archive.result.submaps[submap]!.T_world_submap;
  const origin = new Vector3(...archive.clouds[submap]!.origin).applyQuaternion(rotation(pose));
  return new Matrix4().compose(translation(pose).add(origin).sub(less), rotation(pose), kUnit);
}

/** Whether it came as one cloud: then its pose says nothing of where a robot was. */
export function isFinished(archive: Archive, submap: number): boolean {
  return archive.result.submaps[submap]!.first_scan === null;
}

/** Evenly thinned points of a cloud, relative to the start of its submap, along the world's axes. */
function sampled(archive: Archive, submap: number, most = kSampled): Vector3[] {
  const { points } = archive.clouds[submap]!;
  const count = points.length / 3;
  const every = Math.max(1, Math.floor(count / most));
  const start = translation(archive.result.submaps[submap]!.T_world_submap);
  const matrix = worldFromCloud(archive, submap, start);
  const found: Vector3[] = [];
  for (let i = 0; i < count; i += every) found.push(new Vector3().fromArray(points, 3 * i).applyMatrix4(matrix));
  return found;
}

/** The place that stands for a submap in the world: its start, or the middle of a finished cloud. */
export function placeOf(archive: Archive, submap: number): Vector3 {
  const start = translation(archive.result.submaps[submap]!.T_world_submap);
  if (!isFinished(archive, submap)) return start;
  const points = sampled(archive, submap);
  const middle = (of: (p: Vector3) => number) => percentile(points.map(of), 0.5);
  return start.add(new Vector3(middle((p) => p.x), middle((p) => p.y), middle((p) => p.z)));
}

/** How high the sensor stood above the start of a submap, upwards in the world. [m] */
export function sensorHeight(archive: Archive, submap: number): number {
  if (!isFinished(archive, submap)) return 0;
  return percentile(sampled(archive, submap).map((p) => p.z), kBelowFloor) + kSensorAboveFloor;
}

/** So many points of each cloud, where all together stand for the map. */
const shareOf = (archive: Archive): number => Math.max(40, Math.floor(kSampledOfAll / archive.clouds.length));

/** Whether a slice about as high as the sensors leaves enough to be looked at first. */
export function wallsShow(archive: Archive): boolean {
  let all = 0;
  let between = 0;
  archive.clouds.forEach((_, submap) => {
    const level = sensorHeight(archive, submap);
    for (const { z } of sampled(archive, submap, shareOf(archive))) {
      all++;
      if (z - level >= kWalls[0] && z - level <= kWalls[1]) between++;
    }
  });
  return between >= kLeastInWalls * all;
}

/** What a picture of the map has to show: where the robots were and most of the points around them, for far single points
 * must not shrink it; of finished clouds most of their points. `less` is taken off all of it. */
export function extentOf(archive: Archive, less: Vector3): { centre: Vector3; radius: number } {
  const { robots } = archive.result;
  const low = new Vector3(Infinity, Infinity, Infinity);
  const high = new Vector3(-Infinity, -Infinity, -Infinity);
  const scanned = new Set(archive.result.submaps.filter((submap) => submap.first_scan !== null).map((submap) => submap.robot));
  archive.paths.forEach((path, robot) => {
    if (!scanned.has(robots[robot]!.name)) return;
    for (let i = 0; i < path.length; i += 3) {
      const point = new Vector3(path[i], path[i + 1], path[i + 2]).sub(less);
      low.min(point), high.max(point);
    }
  });
  const points: Vector3[] = [];
  archive.clouds.forEach((_, submap) => {
    const own = sampled(archive, submap, shareOf(archive));
    const start = translation(archive.result.submaps[submap]!.T_world_submap).sub(less);
    for (const point of own) points.push(point.add(start));
    if (!isFinished(archive, submap) || own.length === 0) return;
    const at = (share: number) =>
      new Vector3(percentile(own.map((p) => p.x), share), percentile(own.map((p) => p.y), share), percentile(own.map((p) => p.z), share));
    low.min(at(0.02)), high.max(at(0.98));
  });
  if (!Number.isFinite(low.x)) return { centre: new Vector3(), radius: 10 };
  const centre = low.clone().add(high).multiplyScalar(0.5);
  const half = Math.max(high.x - low.x, high.y - low.y) / 2;
  const reach = points.map((point) => Math.max(Math.abs(point.x - centre.x), Math.abs(point.y - centre.y)));
  const most = reach.length === 0 ? 5 : percentile(reach, 0.97);
  return { centre, radius: Math.max(half * 1.05, Math.min(most, 2 * half + 10)) };
}
