// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// A pane with points drawn by the graphics card and lines, pins and words drawn over them.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  GLSL3,
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
    const material = new RawShaderMaterial({
      vertexShader,
      fragmentShader,
      glslVersion: GLSL3,
      uniforms: { size: { value: 2 }, slice: { value: [-1e9, 1e9] } },
    });
    this.points = new Points(geometry, material);
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

/** How many points are drawn while the view moves. */
const kMoving = 150_000;

export class Pane {
  readonly scene = new Scene();
  readonly camera = new OrthographicCamera(-1, 1, 1, -1, -1e5, 1e5);
  readonly root: HTMLElement;
  readonly overlay: HTMLCanvasElement;
  readonly controls: OrbitControls;
  paint: Painter = () => undefined;
  clouds: CloudPoints[] = [];
  frames = 0;
  private readonly renderer: WebGLRenderer | null = null;
  private readonly pixelRatio = Math.min(window.devicePixelRatio || 1, 2);
  private asked = false;
  private moving = 0;
  private halfHeight = 10;

  constructor(label: string, dragPans: boolean) {
    const canvas = element("canvas", { class: "points", label });
    this.overlay = element("canvas", { class: "overlay" });
    this.root = element("div", { class: "pane" }, canvas, this.overlay);
    try {
      this.renderer = new WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true });
      this.renderer.setPixelRatio(this.pixelRatio);
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
      this.moving = performance.now();
      this.render();
    });
    new ResizeObserver(() => this.render()).observe(this.root);
  }

  background(colour: string): void {
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
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
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
    const settled = performance.now() - this.moving > 120;
    const total = this.clouds.reduce((sum, cloud) => sum + cloud.count, 0);
    const share = settled || total <= kMoving ? 1 : kMoving / total;
    for (const cloud of this.clouds) cloud.show(Math.ceil(cloud.count * share));
    if (this.renderer) {
      const size = this.renderer.getSize(new Vector2());
      if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
      this.renderer.render(this.scene, this.camera);
    }
    const surface = fitted(this.overlay);
    this.paint(surface.context, surface.width, surface.height);
    this.frames++;
    if (!settled) setTimeout(() => this.render(), 140);
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

export function themed(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
