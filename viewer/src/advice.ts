// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// What to do about a pair, in plain words.
import type { Archive, Pair, Submap } from "./archive.js";
import { centimetres, heading, parts, shift, turn, turnInWords } from "./words.js";

function scans(submap: Submap): string {
  const { first_scan: first, last_scan: last, robot } = submap;
  if (first === null) return submap.id;
  return first === last ? `scan ${first} of ${robot}` : `scans ${first} to ${last} of ${robot}`;
}

/** What a reason says, and what would decide the pair then; the first that fits. @ is how far off registration ended. */
const kUndecided: readonly (readonly [string, string])[] = [
  ["within what odometry may have drifted", "as mapped the two hardly share anything, but they would if odometry drifted as far as it may have. Look at both clouds: if they show one place, a link is missing."],
  ["ask for another correction", "registration ended @ off, but the pairs around it ask for another correction. Mend those first, then check again."],
  ["no registration around it confirms it", "it fits @ off, where a neighbour's correction would put it, but no other pair says the same. Look at both clouds and judge."],
  ["ambiguous: ", "two places fit nearly as well, as aisles and rows of pillars do. A pass that sees something which is there only once would settle it."],
  ["registration lost overlap", "where it fits, @ off, the two share less than as mapped: they may be of different places. Look at both clouds and judge."],
  ["still conflicts", "even once registered the two contradict each other. Something moved here, or they are of different places."],
  ["agrees worse than other pairs", "even once registered the two agree worse than others here, and points alone cannot say why. Scans, which know what they saw through, would."],
  ["conflicts more there", "it would fit @ off, but there more stands where the other saw through: a similar place, such as the next aisle or the storey above, may be what fits. Look at both clouds and judge."],
  ["agrees no better there", "registration ended @ off, but the two agree no better there than as mapped. Look at both clouds and judge."],
  ["no free space speaks against the map", "what lies near each other here was seen from opposite sides, such as a floor and the ceiling below. Nothing speaks against the map."],
  ["too little overlap", "the two saw too little in common. Another pass through here would settle it."],
  ["nothing in the scene fixes the pose", "what both saw fixes no pose, as a bare wall or floor does not. A pass that sees more here would settle it."],
  ["registration failed", "the two could not be brought together. Look at both clouds here: they may be of different places, or far apart."],
  ["direction that nothing", "along the dashed axis the two could be apart and nobody would see it. A pass that sees something across it would settle it."],
  ["no rigid motion mends", "one of the two is bent inside, by about as much as you can live with. Shorter submaps would tell where."],
  ["too much for the tolerance", "its cells are too coarse for the tolerance. Smaller cells, or the points that they were made of, would settle it."],
  ["over the whole map", "it looks too far apart, but among so many pairs some do by chance. Another pass through here would settle it."],
  ["believed inconsistent before looking", "it looks near enough, but with so many pairs believed wrong before looking (prior_inconsistent) that does not suffice."],
  ["too uncertain", "what both saw tells the offset no better than that. Another pass through here would settle it."],
  ["too few to compare it with", "the paper's test compares pairs with each other, and here are too few. With the judge displacement one pair suffices."],
  ["does not verify it", "it agrees worse than usual in this map, but registration makes it no better. Look at both clouds and judge."],
  ["Gamma is infinite", "all distances are equal or zero, of which the paper's test can say nothing. Are these copies of one cloud?"],
];

/** What would decide a pair that is not decided. */
function undecided(pair: Pair): string {
  const [, advice] = kUndecided.find(([says]) => pair.reason.includes(says)) ?? ["", "look at both clouds and judge."];
  const off = pair.offset_m === null ? "" : centimetres(pair.offset_m);
  return `Not decided: ${off === "" ? advice.replace(" @ off,", "").replace(" @ off", "") : advice.replace("@", off)}`;
}

/** Evidence that has a log ratio only where it decides without a registration that is believed: free space alone, a pose
 * that fits better, neighbours. */
const WITNESSES = ["conflict", "support", "agreeing"];

/** Whether the right pose is not known, though a registration may have ended somewhere: a witness says that the map's is
 * wrong, or nothing was decided since the registration is not believed. Such a pair has no constraint. */
export function correctionOpen(pair: Pair): boolean {
  if (pair.verdict === "unverified" && pair.p_value === null) return true;
  return WITNESSES.some((name) => (pair.evidence[name]?.log_ratio ?? null) !== null);
}

/** The offset of such a pair. */
export function notBelieved(pair: Pair): string {
  return `registration ended ${centimetres(pair.offset_m)} off, not believed`;
}

/** Whether what is usual in this map comes from this pair alone: only registered pairs count. */
export function isUsualAlone(pairs: readonly Pair[], pair: Pair): boolean {
  return pairs.every((other) => other === pair || other.T_target_source_registered === null);
}

/** Whether parts of it stay apart by more than the tolerance whatever the move: a submap is bent inside. */
export function bentInside(pair: Pair, tolerance_m: number): boolean {
  return (pair.evidence["bend_m"]?.value ?? 0) > tolerance_m;
}

/** Whether a move mends it only in part, by its reason. */
function moveIsNoCure(pair: Pair): boolean {
  return /no rigid motion mends|is bent, or slipped inside/.test(pair.reason);
}

/** How the source has to turn, where a shift alone would leave more than the tolerance; else empty. */
function turnNeeded(archive: Archive, number: number): string {
  const pair = archive.result.pairs[number]!;
  const by = turn(archive, number);
  if (!by || pair.offset_m === null || !pair.offset_vector) return "";
  const left2 = pair.offset_m ** 2 - pair.offset_vector.reduce((sum, metres) => sum + metres ** 2, 0);
  if (left2 <= Number(archive.result.config["tolerance"]) ** 2) return "";
  return turnInWords(by, heading(archive, archive.pairs[number]!.source));
}

/** What would mend a pair: a shift ("12 cm ahead"), a turn ("turned 2.4 degrees to the left") or both; whether it is only
 * the best that a move can do; and what it leaves open. */
export interface Cure {
  moved: string;
  turned: string;
  best: boolean;
  open: string;
}

/** How the source would have to move; null where that is not known. */
export function cure(archive: Archive, number: number): Cure | null {
  const pair = archive.result.pairs[number]!;
  if (correctionOpen(pair)) return null;
  const moved = shift(parts(archive, number));
  const turns = turnNeeded(archive, number);
  if (moved === "" && turns === "") return null;
  const directions = pair.unobservable?.length ?? 0;
  const open = directions === 0 ? "" : `; along the dashed ax${directions === 1 ? "is" : "es"} nothing is known`;
  return { moved, turned: turns, best: moveIsNoCure(pair), open };
}

const kMiddle = "about the middle of what both saw";

/** "b/2 would fit if moved 12 cm ahead, and turned 2.4 degrees to the left about the middle of what both saw". */
export function wouldFit(source: string, { moved, turned, best, open }: Cure): string {
  const moves = [moved && `moved ${moved}`, turned && `${turned} ${kMiddle}`].filter(Boolean);
  return `${source} would fit ${best ? "best " : ""}if ${moves.join(", and ")}${open}`;
}

/** "move b/2 12 cm ahead, and turn it 2.4 degrees to the left about the middle of what both saw". */
export function toMend(source: string, { moved, turned, best, open }: Cure): string {
  const turns = turned && `${turned.replace(/^(turn|tilt)ed/, (_, how: string) => `${how} ${moved === "" ? source : "it"}`)} ${kMiddle}`;
  const moves = [moved && `move ${source} ${moved}`, turns].filter(Boolean);
  return `${moves.join(", and ")}${best ? ", which mends it in part" : ""}${open}`;
}

/** Whether others that share a submap with a pair are inconsistent by a registration that is believed. */
function othersAreBelieved(archive: Archive, number: number): boolean {
  const { source, target } = archive.pairs[number]!;
  return archive.pairs.some((other, n) => {
    const shares = [other.source, other.target].some((submap) => submap === source || submap === target);
    const pair = archive.result.pairs[n]!;
    return n !== number && shares && pair.verdict === "inconsistent" && !correctionOpen(pair);
  });
}

function bendFirst(pair: Pair, target: Submap, source: Submap): string {
  const which = /the (source|target) is bent/.exec(pair.reason)?.[1];
  const bent = which === "source" ? source.id : which === "target" ? target.id : "one of the two";
  return `No move mends all of it, for ${bent} is bent or slipped inside: see to time stamps, de-skewing, the sensor's mounting and slips there first.`;
}

/** What to do about a pair, in plain words. */
export function action(archive: Archive, number: number): string {
  const pair = archive.result.pairs[number]!;
  const target = archive.result.submaps[archive.pairs[number]!.target]!;
  const source = archive.result.submaps[archive.pairs[number]!.source]!;
  if (pair.verdict === "unverified") return undecided(pair);
  if (pair.verdict === "consistent") return "Nothing to mend here at the tolerance asked for.";
  const both = `${scans(target)} and ${scans(source)}`;
  if (correctionOpen(pair)) {
    const next = othersAreBelieved(archive, number) ? "Mend the others around it first, then check again." : "Look at both clouds and judge.";
    return `${both} do not fit as the map has them; what would mend it is not known, and constraints.g2o has no link here. ${next}`;
  }
  const rest = byKind(pair, target, source, both);
  if (!moveIsNoCure(pair)) return rest;
  const small = pair.offset_m !== null && pair.offset_m <= Number(archive.result.config["tolerance"]);
  return small ? bendFirst(pair, target, source) : `${bendFirst(pair, target, source)} ${rest}`;
}

function byKind(pair: Pair, target: Submap, source: Submap, both: string): string {
  switch (pair.kind) {
    case "sequential":
      return `The poses of ${both} do not fit each other: look at the odometry there and, where many pairs of ${source.robot} say so, at its sensor's mounting and time stamps.`;
    case "local":
      return `${source.robot} came back and put this place elsewhere: a link between ${both} is missing or wrong, or its way there is bent.`;
    case "global":
      return `The maps of ${target.robot} and ${source.robot} do not fit here: add the link from constraints.g2o, or look for a wrong one, between ${both}.`;
  }
}
