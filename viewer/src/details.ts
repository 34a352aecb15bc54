// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// What was measured on the selected pair, in words, as a histogram and as evidence.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { action, correctionOpen, cure, isUsualAlone, notBelieved, toMend } from "./advice.js";
import type { Evidence, Histogram, Pair } from "./archive.js";
import { css, sourceColour, targetColour } from "./colours.js";
import { byId, element } from "./dom.js";
import { themed } from "./scene.js";
import type { State } from "./state.js";
import { centimetres, degrees, interval, kindInWords, large, partsInWorld, probability, sentence, shift } from "./words.js";

/** Expected counts of a normal truncated to [0, d], at the middle of each bin. */
export function fitted(histogram: Histogram, mu: number | null, sigma: number | null): (number | null)[] {
  const total = histogram.counts.reduce((sum, count) => sum + count, 0);
  if (mu === null || sigma === null || sigma <= 0) return histogram.counts.map(() => null);
  const logs = histogram.counts.map((_, i) => -0.5 * (((i + 0.5) * histogram.width - mu) / sigma) ** 2);
  const top = Math.max(...logs);
  const weights = logs.map((value) => Math.exp(value - top));
  const sum = weights.reduce((a, b) => a + b, 0);
  return weights.map((weight) => (total * weight) / sum);
}

const kEvidence: Record<string, { name: string; value: (x: number) => string; against: string }> = {
  displacement: {
    name: "How far registration moves it",
    value: (x) => centimetres(x),
    against: "what you can live with",
  },
  support: {
    name: "Points that agree: as mapped, and once registered",
    value: (x) => String(Math.round(x)),
    against: "once registered",
  },
  conflict: {
    name: "Surfaces where the other saw through",
    value: (x) => `${(100 * x).toFixed(2)} %`,
    against: "usual in this map",
  },
  conflict_registered: {
    name: "The same once registered",
    value: (x) => `${(100 * x).toFixed(2)} %`,
    against: "usual in this map",
  },
  same_side: { name: "Seen by both from the same side", value: (x) => `${(100 * x).toFixed(1)} %`, against: "" },
  mean_distance_m: {
    name: "Mean distance of matched voxels",
    value: (x) => centimetres(x),
    against: "once registered",
  },
  gap_m: { name: "Gap between double walls", value: (x) => centimetres(x), against: "one wall alone shows less than" },
  disagreement: { name: "All of it, with the bend", value: (x) => centimetres(x), against: "tolerance" },
  bend_m: { name: "Bend left that no rigid motion mends", value: (x) => centimetres(x), against: "" },
  agreeing: { name: "Other pairs around that say the same", value: (x) => String(Math.round(x)), against: "contradict it" },
  ambiguity: { name: "Second-best registration, against the best", value: (x) => `${(100 * x).toFixed(0)} %`, against: "" },
  log10_gamma: { name: "Γ, as a power of ten", value: (x) => x.toFixed(2), against: "usual in this map" },
};

/** What a log likelihood ratio says. */
function speaks(ratio: number): string {
  const size = Math.abs(ratio);
  if (size < 1) return "says little";
  const how = size < 2.3 ? "leans" : size < 4.6 ? "speaks" : size < 20 ? "speaks strongly" : "leaves no doubt";
  if (size >= 20) return ratio > 0 ? "leaves no doubt: apart" : "leaves no doubt: together";
  return `${how} for ${ratio > 0 ? "being apart" : "fitting together"}`;
}

function neighbours(agreeing: number, contradicting: number): string {
  if (agreeing === 0 && contradicting === 0) return "no other pair around it can tell";
  if (agreeing === contradicting) return "its neighbours are divided";
  return contradicting > agreeing ? "its neighbours contradict it" : "its neighbours agree";
}

function verdictOf(name: string, piece: Evidence, pair: Pair): string {
  if (name === "displacement" && correctionOpen(pair)) return "not believed";
  if (piece.log_ratio !== null) return speaks(piece.log_ratio);
  if (name === "ambiguity" && piece.value !== null) return piece.value > 0.7 ? "another place fits nearly as well" : "no other place fits as well";
  if (name === "bend_m" && piece.value !== null) return "how far a submap itself is bent";
  if (piece.value === null || piece.null === null) return "nothing to compare with";
  if (name === "agreeing") return neighbours(piece.value, piece.null);
  if (name === "support") {
    if (piece.null <= 0) return "nothing agrees once registered";
    const gain = piece.null / Math.max(piece.value, 1);
    return gain > 1.3 ? `registration makes it agree ${gain.toFixed(1)} times better` : "registration gains little";
  }
  if (name === "mean_distance_m") return piece.value > 1.3 * piece.null ? "closer once registered" : "hardly closer once registered";
  if (name === "log10_gamma") {
    return piece.value < piece.null - 0.5 ? "worse than usual" : piece.value > piece.null + 0.5 ? "better than usual" : "as usual";
  }
  if (name.startsWith("conflict")) {
    return piece.value > Math.max(3 * piece.null, 0.005) ? "more than usual" : "as usual";
  }
  return "";
}

function offset(pair: Pair): string {
  if (pair.offset_m === null) return "not measured";
  if (correctionOpen(pair)) return notBelieved(pair);
  return [centimetres(pair.offset_m), interval(pair) && `${interval(pair)} at 95 %`, degrees(pair)].filter(Boolean).join("; ");
}

/** How to mend it; a shift that is told along the robot's way once more as the program tells it, for who has to enter it. */
function mending(state: State): string {
  const mended = cure(state.archive, state.selected);
  if (mended === null) return "unknown";
  const world = shift(partsInWorld(state.archive, state.selected));
  const moved = mended.moved === "" || mended.moved === world ? mended.moved : `${mended.moved} (${world})`;
  return toMend(state.pairs[state.selected]!.source, { ...mended, moved });
}

function facts(state: State): HTMLElement {
  const number = state.selected;
  const pair = state.pairs[number]!;
  const rows: [string, string][] = [
    ["What it is", kindInWords[pair.kind]],
    ["Offset", offset(pair)],
    ["To mend it", mending(state)],
    ["Gap between double walls", centimetres(pair.gap_m)],
    ["Smallest offset seen here", centimetres(pair.minimum_detectable_m)],
    ["Directions left open", pair.unobservable === null ? "unknown" : pair.unobservable.length === 0 ? "none" : pair.unobservable.length === 1 ? "one, drawn as a dashed axis" : `${pair.unobservable.length}, drawn as dashed axes`],
    ["Judgement", probability(pair.p_inconsistent)],
    ["Overlap", `${Math.round(100 * pair.overlap)} % of the voxels, ${pair.matched} matched`],
    ["Γ, Θ, Γᵛ", `${large(pair.gamma)}, ${large(pair.theta)}, ${large(pair.verified)}`],
  ];
  return element(
    "div",
    { class: "facts" },
    element("h3", {}, "In words"),
    element("p", {}, element("span", { class: `verdict ${pair.verdict}` }, pair.verdict), ` ${pair.reason}.`),
    element("p", { class: "action" }, action(state.archive, number)),
    element("table", {}, ...rows.map(([name, value]) => element("tr", {}, element("th", {}, name), element("td", {}, value)))),
  );
}

function evidence(pair: Pair, pairs: readonly Pair[]): HTMLElement {
  const rows = Object.entries(pair.evidence).map(([name, measured]) => {
    const piece = name === "log10_gamma" && isUsualAlone(pairs, pair) ? { ...measured, null: null } : measured;
    const known = kEvidence[name];
    const show = (value: number | null) => (value === null ? "" : known ? known.value(value) : large(value));
    return element(
      "tr",
      { data: { evidence: name } },
      element("td", { title: name }, known?.name ?? name),
      element("td", {}, show(piece.value)),
      element("td", { title: known?.against ?? "" }, piece.null === null ? "" : `${show(piece.null)}${known ? ` ${known.against}` : ""}`),
      element("td", {}, verdictOf(name, piece, pair)),
    );
  });
  const head = ["Test", "Here", "Against", "In words"].map((text) => element("th", {}, text));
  return element(
    "div",
    { class: "evidence" },
    element("h3", {}, "Evidence"),
    rows.length === 0 ? element("p", {}, "Nothing was measured.") : element("table", {}, element("tr", {}, ...head), ...rows),
  );
}

export class Details {
  private plot: uPlot | null = null;
  private readonly chart = element("div", { class: "chart" });
  private readonly caption = element("p", { class: "quiet" });

  constructor(private readonly state: State) {
    const redraw = () => this.show();
    state.on("selection", redraw);
    state.on("theme", redraw);
    new ResizeObserver(() => this.plot?.setSize(this.size())).observe(this.chart);
    redraw();
  }

  private size(): { width: number; height: number } {
    return { width: Math.max(200, this.chart.clientWidth), height: 240 };
  }

  private show(): void {
    this.plot?.destroy();
    this.plot = null;
    const pair = this.state.pairs[this.state.selected];
    if (!pair) {
      const { result } = this.state.archive;
      const words = result.pairs.length === 0 ? `${sentence(result.system.reason)}.` : "Choose a pair: a line of the map, a cell, a row or a place.";
      byId("details").replaceChildren(element("p", { class: "quiet" }, words));
      return;
    }
    byId("details").replaceChildren(
      facts(this.state),
      element("div", { class: "histogram" }, element("h3", {}, "Distances of matched voxels"), this.chart, this.caption),
      evidence(pair, this.state.pairs),
    );
    this.histogram(pair);
  }

  private histogram(pair: Pair): void {
    this.chart.replaceChildren();
    if (!pair.histogram) {
      this.caption.textContent = "Nothing matched: there is no histogram.";
      return;
    }
    const picture = this.state.archive.pairs[this.state.selected]!;
    const before = pair.histogram;
    const after = picture.registeredHistogram;
    const x = before.counts.map((_, i) => 100 * (i + 0.5) * before.width);
    const same = after !== null && after.counts.length === before.counts.length;
    const ink = themed("--ink");
    const grid = { stroke: themed("--line"), width: 1 };
    const bars = uPlot.paths.bars!({ size: [1, 100], gap: 0 });
    const stepped = uPlot.paths.stepped!({ align: 0 as never });
    const options: uPlot.Options = {
      ...this.size(),
      cursor: { drag: { x: false, y: false } },
      scales: { x: { time: false, range: [0, 100 * before.width * before.counts.length] } },
      axes: [
        { stroke: ink, grid, ticks: grid, label: "distance [cm]", labelSize: 20 },
        { stroke: ink, grid, ticks: grid, size: 56, label: "voxels", labelSize: 18 },
      ],
      series: [
        { label: "cm" },
        { label: "as in the map", stroke: css(sourceColour), fill: `${css(sourceColour).slice(0, -1)} / 0.35)`, width: 1, paths: bars, points: { show: false } },
        { label: "its fit", stroke: css(sourceColour), width: 2.5, points: { show: false } },
        { label: "registered", stroke: css(targetColour), width: 1.5, paths: stepped, points: { show: false } },
        { label: "its fit", stroke: css(targetColour), width: 2.5, dash: [6, 4], points: { show: false } },
      ],
    };
    const none = before.counts.map(() => null);
    this.plot = new uPlot(
      options,
      [
        x,
        before.counts,
        fitted(before, pair.mu, pair.sigma),
        same ? after.counts : none,
        same ? fitted(after, picture.registeredMu, picture.registeredSigma) : none,
      ],
      this.chart,
    );
    const total = (histogram: Histogram) => histogram.counts.reduce((sum, count) => sum + count, 0);
    this.caption.textContent = same
      ? `${total(before)} voxels matched as in the map, ${total(after)} once registered; curves are the truncated Gaussians of the paper. A heap that moves left when registered is a wall that stood twice.`
      : `${total(before)} voxels matched as in the map; registration gave no second histogram.`;
  }
}
