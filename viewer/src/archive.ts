// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Reads result.kilter (docs/archive.md), as the program that wrote this page packed it into it.

export type Pose = readonly [number, number, number, number, number, number, number];

export interface Submap {
  id: string;
  robot: string;
  index: number;
  first_scan: number | null;
  last_scan: number | null;
  T_world_submap: Pose;
  occupied: number;
}

export type Kind = "sequential" | "local" | "global";
export type Verdict = "consistent" | "inconsistent" | "unverified";

export interface Evidence {
  value: number | null;
  null: number | null;
  log_ratio: number | null;
}

export interface Histogram {
  width: number;
  counts: number[];
}

export interface Pair {
  target: string;
  source: string;
  kind: Kind;
  overlap: number;
  matched: number;
  d: number;
  histogram: Histogram | null;
  mu: number | null;
  sigma: number | null;
  gamma: number | null;
  theta: number | null;
  verified: number | null;
  evidence: Record<string, Evidence>;
  offset_m: number | null;
  offset_interval_m: [number, number] | null;
  offset_deg: number | null;
  offset_vector: [number, number, number] | null;
  gap_m: number | null;
  minimum_detectable_m: number | null;
  unobservable: number[][] | null;
  p_value: number | null;
  p_inconsistent: number | null;
  verdict: Verdict;
  reason: string;
  T_target_source: Pose;
  T_target_source_registered: Pose | null;
}

/** A robot whose map lies off another's as a whole, and what mends that: all of its poses moved in the world. */
export interface Frame {
  target: string;
  source: string;
  T_world_correction: Pose;
  shift: [number, number, number]; // of the middle of what those pairs saw, world axes
  agreeing: number;
  witnesses: number;
}

export interface Result {
  version: string;
  config: Record<string, unknown>;
  config_digest: string;
  robots: { name: string; scans: number; path_length_m: number; submaps: number }[];
  submaps: Submap[];
  pairs: Pair[];
  system: {
    verdict: "consistent" | "inconsistent" | "undetermined";
    reason: string;
    certificate_m: number | null;
    certificate_of?: [string, string] | null; // absent from archives of older programs, as `frames` is
    certificate_excludes: [string, string][];
    frames?: Frame[];
    tested: number;
    inconsistent: number;
    unverified: number;
    candidates: number;
    too_little_overlap: number;
    decided: { sequential: number | null; local: number | null; global: Record<string, number | null> };
  };
}

/** A submap's thinned surface, in its own frame [m]. */
export interface Cloud {
  voxels: number;
  origin: [number, number, number]; // of the points: they may be far from the submap's, where floats are coarse
  points: Float32Array; // x y z, ... from the origin
  misalignment: Uint8Array; // 0 = seen once only; else 1 + centimetres
}

export const kNothing = 127; // low seven bits: no surface within d
export const kThrough = 128; // bit: stands where the other saw through
export const kSteps = 126; // d in steps

export interface Samples {
  before: Uint8Array;
  after: Uint8Array;
}

export interface PairPicture {
  source: number; // submap numbers
  target: number;
  centre: [number, number, number]; // world
  stride: number;
  sourceSamples: Samples;
  targetSamples: Samples;
  registeredHistogram: Histogram | null;
  registeredMu: number | null;
  registeredSigma: number | null;
}

export interface Archive {
  result: Result;
  maxDistance: number;
  paths: Float64Array[];
  clouds: Cloud[];
  pairs: PairPicture[];
}

class Cursor {
  private readonly view: DataView;
  private at = 0;
  constructor(private readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }
  u8(): number {
    return this.view.getUint8(this.at++);
  }
  u32(): number {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }
  u64(): number {
    this.at += 8;
    return Number(this.view.getBigUint64(this.at - 8, true));
  }
  f64(): number {
    this.at += 8;
    return this.view.getFloat64(this.at - 8, true);
  }
  take(size: number): Uint8Array {
    if (this.at + size > this.bytes.length) throw new Error("the archive in this page is cut short");
    this.at += size;
    return this.bytes.subarray(this.at - size, this.at);
  }
}

function base64(text: string): Uint8Array {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

export async function unpack(text: string): Promise<Uint8Array> {
  const packed = new Blob([base64(text) as Uint8Array<ArrayBuffer>]).stream();
  return new Uint8Array(await new Response(packed.pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
}

function readCloud(cursor: Cursor): Cloud {
  const voxels = cursor.u64();
  const origin: [number, number, number] = [cursor.f64(), cursor.f64(), cursor.f64()];
  const step = cursor.f64();
  const count = cursor.u32();
  const points = new Float32Array(3 * count);
  for (let axis = 0; axis < 3; axis++) {
    const low = cursor.take(count);
    const high = cursor.take(count);
    for (let i = 0; i < count; i++) points[3 * i + axis] = step * (low[i]! + 256 * high[i]!);
  }
  return { voxels, origin, points, misalignment: cursor.take(count) };
}

function readPair(cursor: Cursor): PairPicture {
  const source = cursor.u32();
  const target = cursor.u32();
  const centre: [number, number, number] = [cursor.f64(), cursor.f64(), cursor.f64()];
  const stride = cursor.u32();
  const ofSource = cursor.u32();
  const ofTarget = cursor.u32();
  const flags = cursor.u8();
  let registeredHistogram: Histogram | null = null;
  if (flags & 2) {
    const width = cursor.f64();
    registeredHistogram = { width, counts: Array.from({ length: cursor.u32() }, () => cursor.u64()) };
  }
  const [registeredMu, registeredSigma] = flags & 4 ? [cursor.f64(), cursor.f64()] : [null, null];
  const samples = (count: number): Samples => ({
    before: cursor.take(count),
    after: flags & 1 ? cursor.take(count) : new Uint8Array(0),
  });
  return {
    source,
    target,
    centre,
    stride,
    sourceSamples: samples(ofSource),
    targetSamples: samples(ofTarget),
    registeredHistogram,
    registeredMu,
    registeredSigma,
  };
}

export function readArchive(bytes: Uint8Array): Archive {
  const head = new Cursor(bytes);
  head.take(8);
  if (head.u32() !== 1) throw new Error("this page holds an archive of another version");
  const sections: Uint8Array[] = [];
  for (let left = head.u32(); left > 0; left--) {
    head.take(8);
    sections.push(head.take(head.u64()));
  }
  const result = JSON.parse(new TextDecoder().decode(sections[0])) as Result;
  const pathCursor = new Cursor(sections[1]!);
  const maxDistance = pathCursor.f64();
  const paths = Array.from({ length: pathCursor.u32() }, () => {
    const numbers = new Float64Array(3 * pathCursor.u32());
    for (let i = 0; i < numbers.length; i++) numbers[i] = pathCursor.f64();
    return numbers;
  });
  const cloudCursor = new Cursor(sections[2]!);
  const clouds = Array.from({ length: cloudCursor.u32() }, () => readCloud(cloudCursor));
  const pairCursor = new Cursor(sections[3]!);
  const pairs = Array.from({ length: pairCursor.u32() }, () => readPair(pairCursor));
  return { result, maxDistance, paths, clouds, pairs };
}
