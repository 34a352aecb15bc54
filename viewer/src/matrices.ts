// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Gamma, Theta and their difference: a row for each source, a column for each target.
import type { Kind, Pair } from "./archive.js";
import { belowColour, css, robotColour, scaleColour } from "./colours.js";
import { byId, element, fitted, hideTip, showTip } from "./dom.js";
import { shortened } from "./names.js";
import { themed } from "./scene.js";
import type { State } from "./state.js";
import { pairTip } from "./tips.js";

interface Kept {
  title: string;
  about: string;
  value: (pair: Pair) => number | null;
  ends: [string, string];
}

const kMatrices: Kept[] = [
  { title: "Γ as in the map", about: "how sharply the two submaps agree where the map puts them", value: (pair) => pair.gamma, ends: ["suspicious", "agree"] },
  { title: "Θ once registered", about: "the same after registration: what would be possible", value: (pair) => pair.theta, ends: ["cannot agree", "agree"] },
  { title: "Γᵛ = Θ − Γ", about: "what registration gains: large means verified inconsistent", value: (pair) => pair.verified, ends: ["little", "verified wrong"] },
];

interface Layout {
  cell: number;
  left: number;
  top: number;
  size: number;
}

class Matrix {
  readonly canvas = element("canvas", { class: "matrix" });
  private layout: Layout = { cell: 1, left: 0, top: 0, size: 1 };

  constructor(
    private readonly state: State,
    private readonly kept: Kept,
    private readonly range: [number, number] | null, // of the logarithms, where anything has one
    private readonly at: ReadonlyMap<number, number>, // row * N + column -> pair
  ) {
    this.canvas.setAttribute("aria-label", kept.title);
    this.canvas.addEventListener("pointermove", (event) => {
      const pair = this.pairAt(event.offsetX, event.offsetY);
      state.hover(pair);
      this.canvas.style.cursor = pair >= 0 ? "pointer" : "default";
      if (pair >= 0) showTip(pairTip(state.pairs[pair]!), event.clientX, event.clientY);
      else hideTip();
    });
    this.canvas.addEventListener("pointerleave", () => {
      state.hover(-1);
      hideTip();
    });
    this.canvas.addEventListener("click", (event) => {
      const pair = this.pairAt(event.offsetX, event.offsetY);
      if (pair >= 0) state.select(pair);
    });
  }

  private get n(): number {
    return this.state.archive.result.submaps.length;
  }

  /** The middle of a pair's cell in the canvas; what tests click at. */
  cellOf(pair: number): { x: number; y: number } {
    const { source, target } = this.state.archive.pairs[pair]!;
    const { cell, left, top } = this.layout;
    return { x: left + (target + 0.5) * cell, y: top + (source + 0.5) * cell };
  }

  private pairAt(x: number, y: number): number {
    const { cell, left, top } = this.layout;
    const column = Math.floor((x - left) / cell);
    const row = Math.floor((y - top) / cell);
    const exact = this.at.get(row * this.n + column);
    if (exact !== undefined && column >= 0 && column < this.n) return exact;
    if (cell >= 4) return -1;
    // Cells smaller than a finger: the nearest one around.
    const reach = Math.ceil(3 / cell);
    let best = -1;
    let least = Infinity;
    for (let r = row - reach; r <= row + reach; r++) {
      for (let c = Math.max(0, column - reach); c <= Math.min(this.n - 1, column + reach); c++) {
        const found = this.at.get(r * this.n + c);
        const distance = Math.hypot(r - row, c - column);
        if (found !== undefined && distance < least) {
          least = distance;
          best = found;
        }
      }
    }
    return best;
  }

  private colour(value: number): string {
    if (value <= 0 || !this.range) return css(belowColour());
    const [low, high] = this.range;
    return css(scaleColour(high > low ? (Math.log10(value) - low) / (high - low) : 0.5));
  }

  draw(): void {
    if (this.canvas.clientWidth === 0) return; // hidden
    const { context, width, height } = fitted(this.canvas);
    const n = this.n;
    const margin = 30;
    const size = Math.min(width, height) - margin - 2;
    const cell = size / n;
    this.layout = { cell, left: margin, top: 2, size };
    const { left, top } = this.layout;
    context.fillStyle = themed("--hollow");
    context.beginPath();
    context.moveTo(left, top);
    context.lineTo(left + size, top + size);
    context.lineTo(left, top + size);
    context.fill();
    const drawn = Math.max(cell, 2);
    this.state.archive.pairs.forEach((picture, number) => {
      const pair = this.state.pairs[number]!;
      const value = this.kept.value(pair);
      const x = left + picture.target * cell;
      const y = top + picture.source * cell;
      if (value === null) {
        context.strokeStyle = themed("--quiet");
        context.lineWidth = 1;
        if (cell >= 5) this.cross(context, x, y, cell);
        return;
      }
      context.fillStyle = this.colour(value);
      context.fillRect(x, y, drawn + 0.3, drawn + 0.3);
      if (cell >= 9) this.outline(context, pair.kind, x, y, cell);
    });
    this.blocks(context);
    this.legend(context, width);
    this.mark(context, this.state.hovered, 2);
    this.mark(context, this.state.selected, 3);
  }

  private cross(context: CanvasRenderingContext2D, x: number, y: number, cell: number): void {
    context.beginPath();
    context.moveTo(x + 0.3 * cell, y + 0.3 * cell);
    context.lineTo(x + 0.7 * cell, y + 0.7 * cell);
    context.moveTo(x + 0.7 * cell, y + 0.3 * cell);
    context.lineTo(x + 0.3 * cell, y + 0.7 * cell);
    context.stroke();
  }

  private outline(context: CanvasRenderingContext2D, kind: Kind, x: number, y: number, cell: number): void {
    if (kind === "global") return;
    context.strokeStyle = themed("--ink");
    context.lineWidth = 1;
    context.setLineDash(kind === "local" ? [2, 2] : []);
    context.strokeRect(x + 1, y + 1, cell - 2, cell - 2);
    context.setLineDash([]);
  }

  /** Where one robot's submaps end and the next one's begin. */
  private blocks(context: CanvasRenderingContext2D): void {
    const { cell, left, top, size } = this.layout;
    const result = this.state.archive.result;
    let first = 0;
    context.font = "bold 12px system-ui, sans-serif";
    result.robots.forEach((robot, i) => {
      const from = first * cell;
      const to = (first + robot.submaps) * cell;
      context.strokeStyle = themed("--ink");
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(left + from, top + from);
      context.lineTo(left + from, top + size);
      context.moveTo(left, top + to);
      context.lineTo(left + to, top + to);
      context.stroke();
      context.fillStyle = css(robotColour(i));
      context.fillRect(left - 6, top + from + 1, 4, Math.max(1, to - from - 2));
      context.fillRect(left + from + 1, top + size + 2, Math.max(1, to - from - 2), 4);
      context.fillStyle = themed("--ink");
      if (to - from >= 14) {
        const name = shortened(robot.name, this.state.common, 8);
        context.save();
        context.translate(left - 10, top + (from + to) / 2);
        context.rotate(-Math.PI / 2);
        context.textAlign = "center";
        context.textBaseline = "bottom";
        if (context.measureText(name).width <= to - from) context.fillText(name, 0, 0);
        context.restore();
        context.textAlign = "center";
        context.textBaseline = "top";
        if (context.measureText(name).width <= to - from) context.fillText(name, left + (from + to) / 2, top + size + 9);
      }
      first += robot.submaps;
    });
  }

  /** The colour bar, in the empty triangle. */
  private legend(context: CanvasRenderingContext2D, width: number): void {
    if (!this.range) return;
    const { left, size, top } = this.layout;
    const long = Math.min(150, 0.42 * size);
    const x = Math.min(width, left + size) - long - 4;
    const y = top + 18;
    for (let i = 0; i < long; i++) {
      context.fillStyle = css(scaleColour(i / long));
      context.fillRect(x + i, y, 1.5, 9);
    }
    context.fillStyle = themed("--ink");
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "bottom";
    context.textAlign = "left";
    const power = (value: number) => String(Number((10 ** value).toPrecision(2)));
    context.fillText(power(this.range[0]), x, y - 1);
    context.textAlign = "right";
    context.fillText(power(this.range[1]), x + long, y - 1);
    context.textBaseline = "top";
    context.textAlign = "left";
    if (long < 130) return; // no room for words
    context.fillText(this.kept.ends[0], x, y + 11);
    context.textAlign = "right";
    context.fillText(this.kept.ends[1], x + long, y + 11);
  }

  private mark(context: CanvasRenderingContext2D, pair: number, wide: number): void {
    const picture = this.state.archive.pairs[pair];
    if (!picture) return;
    const { cell, left, top } = this.layout;
    const size = Math.max(cell, 8);
    const { x, y } = this.cellOf(pair);
    context.lineWidth = wide + 2;
    context.strokeStyle = themed("--paper");
    context.strokeRect(x - size / 2, y - size / 2, size, size);
    context.lineWidth = wide;
    context.strokeStyle = themed("--mark");
    context.strokeRect(x - size / 2, y - size / 2, size, size);
    context.globalAlpha = 0.5;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(left, y);
    context.lineTo(x - size / 2, y);
    context.moveTo(x, y + size / 2);
    context.lineTo(x, top + this.layout.size);
    context.stroke();
    context.globalAlpha = 1;
  }
}

function rangeOf(pairs: Pair[], values: ((pair: Pair) => number | null)[]): [number, number] | null {
  let low = Infinity;
  let high = -Infinity;
  for (const pair of pairs) {
    for (const value of values) {
      const number = value(pair);
      if (number === null || number <= 0) continue;
      low = Math.min(low, Math.log10(number));
      high = Math.max(high, Math.log10(number));
    }
  }
  return Number.isFinite(low) ? [low, high] : null;
}

export class Matrices {
  readonly all: Matrix[];

  constructor(state: State) {
    const archive = state.archive;
    const n = archive.result.submaps.length;
    const at = new Map(archive.pairs.map((pair, number) => [pair.source * n + pair.target, number]));
    const [gamma, theta, verified] = kMatrices as [Kept, Kept, Kept];
    const both = rangeOf(state.pairs, [gamma.value, theta.value]);
    const ranges = [both, both, rangeOf(state.pairs, [verified.value])];
    this.all = kMatrices.map((kept, i) => new Matrix(state, kept, ranges[i] ?? null, at));
    const figures = this.all.map((matrix, i) =>
      element("figure", {}, element("figcaption", {}, element("b", {}, kMatrices[i]!.title), element("small", {}, kMatrices[i]!.about)), matrix.canvas),
    );
    byId("matrices").hidden = state.pairs.length === 0;
    byId("matrices").replaceChildren(
      element("h2", {}, "Matrices"),
      element("div", { class: "figures" }, ...figures),
      element(
        "p",
        { class: "quiet" },
        "A cell is a pair: its row is the later submap (source), its column the earlier one (target); lines part the robots. " +
          "Log scale. Solid frame: one after the other; dashed: same robot again; none: two robots. " +
          "Grey cell: not above zero; cross: could not be computed; empty: not tested.",
      ),
    );
    const draw = () => this.all.forEach((matrix) => matrix.draw());
    let asked = false;
    const later = () => {
      if (asked) return;
      asked = true;
      requestAnimationFrame(() => {
        asked = false;
        draw();
      });
    };
    state.on("selection", later);
    state.on("hover", later);
    state.on("theme", later);
    new ResizeObserver(later).observe(byId("matrices"));
    draw();
  }
}
