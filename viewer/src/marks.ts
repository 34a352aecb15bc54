// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// What is drawn over points and beside them: pins, axes and strips of colours.
import { Vector3, type Quaternion } from "three";
import type { Pair } from "./archive.js";
import { css, verdictColour } from "./colours.js";
import { element } from "./dom.js";
import { halo, themed, type Pane } from "./scene.js";

/** A strip of colours, for a legend. */
export function ramp(colour: (share: number) => string): HTMLElement {
  const canvas = element("canvas", { class: "ramp" });
  canvas.width = 96;
  canvas.height = 1;
  const context = canvas.getContext("2d")!;
  for (let x = 0; x < 96; x++) {
    context.fillStyle = colour(x / 95);
    context.fillRect(x, 0, 1, 1);
  }
  return canvas;
}

/** A pin whose point is at a place of the pane. */
export function paintPin(context: CanvasRenderingContext2D, at: { x: number; y: number }, text: string, chosen: boolean, paper: string): void {
  const size = chosen ? 13 : 10;
  context.beginPath();
  context.moveTo(at.x, at.y);
  context.lineTo(at.x - size * 0.6, at.y - 14);
  context.arc(at.x, at.y - 16 - (size - 10), size, Math.PI * 0.85, Math.PI * 2.15);
  context.closePath();
  context.fillStyle = css(verdictColour("inconsistent"));
  context.strokeStyle = paper;
  context.lineWidth = 2;
  context.fill();
  context.stroke();
  context.fillStyle = "white";
  context.font = `bold ${chosen ? 14 : 12}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(text, at.x, at.y - 16 - (size - 10));
}

/** Over a pair, about its centre: what the scene leaves open, told along the target's axes. */
export function paintOpenDirections(pane: Pane, pair: Pair, worldFromTarget: Quaternion, context: CanvasRenderingContext2D): void {
  const { clientWidth: width, clientHeight: height } = pane.overlay;
  const ink = themed("--ink");
  const paper = themed("--canvas");
  const reach = 0.35 * Math.min(width, height) * pane.metresPerPixel(height);
  let line = 0;
  for (const twist of pair.unobservable ?? []) {
    const slide = new Vector3(twist[0], twist[1], twist[2]);
    const turn = new Vector3(twist[3], twist[4], twist[5]);
    const slides = slide.length() >= turn.length();
    const axis = (slides ? slide : turn).clone().normalize().applyQuaternion(worldFromTarget);
    // A turn with a shift across it is about another axis than the one through the centre.
    const middle = slides ? new Vector3() : turn.clone().cross(slide).divideScalar(turn.lengthSq()).applyQuaternion(worldFromTarget);
    const a = pane.project(middle.clone().addScaledVector(axis, -reach), width, height);
    const b = pane.project(middle.clone().addScaledVector(axis, reach), width, height);
    context.setLineDash([8, 5]);
    context.lineWidth = 6;
    context.strokeStyle = paper;
    const stroke = () => {
      context.beginPath();
      context.moveTo(a.x, a.y);
      context.lineTo(b.x, b.y);
      context.stroke();
    };
    stroke();
    context.lineWidth = 2.5;
    context.strokeStyle = ink;
    stroke();
    context.setLineDash([]);
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "bottom";
    const text = slides ? "nothing here fixes this direction" : "nothing here fixes turning about this axis";
    if (Math.hypot(a.x - b.x, a.y - b.y) < 24) {
      // Seen end on.
      context.strokeStyle = ink;
      context.beginPath();
      context.arc(a.x, a.y, 9, 0, 7);
      context.stroke();
    }
    const end = a.y < b.y ? a : b;
    const half = context.measureText(text).width / 2 + 6;
    const x = Math.min(width - half, Math.max(half, end.x));
    halo(context, text, x, Math.max(18, end.y - 12) + 16 * line++, ink, paper);
  }
}
