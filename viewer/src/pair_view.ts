// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// The two submaps of a pair on top of each other, as the map has them and as registration would.
import { Matrix4, Vector3 } from "three";
import { kNothing, kSteps, kThrough, type Pair, type PairPicture, type Samples } from "./archive.js";
import { belowColour, css, scaleColour, sourceColour, targetColour, verdictColour } from "./colours.js";
import { byId, choice, element } from "./dom.js";
import { isFinished, kEverything, kWalls, placeOf, sensorHeight, wallsShow, worldFromCloud } from "./framing.js";
import { paintOpenDirections } from "./marks.js";
import { shortened } from "./names.js";
import { drawnAs, legendOf, type Colouring } from "./pair_words.js";
import { CloudPoints, evenOrder, halo, Pane, themed } from "./scene.js";
import type { State } from "./state.js";
import { rotation, translation } from "./words.js";

const kUnit = new Vector3(1, 1, 1);

interface Side {
  cloud: CloudPoints;
  sampled: CloudPoints; // those points whose distances are known
  samples: Samples;
  place: Vector3; // that stands for the submap, among the points
}

export class PairView {
  readonly pane = new Pane("both submaps of the selected pair", false);
  private readonly slider: HTMLInputElement;
  private readonly title = element("h2", {});
  private readonly note = element("span", { class: "legend" });
  private readonly shown = element("p", { class: "quiet as-drawn" }); // on paper, which has no slider
  private colouring: Colouring = "submap";
  private walls: boolean;
  private target: Side | null = null;
  private source: Side | null = null;
  private playing = 0; // counts what was played, or stopped
  private readonly ends: HTMLButtonElement[];
  readonly chooseColours: (value: Colouring) => void;

  constructor(private readonly state: State) {
    this.slider = element("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "0.01",
      value: "0",
      id: "slider",
      label: "from the map's pose to the registered one",
      on: {
        input: () => {
          this.playing++;
          this.moved();
        },
      },
    });
    const colours = choice<Colouring>(
      "colour points by",
      [
        ["submap", "submap"],
        ["distance", "distance", "how far each point is from the other submap's nearest surface"],
        ["conflict", "free space", "surfaces that stand where the other submap saw through"],
      ],
      "submap",
      (value) => {
        this.colouring = value;
        this.pane.root.dataset["colouring"] = value;
        this.recolour();
      },
    );
    this.chooseColours = colours.set;
    this.walls = wallsShow(state.archive);
    const slice = choice<"walls" | "all">(
      "which points",
      [
        ["walls", "walls", "only what is about as high as the sensor, or half a metre to two above a finished cloud's floor"],
        ["all", "everything"],
      ],
      this.walls ? "walls" : "all",
      (value) => {
        this.walls = value === "walls";
        this.recolour();
      },
    );
    const button = (text: string, title: string, press: () => void) =>
      element("button", { type: "button", class: "end", title, on: { click: press } }, text);
    this.ends = [
      button("as in the map", "key m", () => this.set(0)),
      button("after registration", "key r", () => this.set(1)),
      button("play", "key p", () => this.play()),
    ];
    byId("pair").replaceChildren(
      this.title,
      element("div", { class: "bar" }, colours.root, slice.root),
      this.pane.root,
      element(
        "div",
        { class: "bar slider" },
        this.ends[0]!,
        this.slider,
        this.ends[1]!,
        this.ends[2]!,
      ),
      element("div", { class: "bar" }, this.note),
      this.shown,
    );
    this.pane.paint = (context, width, height) => this.paint(context, width, height);
    state.on("selection", () => this.load());
    const themeChanged = () => {
      this.pane.background(themed("--canvas"));
      this.pane.render();
    };
    state.on("theme", themeChanged);
    themeChanged();
    this.load();
  }

  private get pair(): Pair | null {
    return this.state.pairs[this.state.selected] ?? null;
  }
  private get picture(): PairPicture | null {
    return this.state.archive.pairs[this.state.selected] ?? null;
  }

  /** 0 = as in the map, 1 = after registration. */
  get alpha(): number {
    return Number(this.slider.value);
  }

  private describe(): void {
    const shown = this.pair !== null && this.pane.drawsPoints;
    this.shown.textContent = shown ? drawnAs(this.alpha, this.colouring, this.walls) : "";
  }

  private get registered(): boolean {
    return (this.pair?.T_target_source_registered ?? null) !== null;
  }

  /** What the user asks for; ends what is played. */
  set(alpha: number): void {
    this.playing++;
    this.show(alpha);
  }

  private show(alpha: number): void {
    if (!this.registered) return;
    this.slider.value = String(alpha);
    this.moved();
  }

  play(): void {
    if (!this.registered) return;
    const run = ++this.playing;
    const start = performance.now();
    const step = () => {
      const t = (performance.now() - start) / 1200;
      if (run !== this.playing) return;
      this.show(t >= 4 ? 0 : (1 - Math.cos(Math.PI * Math.min(t, 4))) / 2);
      if (t < 4) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  /** Where a source point lies in the pane's world; tests read it while the slider moves. */
  sourcePoint(i: number): [number, number, number] {
    if (!this.source) return [0, 0, 0];
    const p = new Vector3().fromArray(this.source.cloud.positions, 3 * i).applyMatrix4(this.source.cloud.points.matrix);
    return [p.x, p.y, p.z];
  }

  private clear(): void {
    for (const side of [this.source, this.target]) {
      if (!side) continue;
      for (const points of [side.cloud, side.sampled]) {
        this.pane.scene.remove(points.points);
        points.dispose();
      }
    }
    this.source = this.target = null;
    this.pane.clouds = [];
  }

  private side(submap: number, stride: number, samples: Samples): Side {
    const archive = this.state.archive;
    const cloud = archive.clouds[submap]!;
    const start = translation(archive.result.submaps[submap]!.T_world_submap);
    const upright = worldFromCloud(archive, submap, start);
    const level = sensorHeight(archive, submap);
    const p = new Vector3();
    const points = (order: Uint32Array, every: number): CloudPoints => {
      const positions = new Float32Array(3 * order.length);
      const heights = new Float32Array(order.length);
      order.forEach((from, to) => {
        p.fromArray(cloud.points, 3 * from * every).toArray(positions, 3 * to);
        heights[to] = p.applyMatrix4(upright).z - level;
      });
      return new CloudPoints(positions, heights);
    };
    const order = evenOrder(samples.before.length);
    const ordered = (bytes: Uint8Array) => (bytes.length === 0 ? bytes : Uint8Array.from(order, (from) => bytes[from]!));
    const side = {
      cloud: points(evenOrder(cloud.points.length / 3), 1),
      sampled: points(order, stride),
      samples: { before: ordered(samples.before), after: ordered(samples.after) },
      place: new Vector3().applyMatrix4(worldFromCloud(archive, submap, placeOf(archive, submap)).invert()),
    };
    for (const shown of [side.cloud, side.sampled]) this.pane.scene.add(shown.points);
    return side;
  }

  private load(): void {
    this.clear();
    this.playing++;
    this.slider.value = "0";
    const { pair, picture } = this;
    for (const control of [this.slider, ...this.ends]) control.disabled = !this.registered;
    if (!pair || !picture) {
      this.title.replaceChildren(this.state.pairs.length === 0 ? "No pair to show" : "No pair selected");
      this.note.replaceChildren();
      this.describe();
      this.pane.render();
      return;
    }
    const swatch = (colour: string) => {
      const mark = element("i", { class: "swatch" });
      mark.style.background = colour;
      return mark;
    };
    this.title.replaceChildren(
      element("span", { class: "names" }, "Pair ", swatch(css(targetColour)), pair.target, " and ", swatch(css(sourceColour)), pair.source),
      " ",
      element("span", { class: `verdict ${pair.verdict}` }, pair.verdict),
    );
    this.target = this.side(picture.target, picture.stride, picture.targetSamples);
    this.source = this.side(picture.source, picture.stride, picture.sourceSamples);
    this.place();
    this.recolour();
    this.frame();
  }

  private place(): void {
    const { pair, picture, source, target } = this;
    if (!pair || !picture || !source || !target) return;
    const archive = this.state.archive;
    const centre = new Vector3(...picture.centre);
    const pose = archive.result.submaps[picture.target]!.T_world_submap;
    const world = new Matrix4().compose(translation(pose).sub(centre), rotation(pose), kUnit);
    const from = pair.T_target_source;
    const to = pair.T_target_source_registered ?? from;
    // What both saw slides straight, wherever the source's start is: far from it a turn would swing it out and back.
    const middle = centre.sub(translation(pose)).applyQuaternion(rotation(pose).invert());
    const own = middle.clone().sub(translation(from)).applyQuaternion(rotation(from).invert());
    const end = own.clone().applyQuaternion(rotation(to)).add(translation(to));
    const turn = rotation(from).slerp(rotation(to), this.alpha);
    const at = middle.lerp(end, this.alpha).sub(own.applyQuaternion(turn));
    const moved = world.clone().multiply(new Matrix4().compose(at, turn, kUnit));
    const fromCloud = (submap: number) => new Matrix4().makeTranslation(...archive.clouds[submap]!.origin);
    world.multiply(fromCloud(picture.target));
    moved.multiply(fromCloud(picture.source));
    for (const points of [target.cloud, target.sampled]) points.move(world);
    for (const points of [source.cloud, source.sampled]) points.move(moved);
  }

  private moved(): void {
    this.place();
    this.describe();
    if (this.colouring !== "submap") this.recolour();
    this.pane.render();
  }

  private recolour(): void {
    const { source, target } = this;
    this.describe();
    if (!source || !target) return;
    const after = this.alpha > 0.5 && source.samples.after.length > 0;
    const plain = this.colouring === "submap";
    const sides: [Side, readonly [number, number, number]][] = [
      [target, targetColour],
      [source, sourceColour],
    ];
    let through = 0;
    for (const [side, own] of sides) {
      const bytes = after ? side.samples.after : side.samples.before;
      side.cloud.points.visible = plain;
      side.sampled.points.visible = !plain;
      const [low, high] = this.walls ? kWalls : kEverything;
      side.cloud.slice(low, high);
      side.sampled.slice(low, high);
      side.cloud.size(2);
      side.sampled.size(3);
      const paint = (out: Uint8Array, at: number, colour: readonly [number, number, number]) => {
        out[at] = colour[0];
        out[at + 1] = colour[1];
        out[at + 2] = colour[2];
      };
      if (plain) side.cloud.colour((_, out, at) => paint(out, at, own));
      else {
        const bad = verdictColour("inconsistent");
        side.sampled.colour((k, out, at) => {
          const byte = bytes[k]!;
          const steps = byte & kNothing;
          if (byte & kThrough) through++;
          if (this.colouring === "conflict") paint(out, at, byte & kThrough ? bad : belowColour());
          else paint(out, at, steps === kNothing ? belowColour() : scaleColour(steps / kSteps));
        });
      }
    }
    this.note.classList.toggle("hint", plain);
    this.note.textContent = legendOf(this.colouring, {
      drawn: this.pane.drawsPoints,
      registered: this.registered,
      after,
      d: this.pair?.d ?? 1,
      measured: source.samples.before.length > 0,
      free: (this.pair?.evidence[after ? "conflict_registered" : "conflict"]?.value ?? null) !== null,
      through: `${through} of ${bytesOf(source) + bytesOf(target)}`,
    });
    this.pane.clouds = sides.map(([side]) => (plain ? side.cloud : side.sampled));
    this.pane.render();
  }

  /** From above, or from the side if what is wrong is mostly a matter of height. */
  private frame(): void {
    const { pair, picture } = this;
    if (!pair || !picture || !this.target) return;
    const shift = new Vector3(...(pair.offset_vector ?? [0, 0, 0])).applyQuaternion(
      rotation(this.state.archive.result.submaps[picture.target]!.T_world_submap),
    );
    const flat = Math.abs(shift.z) <= Math.hypot(shift.x, shift.y);
    const direction = flat ? new Vector3(0, -1e-4, 1) : new Vector3(-shift.y || 0.3, shift.x || -1, 0.05);
    this.pane.look(new Vector3(), this.reach(), direction);
  }

  /** Half the width of what both saw. */
  private reach(): number {
    const { target, picture } = this;
    if (!target || !picture) return 10;
    const bytes = target.samples.after.length > 0 ? target.samples.after : target.samples.before;
    const world = target.cloud.points.matrix;
    const p = new Vector3();
    const reach: number[] = [];
    const every = bytes.length > 0 ? 1 : 7;
    const count = bytes.length > 0 ? bytes.length : target.cloud.count;
    const positions = bytes.length > 0 ? target.sampled.positions : target.cloud.positions;
    for (let k = 0; k < count; k += every) {
      if (bytes.length > 0 && (bytes[k]! & kNothing) === kNothing) continue;
      p.fromArray(positions, 3 * k).applyMatrix4(world);
      reach.push(Math.hypot(p.x, p.y));
    }
    reach.sort((a, b) => a - b);
    // The source has to be seen before it is moved, too.
    const offset = this.pair?.offset_m ?? 0;
    return Math.min(60, Math.max(3, (reach[Math.floor(0.85 * reach.length)] ?? 10) * 1.05 + offset));
  }

  private paint(context: CanvasRenderingContext2D, width: number, height: number): void {
    const ink = themed("--ink");
    const paper = themed("--canvas");
    const { pair, picture } = this;
    if (!pair || !picture) return;
    paintOpenDirections(this.pane, pair, rotation(this.state.archive.result.submaps[picture.target]!.T_world_submap), context);
    const archive = this.state.archive;
    context.font = "bold 12px system-ui, sans-serif";
    context.textAlign = "center";
    const nodes: [number, Side | null, string][] = [
      [picture.target, this.target, css(targetColour)],
      [picture.source, this.source, css(sourceColour)],
    ];
    for (const [submap, side, colour] of nodes) {
      if (!side) continue;
      const where = this.pane.project(side.place.clone().applyMatrix4(side.cloud.points.matrix), width, height);
      context.fillStyle = colour;
      context.strokeStyle = paper;
      context.lineWidth = 2;
      context.beginPath();
      context.arc(where.x, where.y, 6, 0, 7);
      context.fill();
      context.stroke();
      const above = submap === picture.target; // two names at one place must not cover each other
      context.textBaseline = above ? "bottom" : "top";
      const what = isFinished(archive, submap) ? "" : "start of ";
      halo(context, `${what}${shortened(archive.result.submaps[submap]!.id, this.state.common)}`, where.x, where.y + (above ? -8 : 8), ink, paper);
    }
    this.pane.scaleBar(context, width, height, ink);
  }
}

const bytesOf = (side: Side): number => side.samples.before.length;
