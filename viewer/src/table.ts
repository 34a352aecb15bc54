// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Every pair as a row; sorted and filtered.
import { correctionOpen, notBelieved } from "./advice.js";
import type { Pair } from "./archive.js";
import { byId, element, markCurrent } from "./dom.js";
import { partsOfName } from "./names.js";
import { worstFirst } from "./places.js";
import type { State } from "./state.js";
import { centimetres, large, shortProbability } from "./words.js";

interface Column {
  key: string;
  name: string;
  title: string;
  numeric?: true; // largest first, at first
  text: (pair: Pair) => string;
  order: (pair: Pair) => number | string | null;
}

const kWorst = { inconsistent: 0, unverified: 1, consistent: 2 } as const;

const kColumns: Column[] = [
  { key: "verdict", name: "verdict", title: "what was decided", text: (p) => p.verdict, order: (p) => kWorst[p.verdict] },
  { key: "target", name: "target", title: "the earlier submap", text: (p) => p.target, order: () => null },
  { key: "source", name: "source", title: "the later submap", text: (p) => p.source, order: () => null },
  { key: "kind", name: "kind", title: "sequential: one after the other; local: same robot again; global: two robots", text: (p) => p.kind, order: (p) => p.kind },
  { key: "offset", numeric: true, name: "offset", title: "how far registration moves it; with ? it is not believed", text: (p) => (p.offset_m === null ? "" : `${centimetres(p.offset_m)}${correctionOpen(p) ? "?" : ""}`), order: (p) => p.offset_m },
  { key: "degrees", numeric: true, name: "turn", title: "its rotation", text: (p) => (p.offset_deg === null ? "" : `${p.offset_deg.toFixed(1)}°`), order: (p) => p.offset_deg },
  { key: "probability", numeric: true, name: "probability", title: "of being inconsistent", text: (p) => shortProbability(p.p_inconsistent), order: (p) => p.p_inconsistent },
  { key: "overlap", numeric: true, name: "overlap", title: "share of voxels that match", text: (p) => `${Math.round(100 * p.overlap)} %`, order: (p) => p.overlap },
  { key: "gamma", numeric: true, name: "Γ", title: "as in the map", text: (p) => (p.gamma === null ? "" : large(p.gamma)), order: (p) => p.gamma },
  { key: "theta", numeric: true, name: "Θ", title: "once registered", text: (p) => (p.theta === null ? "" : large(p.theta)), order: (p) => p.theta },
  { key: "verified", numeric: true, name: "Γᵛ", title: "what registration gains", text: (p) => (p.verified === null ? "" : large(p.verified)), order: (p) => p.verified },
  { key: "reason", name: "why", title: "the reason in words", text: (p) => p.reason, order: (p) => p.reason },
];

const kFirst = 100;
const kMostPrinted = 1000;
const kShortName = 12; // longer ones get room on paper

/** What a cell says under the pointer. */
function hint(column: Column, pair: Pair): string {
  if (["reason", "target", "source"].includes(column.key)) return column.text(pair);
  return column.key === "offset" && pair.offset_m !== null && correctionOpen(pair) ? notBelieved(pair) : "";
}

export class Table {
  /** Numbers of the pairs that pass the filters, in the order shown. */
  rows: number[] = [];
  private readonly filter = { kind: "", robot: "", verdict: "", offset: "", text: "" };
  private sorted: { column: Column; down: boolean } | null = null; // before a column is chosen: as the places are
  private limit = kFirst;
  private shownBefore = kFirst;
  private readonly body = element("tbody");
  private readonly head = element("tr");
  private readonly count = element("span", { class: "quiet" });
  private readonly printed = element("p", { class: "quiet on-paper" });
  private readonly more = element("button", { type: "button", on: { click: () => this.extend(this.limit * 5) } }, "show more");

  constructor(private readonly state: State) {
    const choose = (key: "kind" | "robot" | "verdict", all: string, values: string[]) =>
      element(
        "select",
        { id: `filter-${key}`, label: key, on: { change: (event) => this.filtered(key, (event.target as HTMLSelectElement).value) } },
        element("option", { value: "" }, all),
        ...values.map((value) => element("option", { value }, value)),
      );
    const offset = element("input", {
      type: "number",
      id: "filter-offset",
      min: "0",
      step: "1",
      title: "only pairs that are at least so far apart",
      label: "least offset in centimetres",
      on: { input: (event) => this.filtered("offset", (event.target as HTMLInputElement).value) },
    });
    const text = element("input", {
      type: "search",
      id: "filter-text",
      title: "only pairs with this in a submap's name or in the reason",
      label: "text to look for",
      on: { input: (event) => this.filtered("text", (event.target as HTMLInputElement).value) },
    });
    text.placeholder = "name or reason";
    for (const column of kColumns) {
      this.head.append(
        element(
          "th",
          { title: column.title, data: { column: column.key } },
          element("button", { type: "button", on: { click: () => this.sort(column) } }, column.name),
        ),
      );
    }
    const robots = state.archive.result.robots.map((robot) => robot.name);
    const long = state.archive.result.submaps.some(({ id }) => id.length > kShortName);
    byId("table").replaceChildren(
      element("h2", {}, "All pairs"),
      element(
        "div",
        { class: "bar" },
        choose("verdict", "every verdict", ["inconsistent", "unverified", "consistent"]),
        choose("kind", "every kind", ["sequential", "local", "global"]),
        choose("robot", "every robot", robots),
        element("label", {}, "at least ", offset, " cm"),
        text,
        this.count,
      ),
      this.printed,
      element("div", { class: "scroll" }, element("table", { class: long ? "long-names" : "" }, element("thead", {}, this.head), this.body)),
      this.more,
    );
    state.on("selection", () => this.mark(true));
    this.update();
    this.mark(true);
  }

  private filtered(key: keyof Table["filter"], value: string): void {
    this.filter[key] = value;
    this.limit = kFirst;
    this.update();
  }

  private sort(column: Column): void {
    this.sorted = { column, down: this.sorted?.column === column ? !this.sorted.down : column.numeric === true };
    this.update();
  }

  private passes(number: number): boolean {
    const pair = this.state.pairs[number]!;
    const { kind, robot, verdict, offset, text } = this.filter;
    const picture = this.state.archive.pairs[number]!;
    const submaps = this.state.archive.result.submaps;
    if (kind !== "" && pair.kind !== kind) return false;
    if (verdict !== "" && pair.verdict !== verdict) return false;
    if (robot !== "" && ![picture.source, picture.target].some((s) => submaps[s]!.robot === robot)) return false;
    if (offset !== "" && !(pair.offset_m !== null && 100 * pair.offset_m >= Number(offset))) return false;
    return text === "" || `${pair.target} ${pair.source} ${pair.reason}`.toLowerCase().includes(text.toLowerCase());
  }

  private key(number: number, { key, order }: Column): number | string | null {
    const picture = this.state.archive.pairs[number]!;
    if (key === "target") return picture.target;
    if (key === "source") return picture.source;
    return order(this.state.pairs[number]!);
  }

  private update(): void {
    const { pairs } = this.state;
    const worst = worstFirst(pairs);
    this.rows = pairs.map((_, n) => n).filter((n) => this.passes(n));
    this.rows.sort((a, b) => {
      if (!this.sorted) return kWorst[pairs[a]!.verdict] - kWorst[pairs[b]!.verdict] || worst(a, b);
      const sign = this.sorted.down ? -1 : 1;
      const x = this.key(a, this.sorted.column);
      const y = this.key(b, this.sorted.column);
      if (x === y) return a - b;
      if (x === null) return 1; // what was not measured comes last either way
      if (y === null) return -1;
      return (x < y ? -1 : 1) * sign;
    });
    for (const cell of this.head.querySelectorAll("th")) {
      const sort = !this.sorted || cell.dataset["column"] !== this.sorted.column.key ? "none" : this.sorted.down ? "descending" : "ascending";
      cell.setAttribute("aria-sort", sort);
    }
    this.count.textContent = `${this.rows.length} of ${this.state.pairs.length} pairs`;
    this.fill();
  }

  /** Before paper all rows that pass, and what they had to pass; after it as before. */
  print(begins: boolean): void {
    const { kind, robot, verdict, offset, text } = this.filter;
    const asked = [verdict, kind, robot, offset && `at least ${offset} cm`, text && `"${text}"`].filter(Boolean);
    const left = this.rows.length > kMostPrinted ? `; the first ${kMostPrinted} of these are printed, pairs.csv has all` : "";
    this.printed.textContent = `${this.count.textContent}${asked.length === 0 ? "" : `: ${asked.join(", ")}`}${left}`;
    if (begins) this.shownBefore = this.limit;
    this.extend(begins ? kMostPrinted : this.shownBefore);
  }

  private extend(limit: number): void {
    this.limit = limit;
    this.fill();
  }

  private fill(): void {
    this.body.replaceChildren(
      ...this.rows.slice(0, this.limit).map((number) => {
        const pair = this.state.pairs[number]!;
        return element(
          "tr",
          { data: { pair: String(number) }, on: { click: () => this.state.select(number) } },
          ...kColumns.map((column) => element("td", { class: `c-${column.key} ${column.key === "verdict" ? pair.verdict : ""}`, title: hint(column, pair) }, this.content(column, number))),
        );
      }),
    );
    this.more.hidden = this.rows.length <= this.limit;
    this.mark(false);
  }

  /** A submap's name shrinks from what all have in common to what is its own. */
  private content({ key, text }: Column, number: number): Node | string {
    const { source, target } = this.state.archive.pairs[number]!;
    if (key !== "source" && key !== "target") return text(this.state.pairs[number]!);
    const { id, robot } = this.state.archive.result.submaps[key === "source" ? source : target]!;
    const [common, own, piece] = partsOfName(id, robot, this.state.common);
    return element("span", { class: "name" }, element("span", { class: "common" }, common), element("span", { class: "own" }, own), element("span", {}, piece));
  }

  private mark(reveal: boolean): void {
    const place = this.rows.indexOf(this.state.selected);
    if (place >= this.limit) {
      this.limit = place + kFirst;
      this.fill();
    }
    for (const row of this.body.querySelectorAll<HTMLElement>("tr")) {
      const own = row.dataset["pair"] === String(this.state.selected);
      markCurrent(row, own);
      if (own && reveal) {
        const box = row.closest(".scroll")!;
        const top = row.offsetTop - 40;
        if (top < box.scrollTop || top > box.scrollTop + box.clientHeight - 60) box.scrollTop = top;
      }
    }
  }

  /** The pair `steps` rows further in the order shown. */
  beside(steps: number): number {
    if (this.rows.length === 0) return this.state.selected;
    const place = this.rows.indexOf(this.state.selected);
    const next = place < 0 ? 0 : Math.min(this.rows.length - 1, Math.max(0, place + steps));
    return this.rows[next]!;
  }
}
