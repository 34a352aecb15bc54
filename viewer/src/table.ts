// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Every pair as a row; sorted and filtered.
import type { Pair } from "./archive.js";
import { byId, element } from "./dom.js";
import type { State } from "./state.js";
import { centimetres, large, shortProbability } from "./words.js";

interface Column {
  key: string;
  name: string;
  title: string;
  text: (pair: Pair) => string;
  order: (pair: Pair) => number | string | null;
}

const kWorst = { inconsistent: 0, unverified: 1, consistent: 2 } as const;

const kColumns: Column[] = [
  { key: "verdict", name: "verdict", title: "what was decided", text: (p) => p.verdict, order: (p) => kWorst[p.verdict] },
  { key: "target", name: "target", title: "the earlier submap", text: (p) => p.target, order: () => null },
  { key: "source", name: "source", title: "the later submap", text: (p) => p.source, order: () => null },
  { key: "kind", name: "kind", title: "sequential: one after the other; local: same robot again; global: two robots", text: (p) => p.kind, order: (p) => p.kind },
  { key: "offset", name: "offset", title: "how far registration moves it", text: (p) => (p.offset_m === null ? "" : centimetres(p.offset_m)), order: (p) => p.offset_m },
  { key: "degrees", name: "turn", title: "its rotation", text: (p) => (p.offset_deg === null ? "" : `${p.offset_deg.toFixed(1)}°`), order: (p) => p.offset_deg },
  { key: "probability", name: "probability", title: "of being inconsistent", text: (p) => shortProbability(p.p_inconsistent), order: (p) => p.p_inconsistent },
  { key: "overlap", name: "overlap", title: "share of voxels that match", text: (p) => `${Math.round(100 * p.overlap)} %`, order: (p) => p.overlap },
  { key: "gamma", name: "Γ", title: "as in the map", text: (p) => (p.gamma === null ? "" : large(p.gamma)), order: (p) => p.gamma },
  { key: "theta", name: "Θ", title: "once registered", text: (p) => (p.theta === null ? "" : large(p.theta)), order: (p) => p.theta },
  { key: "verified", name: "Γᵛ", title: "what registration gains", text: (p) => (p.verified === null ? "" : large(p.verified)), order: (p) => p.verified },
  { key: "reason", name: "why", title: "the reason in words", text: (p) => p.reason, order: (p) => p.reason },
];

const kFirst = 100;

export class Table {
  /** Numbers of the pairs that pass the filters, in the order shown. */
  rows: number[] = [];
  private readonly filter = { kind: "", robot: "", verdict: "", offset: "", text: "" };
  private sorted: { column: Column; down: boolean } = { column: kColumns[4]!, down: true };
  private limit = kFirst;
  private readonly body = element("tbody");
  private readonly head = element("tr");
  private readonly count = element("span", { class: "quiet" });
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
      element("div", { class: "scroll" }, element("table", {}, element("thead", {}, this.head), this.body)),
      this.more,
    );
    state.on("selection", () => this.mark(true));
    this.update();
  }

  private filtered(key: keyof Table["filter"], value: string): void {
    this.filter[key] = value;
    this.limit = kFirst;
    this.update();
  }

  private sort(column: Column): void {
    const numeric = typeof column.order(this.state.pairs[0]!) === "number";
    this.sorted = { column, down: this.sorted.column === column ? !this.sorted.down : numeric && column.key !== "verdict" };
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

  private key(number: number): number | string | null {
    const picture = this.state.archive.pairs[number]!;
    const { key, order } = this.sorted.column;
    if (key === "target") return picture.target;
    if (key === "source") return picture.source;
    return order(this.state.pairs[number]!);
  }

  private update(): void {
    const sign = this.sorted.down ? -1 : 1;
    this.rows = this.state.pairs.map((_, n) => n).filter((n) => this.passes(n));
    this.rows.sort((a, b) => {
      const x = this.key(a);
      const y = this.key(b);
      if (x === y) return a - b;
      if (x === null) return 1; // what was not measured comes last either way
      if (y === null) return -1;
      return (x < y ? -1 : 1) * sign;
    });
    for (const cell of this.head.querySelectorAll("th")) {
      const own = cell.dataset["column"] === this.sorted.column.key;
      cell.setAttribute("aria-sort", own ? (this.sorted.down ? "descending" : "ascending") : "none");
    }
    this.count.textContent = `${this.rows.length} of ${this.state.pairs.length} pairs`;
    this.fill();
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
          ...kColumns.map((column) => element("td", { class: `c-${column.key} ${column.key === "verdict" ? pair.verdict : ""}`, title: column.key === "reason" ? pair.reason : "" }, column.text(pair))),
        );
      }),
    );
    this.more.hidden = this.rows.length <= this.limit;
    this.mark(false);
  }

  private mark(reveal: boolean): void {
    const place = this.rows.indexOf(this.state.selected);
    if (place >= this.limit) {
      this.limit = place + kFirst;
      this.fill();
    }
    for (const row of this.body.querySelectorAll<HTMLElement>("tr")) {
      const own = row.dataset["pair"] === String(this.state.selected);
      row.classList.toggle("selected", own);
      if (own && reveal) {
        const box = row.closest(".scroll")!;
        const top = row.offsetTop - 40;
        if (top < box.scrollTop || top > box.scrollTop + box.clientHeight - 60) box.scrollTop = top;
      }
    }
  }

  /** The pair `steps` rows further in the order shown. */
  beside(steps: number): number {
    if (this.rows.length === 0) return -1;
    const place = this.rows.indexOf(this.state.selected);
    const next = place < 0 ? 0 : Math.min(this.rows.length - 1, Math.max(0, place + steps));
    return this.rows[next]!;
  }
}
