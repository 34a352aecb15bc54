// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Colours come from the program, so that its PNG pictures and this page agree.
import type { Verdict } from "./archive.js";
import { byId } from "./dom.js";

export type Rgb = readonly [number, number, number];

interface Palette {
  robots: Rgb[];
  verdicts: Record<Verdict, Rgb>;
  scale: Rgb[]; // even steps, dark to bright
  below: Rgb; // for values that have no place on a log scale
  misalignment: Rgb[]; // none decided, then small to large
}

let loaded: Palette | null = null;

function palette(): Palette {
  loaded ??= JSON.parse(byId("palette").textContent ?? "") as Palette;
  return loaded;
}

export const css = (colour: Rgb): string => `rgb(${colour[0]} ${colour[1]} ${colour[2]})`;

export function robotColour(robot: number): Rgb {
  const robots = palette().robots;
  return robots[robot % robots.length]!;
}

export const verdictColour = (verdict: Verdict): Rgb => palette().verdicts[verdict];

function along(stops: Rgb[], share: number): Rgb {
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  const mix = at - low;
  const a = stops[low]!;
  const b = stops[low + 1]!;
  return [0, 1, 2].map((c) => Math.round(a[c]! + mix * (b[c]! - a[c]!))) as unknown as Rgb;
}

/** Perceptually even and safe for colour-blind eyes; 0 dark, 1 bright. */
export const scaleColour = (share: number): Rgb => along(palette().scale, share);

export const belowColour = (): Rgb => palette().below;

/** Of a misalignment byte: grey where nothing was decided, then from calm to alarming between 0 and 10 tolerances. */
export function misalignmentColour(byte: number, tolerance_m: number): Rgb {
  const stops = palette().misalignment;
  if (byte === 0) return stops[0]!;
  return along(stops.slice(1), misalignmentShare((byte - 1) * 0.01, tolerance_m));
}

export function misalignmentShare(metres: number, tolerance_m: number): number {
  const tenths = (10 * metres) / tolerance_m;
  return tenths <= 1 ? 0 : Math.log10(tenths) / 2; // a tenth of the tolerance .. ten times it
}

export const targetColour: Rgb = [58, 134, 222];
export const sourceColour: Rgb = [240, 140, 20];
