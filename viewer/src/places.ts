// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// The worst places first: pairs that disagree at one place make one entry.
import { action, correctionOpen, cure, wouldFit } from "./advice.js";
import type { Archive, Pair } from "./archive.js";
import { byId, element, markCurrent } from "./dom.js";
import type { State } from "./state.js";
import { centimetres, degrees, kindInWords, probability, sentence } from "./words.js";

export interface Place {
  /** Its worst pair, and all of them. */
  pair: number;
  pairs: number[];
}

/** How near the centres of two pairs are for one place. [m] */
const kNear = 8;
const kShown = 12;
const kOthers = 5;

/** Numbers of pairs, worst first. An offset is as good as the registration behind it: those that are not believed come
 * after those that are. */
export function worstFirst(pairs: Pair[]): (a: number, b: number) => number {
  const open = (n: number) => Number(correctionOpen(pairs[n]!));
  const offset = (n: number) => pairs[n]!.offset_m ?? -1;
  return (a, b) => open(a) - open(b) || offset(b) - offset(a) || a - b;
}

export function worstPlaces(archive: Archive): Place[] {
  const pairs = archive.result.pairs;
  const robots = (n: number): string => {
    const picture = archive.pairs[n]!;
    return [picture.source, picture.target].map((s) => archive.result.submaps[s]!.robot).join("\n");
  };
  const bad = pairs.map((_, n) => n).filter((n) => pairs[n]!.verdict === "inconsistent");
  bad.sort(worstFirst(pairs));
  const places: Place[] = [];
  for (const n of bad) {
    const [x, y, z] = archive.pairs[n]!.centre;
    const near = places.find((place) => {
      const [px, py, pz] = archive.pairs[place.pair]!.centre;
      return Math.hypot(px - x, py - y, pz - z) < kNear && robots(place.pair) === robots(n);
    });
    if (near) near.pairs.push(n);
    else places.push({ pair: n, pairs: [n] });
  }
  return places;
}

function card(state: State, place: Place, sign: string): HTMLElement {
  const pair = state.pairs[place.pair]!;
  const more = place.pairs.length - 1;
  const offset = [centimetres(pair.offset_m), degrees(pair)].filter((text) => text !== "").join(", ");
  const mended = cure(state.archive, place.pair);
  const known = pair.offset_m !== null && !correctionOpen(pair);
  return element(
    "button",
    {
      type: "button",
      class: `place ${pair.verdict}`,
      data: { pair: String(place.pair) },
      on: { click: () => state.select(place.pair) },
    },
    element("span", { class: `rank ${pair.verdict}` }, sign),
    element(
      "span",
      { class: "what" },
      element("b", {}, known ? `${offset} apart` : "offset not known"),
      ` ${pair.target} and ${pair.source}`,
      element("small", {}, `${kindInWords[pair.kind]}; ${probability(pair.p_inconsistent)}`),
      mended && element("small", { class: "more" }, wouldFit(pair.source, mended)),
      element("small", { class: "action more" }, action(state.archive, place.pair)),
      more === 0 ? null : element("small", { class: "more" }, `${more} more pair${more === 1 ? "" : "s"} of these robots disagree here`),
    ),
  );
}

/** Where nothing is wrong: what could not be decided, and the largest of what is small enough. */
function others(state: State): HTMLElement[] {
  const sections: HTMLElement[] = [];
  const add = (title: string, verdict: string, sign: string) => {
    const numbers = state.pairs.map((_, n) => n).filter((n) => state.pairs[n]!.verdict === verdict);
    numbers.sort(worstFirst(state.pairs));
    if (numbers.length === 0) return;
    sections.push(element("h3", {}, numbers.length > kOthers ? `${title} (${kOthers} of ${numbers.length})` : title));
    for (const n of numbers.slice(0, kOthers)) sections.push(card(state, { pair: n, pairs: [n] }, sign));
  };
  add("Not decided", "unverified", "?");
  add("Largest offsets that you can live with", "consistent", "✓");
  return sections;
}

/** Returns what marks the card of the pair that is selected. */
export function showPlaces(state: State, places: Place[]): () => void {
  const root = byId("places");
  if (state.pairs.length === 0) {
    root.replaceChildren(element("h2", {}, "No pair to judge"), element("p", { class: "quiet" }, `${sentence(state.archive.result.system.reason)}.`));
    return () => undefined;
  }
  const undecided = state.pairs.filter((pair) => pair.verdict === "unverified").length;
  const title =
    places.length === 0 ? "No place is known to be wrong" : places.length === 1 ? "The one wrong place" : "Worst places first";
  const list = element("div", { class: "list" }, ...places.slice(0, kShown).map((place, i) => card(state, place, String(i + 1))));
  if (places.length > kShown) {
    list.append(element("p", { class: "quiet" }, `${places.length - kShown} smaller ones are in the table below.`));
  }
  if (places.length === 0) list.append(...others(state));
  else if (undecided > 0) {
    list.append(
      element("p", { class: "quiet" }, `${undecided} pair${undecided === 1 ? " was" : "s were"} not decided; the table says why.`),
    );
  }
  root.replaceChildren(element("h2", {}, title), list);
  const mark = (reveal: boolean) => {
    for (const button of root.querySelectorAll<HTMLElement>(".place")) {
      const number = Number(button.dataset["pair"]);
      const place = places.find((candidate) => candidate.pair === number);
      markCurrent(button, number === state.selected);
      button.classList.toggle("holds", place !== undefined && place.pairs.includes(state.selected));
      if (reveal && number === state.selected) button.scrollIntoView({ block: "nearest" });
    }
  };
  state.on("selection", () => mark(true));
  return () => mark(false);
}
