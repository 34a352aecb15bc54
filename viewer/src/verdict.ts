// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// The answer, before anything else.
import { bentInside } from "./advice.js";
import type { Frame, Kind, Result, Verdict } from "./archive.js";
import { byId, element } from "./dom.js";
import { centimetres, rotation, sentence } from "./words.js";

const kKinds: [Kind, string][] = [
  ["sequential", "one after the other"],
  ["local", "same robot, again"],
  ["global", "two robots"],
];
const kVerdicts: Verdict[] = ["consistent", "inconsistent", "unverified"];

const kNamedAtMost = 6;  // robots, or meetings of two, that are named one by one

const kHeadline = {
  consistent: ["✓", "Consistent", "this map agrees with itself"],
  inconsistent: ["✗", "Inconsistent", "this map contradicts itself"],
  undetermined: ["?", "Undetermined", "too little could be decided"],
} as const;

function certificate(result: Result): string {
  const { certificate_m, certificate_of, certificate_excludes } = result.system;
  if (certificate_m === null) return "Nothing can be certified about the whole map at 95 %.";
  // Rounded down it would claim more than was shown, as 0.00 m would of two copies of one robot.
  const atMost = Math.max(0.01, Math.ceil(100 * certificate_m - 1e-9) / 100);
  let text = `Certified at 95 %: consistent to ${atMost.toFixed(2)} m`;
  if (certificate_of) text += ` (bounded by ${certificate_of.join(" with ")})`;
  const count = certificate_excludes.length;
  if (count > 0) {
    const [target, source] = certificate_excludes[0]!;
    const excluded = new Set(certificate_excludes.map((pair) => pair.join("\n")));
    const wrong = result.pairs.filter(
      (pair) => pair.verdict === "inconsistent" && excluded.has(`${pair.target}\n${pair.source}`),
    ).length;
    text += `, except for ${count} overlapping pair${count === 1 ? "" : "s"} (${target} with ${source}${count > 1 ? ", ..." : ""}) of which that cannot be said`;
    if (wrong > 0) text += `; ${wrong} of these ${wrong === 1 ? "is" : "are"} inconsistent`;
  }
  return `${text}.`;
}

const kLeastTurn_deg = 0.05; // as people are told
const kMostlyUpright = Math.sqrt(3) / 2; // of a turn's axis: within 30 degrees

/** What mends a robot that lies off another as a whole. */
export function frameInWords(frame: Frame): string {
  const turn = rotation(frame.T_world_correction);
  const sine = Math.hypot(turn.x, turn.y, turn.z);
  const angle_deg = (2 * Math.atan2(sine, Math.abs(turn.w)) * 180) / Math.PI;
  const up = sine > 0 ? (Math.sign(turn.w || 1) * turn.z) / sine : 0;
  const inWords = (cm: number, k: number) => `${"xyz"[k]}${cm < 0 ? "-" : "+"}${Math.abs(cm)}`;
  const shift = frame.shift.map((m) => Math.round(100 * m)).map(inWords).join(" ");
  let turned = "";
  if (angle_deg >= kLeastTurn_deg) {
    const by = `by ${angle_deg.toFixed(1)}°`;
    turned = Math.abs(up) < kMostlyUpright ? ` and all tilted ${by}` : ` and all turned ${by} to the ${up > 0 ? "left" : "right"}`;
  }
  return `${frame.source} lies off ${frame.target} as a whole: with its middle moved ${shift} cm in world axes${turned} it would meet ${frame.target} in ${frame.agreeing} of ${frame.witnesses} pairs. Look at how the two were brought into one frame before any single link.`;
}

/** Every two robots as people read them, by their key: a key cannot be taken apart, for names may hold commas. */
export function meetingsInWords(robots: readonly { name: string }[]): Map<string, string> {
  const words = new Map<string, string>();
  robots.forEach(({ name: a }, i) => {
    for (const { name: b } of robots.slice(i + 1)) if (!words.has(`${a},${b}`)) words.set(`${a},${b}`, `${a} with ${b}`);
  });
  return words;
}

function decided(result: Result): string {
  const { sequential, local, global } = result.system.decided;
  const shares: string[] = [];
  const add = (name: string, share: number | null) => {
    if (share !== null) shares.push(`${name} ${Math.round(100 * share)} %`);
  };
  add("one after the other", sequential);
  add("same robot again", local);
  const inWords = meetingsInWords(result.robots);
  const meetings = Object.entries(global).flatMap(([both, share]) =>
    share === null ? [] : [{ who: inWords.get(both) ?? both, share }],
  );
  if (meetings.length <= kNamedAtMost) {
    for (const { who, share } of meetings) add(who, share);
  } else {
    meetings.sort((a, b) => a.share - b.share);
    const told = ({ who, share }: { who: string; share: number }) => `${Math.round(100 * share)} % (${who})`;
    shares.push(`two robots, ${meetings.length} times, ${told(meetings[0]!)} to ${told(meetings[meetings.length - 1]!)}`);
  }
  return shares.length === 0 ? "" : `Of what overlaps was decided: ${shares.join(", ")}.`;
}

function counts(result: Result): HTMLElement {
  const rows = kKinds.flatMap(([kind, words]) => {
    const own = result.pairs.filter((pair) => pair.kind === kind);
    if (own.length === 0) return [];
    const cells = kVerdicts.map((verdict) =>
      element("td", { class: verdict }, String(own.filter((pair) => pair.verdict === verdict).length)),
    );
    return [element("tr", {}, element("th", { title: kind }, words), ...cells)];
  });
  const head = element("tr", {}, element("th", {}, "pairs"), ...kVerdicts.map((verdict) => element("th", {}, verdict)));
  return element("table", { class: "counts" }, head, ...rows);
}

function robots(result: Result): string {
  if (result.robots.length <= kNamedAtMost) {
    const each = result.robots.map((robot) => `${robot.name} (${robot.submaps} piece${robot.submaps === 1 ? "" : "s"}, ${Math.round(robot.path_length_m)} m)`);
    return `Robots: ${each.join(", ")}.`;
  }
  const submaps = result.robots.reduce((sum, robot) => sum + robot.submaps, 0);
  const path_m = result.robots.reduce((sum, robot) => sum + robot.path_length_m, 0);
  return `${result.robots.length} robots, ${submaps} pieces, ${Math.round(path_m)} m.`;
}

const kManyBent = 1 / 3; // of the inconsistent pairs; then poses of whole submaps are no cure

function bends(result: Result): string {
  const { inconsistent } = result.system;
  const tolerance = Number(result.config["tolerance"]);
  const bent = result.pairs.filter((pair) => pair.verdict === "inconsistent" && bentInside(pair, tolerance)).length;
  if (bent === 0 || bent < kManyBent * inconsistent) return "";
  return ` ${bent} of the ${inconsistent} are bent inside: see to stamps, de-skewing, the sensor's mounting and slips within submaps first.`;
}

export function showVerdict(result: Result): void {
  const [sign, word, meaning] = kHeadline[result.system.verdict];
  const tolerance = Number(result.config["tolerance"]);
  const left = result.system.too_little_overlap;
  byId("verdict").className = result.system.verdict;
  byId("verdict").replaceChildren(
    element("div", { class: "word" }, element("span", { class: "sign" }, sign), element("h1", {}, word), element("small", {}, meaning)),
    element(
      "div",
      { class: "why" },
      element("p", {}, element("b", {}, `${sentence(result.system.reason)}.`), ` What you can live with: ${centimetres(tolerance)}.${bends(result)}`),
      ...(result.system.frames ?? []).map((frame) => element("p", {}, frameInWords(frame))),
      element("p", {}, certificate(result)),
      element("p", { class: "quiet" }, `${decided(result)} ${robots(result)}${left > 0 ? ` ${left} more pairs overlap too little to be tested.` : ""}`),
    ),
    counts(result),
  );
  document.title = `kilter: ${word.toLowerCase()}`;
}
