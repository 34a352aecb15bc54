// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// What is selected and how it is shown; every view listens here and none talks to another.
import type { Archive, Pair } from "./archive.js";
import { commonBeginning } from "./names.js";

export type Listener = () => void;

export class State {
  /** Number of the selected pair, or -1. */
  selected = -1;
  /** Number of the pair under the pointer, or -1. */
  hovered = -1;
  private readonly listeners: { selection: Listener[]; hover: Listener[]; theme: Listener[] } = {
    selection: [],
    hover: [],
    theme: [],
  };

  /** What all robots' names begin with. */
  readonly common: string;

  constructor(readonly archive: Archive) {
    this.common = commonBeginning(archive.result.robots.map((robot) => robot.name));
  }

  get pairs(): Pair[] {
    return this.archive.result.pairs;
  }

  on(event: "selection" | "hover" | "theme", listener: Listener): void {
    this.listeners[event].push(listener);
  }

  select(pair: number): void {
    if (pair === this.selected) return;
    this.selected = pair;
    const fragment = pair < 0 ? "" : fragmentOf(this.pairs[pair]!);
    if (location.hash !== fragment) history.replaceState(null, "", fragment === "" ? location.pathname : fragment);
    for (const listener of this.listeners.selection) listener();
  }

  hover(pair: number): void {
    if (pair === this.hovered) return;
    this.hovered = pair;
    for (const listener of this.listeners.hover) listener();
  }

  themeChanged(): void {
    for (const listener of this.listeners.theme) listener();
  }

  /** The pair that a URL's fragment names, or -1: also where a mail program or a person wrote it otherwise, or the other
   * way round. */
  pairOfFragment(fragment: string): number {
    const exact = this.pairs.findIndex((pair) => fragmentOf(pair) === fragment);
    if (exact >= 0 || !fragment.startsWith("#pair=")) return exact;
    const named = readable(fragment.slice("#pair=".length)).trim();
    // Names may hold commas, so that the fragment cannot be split: it is compared with what each pair would give.
    const find = (of: (pair: Pair) => [string, string]) =>
      this.pairs.findIndex((pair) => [",", ", "].some((comma) => of(pair).join(comma) === named));
    const found = find(({ source, target }) => [source, target]);
    return found >= 0 ? found : find(({ source, target }) => [target, source]);
  }
}

/** What a fragment says, as people read it. */
export function readable(fragment: string): string {
  try {
    return decodeURIComponent(fragment);
  } catch {
    return fragment; // cut inside a letter
  }
}

const encoded = (name: string): string => encodeURIComponent(name).replaceAll("%2F", "/");

/** #pair=SOURCE,TARGET */
export function fragmentOf(pair: Pair): string {
  return `#pair=${encoded(pair.source)},${encoded(pair.target)}`;
}
