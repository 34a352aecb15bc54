// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// A pane with points drawn by the graphics card and lines, pins and words drawn over them.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  GLSL3,
  LineSegments,
  Matrix4,
  MOUSE,
  OrthographicCamera,
  Points,
  RawShaderMaterial,
  Scene,
  TOUCH,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { element, fitted } from "./dom.js";

const vertexShader = `
precision highp float;
in vec3 position;
in vec3 tint;
in float height;
uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform float size;
uniform vec2 slice;
out vec3 colour;
void main() {
  colour = tint;
  gl_PointSize = size;
  gl_Position = projectionMatrix * viewMatrix * modelMatrix * vec4(position, 1.0);
  if (height < slice.x || height > slice.y) gl_Position = vec4(0.0, 0.0, 2.0, 0.0);
}`;

const fragmentShader = `
precision mediump float;
in vec3 colour;
out vec4 result;
void main() { result = vec4(colour, 1.0); }`;

function material(): RawShaderMaterial {
  return new RawShaderMaterial({
    vertexShader,
    fragmentShader,
    glslVersion: GLSL3,
    uniforms: { size: { value: 2 }, slice: { value: [-1e9, 1e9] } },
  });
}

/** Thin lines for while the view moves: the overlay draws them better, but takes longer. */
export class ThinLines {
  readonly lines: LineSegments<BufferGeometry, RawShaderMaterial>;
  private readonly heights: BufferAttribute;

  /** ends: six numbers for each line. */
  constructor(ends: Float32Array, colour: (line: number) => readonly [number, number, number]) {
    const geometry = new BufferGeometry();
    const tint = new Uint8Array(ends.length);
    for (let vertex = 0; vertex < ends.length / 3; vertex++) tint.set(colour(vertex >> 1), 3 * vertex);
    this.heights = new BufferAttribute(new Float32Array(ends.length / 3), 1);
    geometry.setAttribute("position", new BufferAttribute(ends, 3));
    geometry.setAttribute("tint", new BufferAttribute(tint, 3, true));
    geometry.setAttribute("height", this.heights);
    this.lines = new LineSegments(geometry, material());
    this.lines.material.depthTest = false;
    this.lines.renderOrder = 1;
    this.lines.frustumCulled = false;
  }

  show(visible: (line: number) => boolean): void {
    const heights = this.heights.array as Float32Array;
    for (let vertex = 0; vertex < heights.length; vertex++) heights[vertex] = visible(vertex >> 1) ? 0 : 2e9;
    this.heights.needsUpdate = true;
  }
}

export class CloudPoints {
  readonly points: Points<BufferGeometry, RawShaderMaterial>;
  private readonly tint: BufferAttribute;

  /** heights decide what a slice leaves. */
  constructor(
    readonly positions: Float32Array,
    heights: Float32Array,
  ) {
    const geometry = new BufferGeometry();
    this.tint = new BufferAttribute(new Uint8Array(positions.length), 3, true);
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("tint", this.tint);
    geometry.setAttribute("height", new BufferAttribute(heights, 1));
    this.points = new Points(geometry, material());
    this.points.frustumCulled = false;
    this.points.matrixAutoUpdate = false;
  }

  get count(): number {
    return this.positions.length / 3;
  }

  colour(of: (point: number, out: Uint8Array, at: number) => void): void {
    const bytes = this.tint.array as Uint8Array;
    for (let i = 0; i < this.count; i++) of(i, bytes, 3 * i);
    this.tint.needsUpdate = true;
  }

  slice(low: number, high: number): void {
    this.points.material.uniforms["slice"]!.value = [low, high];
  }

  size(pixels: number): void {
    this.points.material.uniforms["size"]!.value = pixels;
  }

  move(matrix: Matrix4): void {
    this.points.matrix.copy(matrix);
    this.points.matrixWorldNeedsUpdate = true;
  }

  show(first: number): void {
    this.points.geometry.setDrawRange(0, first);
  }

  dispose(): void {
    this.points.geometry.dispose();
    this.points.material.dispose();
  }
}

export type Painter = (context: CanvasRenderingContext2D, width: number, height: number) => void;

/** Points drawn while the view moves: as many as leave time for a fluent picture, between these. */
const kFewest = 15_000;
const kMost = 400_000;
/** Milliseconds between two frames that are too many, and so few that more could be drawn. */
const kSlow = 45;
const kFast = 25;

export class Pane {
  readonly scene = new Scene();
  readonly camera = new OrthographicCamera(-1, 1, 1, -1, -1e5, 1e5);
  readonly root: HTMLElement;
  readonly overlay: HTMLCanvasElement;
  readonly controls: OrbitControls;
  paint: Painter = () => undefined;
  /** Told before each picture whether the view rests. */
  prepare: (settled: boolean) => void = () => undefined;
  clouds: CloudPoints[] = [];
  frames = 0;
  /** False while the view moves: then less is drawn. */
  settled = true;
  private readonly renderer: WebGLRenderer | null = null;
  private readonly pixelRatio = Math.min(window.devicePixelRatio || 1, 2);
  private asked: "" | "overlay" | "all" = "";
  private rest = 0;
  private lastFrame = 0;
  private affordable = 60_000;
  private halfHeight = 10;
  private colour = "white";

  constructor(label: string, dragPans: boolean) {
    const canvas = element("canvas", { class: "points", label });
    this.overlay = element("canvas", { class: "overlay" });
    this.root = element("div", { class: "pane" }, canvas, this.overlay);
    try {
      this.renderer = new WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true });
      this.renderer.setPixelRatio(this.pixelRatio);
      // A graphics card that was lost, as by sleep, forgets pictures and colours.
      canvas.addEventListener("webglcontextrestored", () => {
        this.background(this.colour);
        this.render();
      });
    } catch {
      this.root.append(element("p", { class: "missing" }, "This browser draws no WebGL: the points are missing here."));
    }
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.overlay);
    this.controls.enableDamping = false;
    this.controls.screenSpacePanning = true;
    this.controls.mouseButtons = dragPans
      ? { LEFT: MOUSE.PAN, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.ROTATE }
      : { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    this.controls.touches = { ONE: dragPans ? TOUCH.PAN : TOUCH.ROTATE, TWO: TOUCH.DOLLY_ROTATE };
    this.controls.addEventListener("change", () => {
      this.settled = false;
      clearTimeout(this.rest);
      this.render();
    });
    new ResizeObserver(() => this.render()).observe(this.root);
  }

  /** False where the browser has no WebGL. */
  get drawsPoints(): boolean {
    return this.renderer !== null;
  }

  background(colour: string): void {
    this.colour = colour;
    this.renderer?.setClearColor(new Color(colour), 1);
  }

  /** Looks at `centre` from `direction`, so that `radius` fits. */
  look(centre: Vector3, radius: number, direction: Vector3): void {
    this.halfHeight = Math.max(radius, 0.5);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction.clone().normalize(), 1000);
    this.camera.zoom = 1;
    this.controls.update();
    this.render();
  }

  /** Where a point lies in the pane. */
  project(point: Vector3, width: number, height: number): { x: number; y: number } {
    const at = point.clone().project(this.camera);
    return { x: ((at.x + 1) / 2) * width, y: ((1 - at.y) / 2) * height };
  }

  metresPerPixel(height: number): number {
    return (2 * this.halfHeight) / this.camera.zoom / height;
  }

  render(): void {
    this.ask("all");
  }

  /** Where the points stay as they are: only what is drawn over them. */
  repaint(): void {
    this.ask("overlay");
  }

  private ask(what: "overlay" | "all"): void {
    const waits = this.asked !== "";
    if (this.asked !== "all") this.asked = what;
    if (waits) return;
    requestAnimationFrame(() => {
      const all = this.asked === "all";
      this.asked = "";
      if (all) this.draw();
      else this.drawOverlay();
    });
  }

  private drawOverlay(): void {
    if (this.root.clientWidth === 0 || this.root.clientHeight === 0) return;
    const { context, width, height } = fitted(this.overlay);
    this.paint(context, width, height);
  }

  draw(): void {
    const width = this.root.clientWidth;
    const height = this.root.clientHeight;
    if (width === 0 || height === 0) return;
    // Wide or high: `halfHeight` fits either way.
    const half = this.halfHeight * Math.max(1, height / width);
    this.camera.left = (-half * width) / height;
    this.camera.right = (half * width) / height;
    this.camera.top = half;
    this.camera.bottom = -half;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    const now = performance.now();
    const total = this.clouds.reduce((sum, cloud) => sum + cloud.count, 0);
    const between = now - this.lastFrame;
    this.lastFrame = now;
    if (!this.settled && between > kSlow && between < 1000) this.affordable = Math.max(kFewest, this.affordable * 0.7);
    if (!this.settled && between < kFast) this.affordable = Math.min(kMost, this.affordable * 1.15);
    const share = this.settled ? 1 : Math.min(1, this.affordable / Math.max(1, total));
    for (const cloud of this.clouds) cloud.show(Math.ceil(cloud.count * share));
    this.prepare(this.settled);
    if (this.renderer) {
      const size = this.renderer.getSize(new Vector2());
      if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
      this.renderer.render(this.scene, this.camera);
    }
    this.drawOverlay();
    this.frames++;
    // Only once a coarse picture is out and nothing has moved since: else slow pictures would all be drawn in full.
    clearTimeout(this.rest);
    if (!this.settled) {
      this.rest = window.setTimeout(() => {
        this.settled = true;
        this.render();
      }, 200);
    }
  }

  /** A bar of a round length, lower left. */
  scaleBar(context: CanvasRenderingContext2D, width: number, height: number, ink: string): void {
    const half = this.halfHeight * Math.max(1, height / width);
    const metres = (2 * half) / this.camera.zoom / height;
    const wanted = 90 * metres;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const length = power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
    const pixels = length / metres;
    const text = length >= 1 ? `${length} m` : `${Math.round(length * 100)} cm`;
    context.strokeStyle = context.fillStyle = ink;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(12, height - 18);
    context.lineTo(12, height - 12);
    context.lineTo(12 + pixels, height - 12);
    context.lineTo(12 + pixels, height - 18);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "bottom";
    context.fillText(text, 16, height - 16);
  }
}

/** Words with a halo, readable on any points. */
export function halo(context: CanvasRenderingContext2D, text: string, x: number, y: number, ink: string, paper: string): void {
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = paper;
  context.strokeText(text, x, y);
  context.fillStyle = ink;
  context.fillText(text, x, y);
}

const remembered = new Map<string, string>();

/** A colour of the style sheet; asked for often, so it is remembered until the theme changes. */
export function themed(name: string): string {
  let value = remembered.get(name);
  if (value === undefined) {
    value = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    remembered.set(name, value);
  }
  return value;
}

export function forgetTheme(): void {
  remembered.clear();
}

/** An order of things whose every beginning is an even thinning of them: each 16th, then the next of each 16, ... */
export function evenOrder(count: number): Uint32Array {
  const order = new Uint32Array(count);
  let to = 0;
  for (let phase = 0; phase < 16; phase++) for (let i = phase; i < count; i += 16) order[to++] = i;
  return order;
}
