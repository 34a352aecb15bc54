// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// All submaps where the map puts them, the robots' ways, and a line for each pair.
import { Vector3 } from "three";
import type { Verdict } from "./archive.js";
import { css, misalignmentColour, robotColour, scaleColour, verdictColour } from "./colours.js";
import { byId, choice, element, hideTip, showTip } from "./dom.js";
import { extentOf, isFinished, kEverything, kWalls, meanOf, placeOf, sensorHeight, wallsShow, worldFromCloud } from "./framing.js";
import { paintPin, ramp } from "./marks.js";
import { shortened } from "./names.js";
import type { Place } from "./places.js";
import { CloudPoints, halo, Pane, themed, ThinLines } from "./scene.js";
import type { State } from "./state.js";
import { pairTip } from "./tips.js";
import { centimetres } from "./words.js";

type Colouring = "robot" | "height" | "misalignment";

interface Edge {
  pair: number;
  from: Vector3;
  to: Vector3;
}

const kNearPixels = 9;
const kMostMisaligned = 2.54; // that a byte tells. [m]

export class MapView {
  readonly pane = new Pane("map seen from above", true);
  private readonly origin: Vector3;
  private readonly cloud: CloudPoints;
  private readonly owner: Uint16Array; // submap of each point
  private readonly bytes: Uint8Array; // misalignment of each point
  private readonly nodes: Vector3[]; // where each submap lies
  private readonly edges: Edge[];
  private readonly paths: Vector3[][];
  private readonly thin: ThinLines;
  private readonly shown: Record<Verdict, boolean> = { inconsistent: true, unverified: true, consistent: true };
  private readonly legend = element("span", { class: "legend" });
  readonly chooseColours: (value: Colouring) => void;

  constructor(
    private readonly state: State,
    private readonly places: Place[],
  ) {
    const archive = state.archive;
    this.nodes = archive.result.submaps.map((_, submap) => placeOf(archive, submap));
    this.origin = meanOf(this.nodes);
    for (const node of this.nodes) node.sub(this.origin);
    const total = archive.clouds.reduce((sum, cloud) => sum + cloud.points.length / 3, 0);
    const positions = new Float32Array(3 * total);
    const heights = new Float32Array(total);
    this.owner = new Uint16Array(total);
    this.bytes = new Uint8Array(total);
    this.fill(positions, heights);
    this.cloud = new CloudPoints(positions, heights);
    this.pane.scene.add(this.cloud.points);
    this.pane.clouds = [this.cloud];
    this.edges = archive.pairs.map((pair, n) => ({ pair: n, from: this.nodes[pair.target]!, to: this.nodes[pair.source]! }));
    this.paths = archive.paths.map((path) => {
      const points: Vector3[] = [];
      for (let i = 0; i < path.length; i += 3) {
        points.push(new Vector3(path[i], path[i + 1], path[i + 2]).sub(this.origin));
      }
      return points;
    });
    this.pane.paint = (context, width, height) => this.paint(context, width, height);
    this.thin = this.thinLines();
    this.pane.scene.add(this.thin.lines);
    this.pane.prepare = (settled) => (this.thin.lines.visible = !settled);
    const colours = choice<Colouring>(
      "colour points by",
      [
        ["robot", "robot", "key 1"],
        ["height", "height", "key 2"],
        ["misalignment", "misalignment", "key 3: how far registration would move each point"],
      ],
      "robot",
      (value) => this.colour(value),
    );
    this.chooseColours = colours.set;
    const walls = wallsShow(archive);
    const finished = archive.clouds.some((_, submap) => isFinished(archive, submap));
    const slice = choice<"walls" | "all">(
      "which points",
      [
        ["walls", "walls", finished ? "only what is half a metre to two metres above the floor" : "only what is about as high as the sensor: no floor, no ceiling"],
        ["all", "everything"],
      ],
      walls ? "walls" : "all",
      (value) => this.slice(value === "walls"),
    );
    const edges = (["inconsistent", "unverified", "consistent"] as const).map((verdict) =>
      element(
        "label",
        { class: `edge ${verdict}`, title: `lines of ${verdict} pairs` },
        element("input", {
          type: "checkbox",
          checked: true,
          on: {
            change: (event) => {
              this.shown[verdict] = (event.target as HTMLInputElement).checked;
              this.thin.show((line) => line >= this.edges.length || this.visible(this.edges[line]!));
              this.pane.render();
            },
          },
        }),
        verdict,
      ),
    );
    const views = element(
      "span",
      { class: "choice", role: "group", label: "look from" },
      element("button", { type: "button", title: "key t", on: { click: () => this.top() } }, "top"),
      element("button", { type: "button", title: "from the side", on: { click: () => this.side() } }, "side"),
    );
    byId("map").replaceChildren(
      element("h2", {}, "Map"),
      element("div", { class: "bar" }, colours.root, slice.root, views),
      this.pane.root,
      element("div", { class: "bar" }, ...edges, this.legend),
    );
    this.listen();
    this.slice(walls);
    this.colour("robot");
    this.top();
    const themeChanged = () => {
      this.pane.background(themed("--canvas"));
      this.pane.render();
    };
    state.on("theme", themeChanged);
    for (const event of ["selection", "hover"] as const) state.on(event, () => this.pane.repaint());
    themeChanged();
  }

  /** Every 16th point of all first, then the next sixteenth, ...: whatever is drawn of them is an even thinning. */
  private fill(positions: Float32Array, heights: Float32Array): void {
    const archive = this.state.archive;
    const matrices = archive.clouds.map((_, submap) => worldFromCloud(archive, submap, this.origin).elements);
    const levels = archive.result.submaps.map(({ T_world_submap }, submap) => {
      return T_world_submap[2] - this.origin.z + sensorHeight(archive, submap);
    });
    let to = 0;
    for (let phase = 0; phase < 16; phase++) {
      archive.clouds.forEach((cloud, submap) => {
        const m = matrices[submap]!;
        for (let i = phase; i < cloud.misalignment.length; i += 16) {
          const x = cloud.points[3 * i]!;
          const y = cloud.points[3 * i + 1]!;
          const z = cloud.points[3 * i + 2]!;
          for (let axis = 0; axis < 3; axis++) {
            positions[3 * to + axis] = m[axis]! * x + m[4 + axis]! * y + m[8 + axis]! * z + m[12 + axis]!;
          }
          heights[to] = positions[3 * to + 2]! - levels[submap]!;
          this.owner[to] = submap;
          this.bytes[to] = cloud.misalignment[i]!;
          to++;
        }
      });
    }
  }

  /** The pairs' lines, then the robots' ways. */
  private thinLines(): ThinLines {
    const ends: number[] = [];
    const colours: (readonly [number, number, number])[] = [];
    for (const edge of this.edges) {
      ends.push(...edge.from.toArray(), ...edge.to.toArray());
      colours.push(verdictColour(this.state.pairs[edge.pair]!.verdict));
    }
    this.paths.forEach((path, robot) => {
      for (let i = 1; i < path.length; i++) {
        ends.push(...path[i - 1]!.toArray(), ...path[i]!.toArray());
        colours.push(robotColour(robot));
      }
    });
    return new ThinLines(Float32Array.from(ends), (line) => colours[line]!);
  }

  private colour(by: Colouring): void {
    const result = this.state.archive.result;
    const tolerance = Number(result.config["tolerance"]);
    const put = (out: Uint8Array, at: number, colour: readonly [number, number, number]) => {
      out[at] = colour[0];
      out[at + 1] = colour[1];
      out[at + 2] = colour[2];
    };
    if (by === "robot") {
      const robots = result.robots.map((robot) => robot.name);
      const colours = result.submaps.map((submap) => robotColour(robots.indexOf(submap.robot)));
      this.cloud.colour((i, out, at) => put(out, at, colours[this.owner[i]!]!));
      this.legend.replaceChildren(
        ...robots.map((name, i) => {
          const swatch = element("i", { class: "swatch" });
          swatch.style.background = css(robotColour(i));
          return element("span", {}, swatch, name);
        }),
      );
    } else if (by === "height") {
      const z = this.cloud.positions;
      const sorted = Array.from({ length: Math.min(4000, this.cloud.count) }, (_, k) => {
        return z[3 * Math.floor((k * this.cloud.count) / Math.min(4000, this.cloud.count)) + 2]!;
      }).sort((a, b) => a - b);
      const low = sorted[Math.floor(0.02 * sorted.length)] ?? 0;
      const high = sorted[Math.floor(0.98 * sorted.length)] ?? 1;
      const table = Array.from({ length: 256 }, (_, k) => scaleColour(k / 255));
      this.cloud.colour((i, out, at) => {
        const share = (z[3 * i + 2]! - low) / Math.max(high - low, 1e-6);
        put(out, at, table[Math.round(255 * Math.min(1, Math.max(0, share)))]!);
      });
      const metres = (value: number) => `${(value + this.origin.z).toFixed(1)} m`;
      this.legend.replaceChildren(metres(low), ramp((share) => css(scaleColour(share))), metres(high));
    } else {
      const table = Array.from({ length: 256 }, (_, byte) => misalignmentColour(byte, tolerance));
      this.cloud.colour((i, out, at) => put(out, at, table[this.bytes[i]!]!));
      const swatch = element("i", { class: "swatch" });
      swatch.style.background = css(table[0]!);
      const stop = (share: number) => Math.min(255, Math.round(1 + 10 * tolerance * 10 ** (2 * share)));
      this.legend.replaceChildren(
        swatch,
        "seen once or undecided; off by ",
        centimetres(tolerance / 10),
        ramp((share) => css(misalignmentColour(stop(share), tolerance))),
        `${centimetres(Math.min(kMostMisaligned, 10 * tolerance))} or more`,
      );
    }
    this.pane.root.dataset["colouring"] = by;
    this.pane.render();
  }

  private slice(walls: boolean): void {
    const [low, high] = walls ? kWalls : kEverything;
    this.cloud.slice(low, high);
    this.pane.render();
  }

  top(): void {
    const { centre, radius } = extentOf(this.state.archive, this.origin);
    this.pane.look(centre, radius * 1.04, new Vector3(0, -1e-4, 1));
  }

  side(): void {
    const { centre, radius } = extentOf(this.state.archive, this.origin);
    this.pane.look(centre, radius, new Vector3(-0.5, -1, 0.7));
  }

  private readonly visible = (edge: Edge): boolean => {
    return edge.pair === this.state.selected || this.shown[this.state.pairs[edge.pair]!.verdict];
  };

  /** The pair whose line or pin lies at a place of the pane, or -1. */
  pick(x: number, y: number): number {
    const { clientWidth: width, clientHeight: height } = this.pane.overlay;
    for (const [rank, place] of this.places.entries()) {
      if (rank >= 12) break;
      const pin = this.pinOf(place.pair, width, height);
      if (Math.hypot(pin.x - x, pin.y - 16 - y) < 12) return place.pair;
    }
    let best = -1;
    let least = kNearPixels;
    for (const edge of this.edges) {
      if (!this.visible(edge)) continue;
      const a = this.pane.project(edge.from, width, height);
      const b = this.pane.project(edge.to, width, height);
      const length2 = (b.x - a.x) ** 2 + (b.y - a.y) ** 2;
      const t = length2 === 0 ? 0 : Math.min(1, Math.max(0, ((x - a.x) * (b.x - a.x) + (y - a.y) * (b.y - a.y)) / length2));
      const distance = Math.hypot(a.x + t * (b.x - a.x) - x, a.y + t * (b.y - a.y) - y);
      if (distance < least) {
        least = distance;
        best = edge.pair;
      }
    }
    return best;
  }

  /** Where the middle of a pair's line lies in the pane; what tests click at. */
  middleOf(pair: number): { x: number; y: number } {
    const { clientWidth: width, clientHeight: height } = this.pane.overlay;
    const edge = this.edges[pair]!;
    return this.pane.project(edge.from.clone().add(edge.to).multiplyScalar(0.5), width, height);
  }

  private pinOf(pair: number, width: number, height: number): { x: number; y: number } {
    return this.pane.project(new Vector3(...this.state.archive.pairs[pair]!.centre).sub(this.origin), width, height);
  }

  private listen(): void {
    const overlay = this.pane.overlay;
    let down = { x: 0, y: 0 };
    overlay.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    overlay.addEventListener("click", (event) => {
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) > 4) return;
      const pair = this.pick(event.offsetX, event.offsetY);
      if (pair >= 0) this.state.select(pair);
    });
    overlay.addEventListener("pointermove", (event) => {
      if (event.buttons !== 0) return;
      const pair = this.pick(event.offsetX, event.offsetY);
      this.state.hover(pair);
      overlay.style.cursor = pair >= 0 ? "pointer" : "grab";
      if (pair >= 0) showTip(pairTip(this.state.pairs[pair]!), event.clientX, event.clientY);
      else hideTip();
    });
    overlay.addEventListener("pointerleave", () => {
      this.state.hover(-1);
      hideTip();
    });
  }

  private paint(context: CanvasRenderingContext2D, width: number, height: number): void {
    const ink = themed("--ink");
    const paper = themed("--canvas");
    if (this.pane.settled) this.paintLines(context, width, height, paper);
    for (const [pair, wide] of [[this.state.hovered, 4], [this.state.selected, 5]] as const) {
      if (pair < 0) continue;
      context.strokeStyle = paper;
      context.lineWidth = wide + 4;
      this.line(context, this.edges[pair]!, width, height);
      context.strokeStyle = css(verdictColour(this.state.pairs[pair]!.verdict));
      context.lineWidth = wide;
      this.line(context, this.edges[pair]!, width, height);
    }
    if (this.pane.settled) this.paintNames(context, width, height, ink, paper);
    this.paintPins(context, width, height, paper);
    this.pane.scaleBar(context, width, height, ink);
  }

  private paintLines(context: CanvasRenderingContext2D, width: number, height: number, paper: string): void {
    const project = (point: Vector3) => this.pane.project(point, width, height);
    this.paths.forEach((path, robot) => {
      context.beginPath();
      path.forEach((point, i) => {
        const at = project(point);
        if (i === 0) context.moveTo(at.x, at.y);
        else context.lineTo(at.x, at.y);
      });
      context.lineJoin = "round";
      context.strokeStyle = paper;
      context.lineWidth = 4.5;
      context.stroke();
      context.strokeStyle = css(robotColour(robot));
      context.lineWidth = 2.5;
      context.stroke();
    });
    const order: Verdict[] = ["consistent", "unverified", "inconsistent"];
    const many = this.edges.length > 400 ? 0.5 : 1;
    for (const verdict of order) {
      context.strokeStyle = css(verdictColour(verdict));
      context.globalAlpha = verdict === "inconsistent" ? 0.55 * many : 0.7 * many;
      context.lineWidth = verdict === "inconsistent" ? 1.8 : 1.1;
      context.setLineDash(verdict === "unverified" ? [3, 4] : []);
      for (const edge of this.edges) {
        if (this.state.pairs[edge.pair]!.verdict === verdict && this.shown[verdict]) this.line(context, edge, width, height);
      }
    }
    context.globalAlpha = 1;
    context.setLineDash([]);
  }

  private line(context: CanvasRenderingContext2D, edge: Edge, width: number, height: number): void {
    const a = this.pane.project(edge.from, width, height);
    const b = this.pane.project(edge.to, width, height);
    context.beginPath();
    context.moveTo(a.x, a.y);
    context.lineTo(b.x, b.y);
    context.stroke();
  }

  /** Names of the selected pair's submaps, and of others where there is room. */
  private paintNames(context: CanvasRenderingContext2D, width: number, height: number, ink: string, paper: string): void {
    const archive = this.state.archive;
    const pair = archive.pairs[this.state.selected];
    const submaps = archive.result.submaps.map((_, i) => i);
    const first = pair ? [pair.target, pair.source] : [];
    const taken: { x: number; y: number }[] = [];
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const submap of [...first, ...submaps]) {
      const chosen = first.includes(submap);
      const at = this.pane.project(this.nodes[submap]!, width, height);
      if (taken.some((other) => Math.abs(other.x - at.x) < 44 && Math.abs(other.y - at.y) < 16)) continue;
      taken.push(at);
      context.font = chosen ? "bold 13px system-ui, sans-serif" : "11px system-ui, sans-serif";
      halo(context, shortened(archive.result.submaps[submap]!.id, this.state.common), at.x, at.y - 11, ink, paper);
      context.fillStyle = ink;
      context.beginPath();
      context.arc(at.x, at.y, chosen ? 4 : 2.5, 0, 7);
      context.fill();
    }
  }

  private paintPins(context: CanvasRenderingContext2D, width: number, height: number, paper: string): void {
    for (let rank = Math.min(this.places.length, 12) - 1; rank >= 0; rank--) {
      const place = this.places[rank]!;
      const at = this.pinOf(place.pair, width, height);
      const chosen = place.pairs.includes(this.state.selected);
      paintPin(context, at, String(rank + 1), chosen, paper);
    }
  }
}
