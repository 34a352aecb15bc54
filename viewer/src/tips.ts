// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
import { correctionOpen, notBelieved } from "./advice.js";
import type { Pair } from "./archive.js";
import { element } from "./dom.js";
import { centimetres, degrees, interval, kindInWords, large, shortProbability } from "./words.js";

/** All numbers of a pair that fit under a pointer. */
export function pairTip(pair: Pair): HTMLElement {
  const offset = () => {
    if (pair.offset_m === null) return "not measured";
    if (correctionOpen(pair)) return notBelieved(pair);
    return [interval(pair) === "" ? centimetres(pair.offset_m) : `${centimetres(pair.offset_m)} (${interval(pair)})`, degrees(pair)].filter(Boolean).join(", ");
  };
  const rows: [string, string][] = [
    ["offset", offset()],
    ["probability of being inconsistent", shortProbability(pair.p_inconsistent)],
    ["Γ as in the map", large(pair.gamma)],
    ["Θ once registered", large(pair.theta)],
    ["Γᵛ = Θ − Γ", large(pair.verified)],
    ["overlap", `${Math.round(100 * pair.overlap)} %, ${pair.matched} voxels`],
  ];
  return element(
    "div",
    {},
    element("b", {}, `${pair.target} and ${pair.source}`),
    element("span", { class: `verdict ${pair.verdict}` }, pair.verdict),
    element("div", { class: "quiet" }, kindInWords[pair.kind]),
    element("table", {}, ...rows.map(([name, value]) => element("tr", {}, element("td", {}, name), element("td", {}, value)))),
  );
}
