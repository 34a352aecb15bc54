// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node words_test.mjs: what the report says of made-up pairs, and that it has an answer to every reason that the program
// can give. Prints a line of JSON per test; tests/viewer_test.py runs it.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { modules, root } from "./bundle.mjs";

const { action, bentInside, commonBeginning, correctionOpen, cure, frameInWords, isUsualAlone, meetingsInWords, parts, partsOfName, shift, shortened, State, toMend, wouldFit } = await modules("advice", "names", "state", "verdict", "words");

function test(name, body) {
  let error = null;
  try {
    body();
  } catch (caught) {
    error = String(caught.stack ?? caught);
  }
  console.log(JSON.stringify({ name, ok: error === null, error }));
}

const submap = (id, at, scan = 0) => ({
  id,
  robot: id.split("/")[0],
  index: Number(id.split("/")[1]),
  first_scan: scan,
  last_scan: scan === null ? null : scan + 9,
  T_world_submap: [...at, 0, 0, 0, 1],
  occupied: 1,
});

/** Robot a goes along x and turns to y in its last submap; b is one finished cloud. */
function archive(pair = {}, source = 1, more = []) {
  const submaps = [submap("a/1", [0, 0, 0]), submap("a/2", [10, 0, 0], 10), submap("b/1", [3, 0, 0], null)];
  const bad = {
    target: "a/1",
    source: submaps[source].id,
    kind: "sequential",
    verdict: "inconsistent",
    reason: "offset 147.0 cm (140.0 to 150.0 cm): above the tolerance of 10.0 cm",
    evidence: {},
    offset_m: 1.47,
    offset_vector: [-1.2, 0.85, 0],
    p_value: 1e-6,
    unobservable: [],
    ...pair,
  };
  return {
    result: { config: { tolerance: 0.1 }, robots: [{ name: "a" }, { name: "b" }], submaps, pairs: [bad, ...more] },
    paths: [Float64Array.from([0, 0, 0, 10, 0, 0, 10, 8, 0]), Float64Array.from([3, 0, 0])],
    pairs: [{ source, target: 0 }, ...more.map(() => ({ source: 2, target: 0 }))],
  };
}

test("a way that ends after a turn is followed to its end", () => {
  const given = parts(archive(), 0);
  assert.ok(Math.abs(given.along - 0.85) < 1e-9 && Math.abs(given.across - 1.2) < 1e-9, JSON.stringify(given));
  assert.equal(shift(given), "85 cm ahead, 120 cm to the left");
});

test("a way that turns by much has no heading", () => {
  const bend = (points, scans = points.length) => {
    const made = archive();
    made.result.robots[0].scans = scans;
    Object.assign(made.result.submaps[1], { first_scan: 1, last_scan: scans - 1 });
    made.paths[0] = Float64Array.from([[0, 0, 0], ...points.slice(1)].flat());
    return shift(parts(made, 0));
  };
  const robot = "85 cm ahead, 120 cm to the left";
  const world = "x-120 y+85 cm in world axes";
  const along = (metres) => Array.from({ length: metres + 1 }, (_, i) => [10, i, 0]);
  assert.equal(bend([[0, 0, 0], ...along(8)]), robot);
  // Eight metres along y, then as many along x: the chord is nobody's heading.
  assert.equal(bend([[0, 0, 0], ...along(8), ...Array.from({ length: 8 }, (_, i) => [11 + i, 8, 0])]), world);
  // To and fro ends a little further.
  assert.equal(bend([[0, 0, 0], ...along(8), ...along(7).reverse().slice(0, 6)]), world);
  // Jitter makes no way longer.
  assert.equal(bend([[0, 0, 0], ...along(80).map(([, i]) => [10 + 0.04 * (i % 2), i / 10, 0])]), robot);
  // Every second scan of the path, and the last.
  assert.equal(bend([[0, 0, 0], ...along(8)], 18), robot);
});

test("without a way the world's axes tell the direction", () => {
  assert.equal(shift(parts(archive({}, 2), 0)), "x-120 y+85 cm in world axes");
  const still = archive();
  still.paths[0] = Float64Array.from([0, 0, 0, 10, 0.05, 0]);
  assert.equal(shift(parts(still, 0)), "x-120 y+85 cm in world axes");
  assert.equal(shift({ x: 0.052, y: 0, z: -0.03 }), "x+5.2 z-3.0 cm in world axes");
});

test("what open directions and bends leave is no cure", () => {
  assert.deepEqual(cure(archive(), 0), { moved: "85 cm ahead, 120 cm to the left", turned: "", best: false, open: "" });
  assert.match(cure(archive({ unobservable: [[1, 0, 0, 0, 0, 0]] }), 0).open, /along the dashed axis nothing is known/);
  const reason = "offset 147.0 cm (140.0 to 150.0 cm): above the tolerance of 10.0 cm; no rigid motion mends all of it, the source is bent, or slipped inside";
  const bent = archive({ reason, evidence: { bend_m: { value: 0.2, null: null, log_ratio: null } } });
  assert.ok(cure(bent, 0).best && bentInside(bent.result.pairs[0], 0.1));
  assert.match(action(bent, 0), /a\/2 is bent.*stamps, de-skewing.*first\. The poses of/);
  const only = archive({ offset_m: 0.05, reason: "offset 5.0 cm (4.0 to 6.0 cm), but with it parts of the overlap lie 20.0 cm apart (RMS), above the tolerance of 10.0 cm: the target is bent, or slipped inside" });
  assert.match(action(only, 0), /a\/1 is bent.*first\.$/);
  assert.doesNotMatch(action(archive(), 0), /bent or slipped/);
});

/** A pose that turns about an axis by so many degrees, at the origin. */
function about([x, y, z], degrees) {
  const half = (degrees * Math.PI) / 360;
  return [0, 0, 0, x * Math.sin(half), y * Math.sin(half), z * Math.sin(half), Math.cos(half)];
}

const still = about([0, 0, 1], 0);

test("where a shift alone leaves too much, the turn is told", () => {
  const turns = (axis, degrees, more = {}) =>
    archive({ T_target_source: still, T_target_source_registered: about(axis, degrees), offset_m: 1.6, offset_vector: [0, 1.5, 0], ...more });
  const left = cure(turns([0, 0, 1], 2.4), 0);
  assert.equal(wouldFit("a/2", left), "a/2 would fit if moved 150 cm ahead, and turned 2.4 degrees to the left about the middle of what both saw");
  assert.equal(toMend("a/$&", left), "move a/$& 150 cm ahead, and turn it 2.4 degrees to the left about the middle of what both saw");
  assert.equal(cure(turns([0, 0, 1], -0.44), 0).turned, "turned 0.44 degrees to the right");
  // What is left is as large as the tolerance: the shift does.
  assert.equal(cure(turns([0, 0, 1], 2.4, { offset_m: Math.hypot(1.5, 0.0999) }), 0).turned, "");
  assert.notEqual(cure(turns([0, 0, 1], 2.4, { offset_m: Math.hypot(1.5, 0.1001) }), 0).turned, "");
  // Only what registration adds counts, and the other of two quaternions is the same pose.
  const more = turns([0, 0, 1], 92.4, { T_target_source: about([0, 0, 1], 90) });
  assert.equal(cure(more, 0).turned, "turned 2.4 degrees to the left");
  const pair = more.result.pairs[0];
  pair.T_target_source_registered = pair.T_target_source_registered.map((number) => -number);
  assert.equal(cure(more, 0).turned, "turned 2.4 degrees to the left");
});

test("a turn without a shift is a cure, and without a registered pose there is none", () => {
  const only = archive({ T_target_source: still, T_target_source_registered: about([0, 0, 1], 3), offset_m: 0.4, offset_vector: [0, 0, 0] });
  assert.equal(wouldFit("a/2", cure(only, 0)), "a/2 would fit if turned 3.0 degrees to the left about the middle of what both saw");
  assert.equal(toMend("a/2", cure(only, 0)), "turn a/2 3.0 degrees to the left about the middle of what both saw");
  only.result.pairs[0].T_target_source_registered = null;
  assert.equal(cure(only, 0), null);
});

test("a turn is told in the world, whatever the target's axes: a tilt by the robot's way", () => {
  const tilts = (axis, source = 1) => {
    const made = archive({ T_target_source: still, T_target_source_registered: about(axis, 3), offset_m: 0.4, offset_vector: [0, 0, 0] }, source);
    return cure(made, 0).turned;
  };
  // The way goes along y: x lies to the right.
  assert.equal(tilts([1, 0, 0]), "tilted by 3.0 degrees, front up");
  assert.equal(tilts([-1, 0, 0]), "tilted by 3.0 degrees, front down");
  assert.equal(tilts([0, 1, 0]), "tilted by 3.0 degrees, left side up");
  assert.equal(tilts([0, 1, 0], 2), "tilted by 3.0 degrees, its side towards x+ down");
  assert.equal(tilts([1, 0, 0], 2), "tilted by 3.0 degrees, its side towards y+ up");
  const upside = archive({ T_target_source: still, T_target_source_registered: about([0, 0, 1], 3), offset_m: 0.4, offset_vector: [0, 0, 0] });
  upside.result.submaps[0].T_world_submap = about([1, 0, 0], 180);
  assert.equal(cure(upside, 0).turned, "turned 3.0 degrees to the right");
});

test("others are to be mended first only where there are others", () => {
  const open = { evidence: { support: { value: 1, null: 90, log_ratio: 4 } } };
  assert.ok(correctionOpen(archive(open).result.pairs[0]));
  assert.equal(cure(archive(open), 0), null);
  assert.doesNotMatch(action(archive(open), 0), /others/);
  const other = { ...archive().result.pairs[0], source: "b/1" };
  assert.match(action(archive(open, 1, [other]), 0), /Mend the others around it first/);
});

test("a name that does not fit keeps what tells it from others", () => {
  const robots = ["warehouse_north_alpha", "warehouse_north_beta"];
  const common = commonBeginning(robots);
  assert.equal(common, "warehouse_north_");
  assert.deepEqual(robots.map((name) => shortened(name, common, 8)), ["~alpha", "~beta"]);
  assert.equal(shortened(`${robots[0]}/12`, common), "~alpha/12");
  assert.deepEqual(partsOfName(`${robots[1]}/3`, robots[1], common), [common, "beta", "/3"]);
  // Still too long: of the rest both ends are kept. What fits stays as it is.
  assert.equal(shortened(`${common}in the very cold hall/12`, common), "~in the~all/12");
  assert.equal(shortened("carrier/3", "c"), "carrier/3");
  // One name that begins another is not cut to nothing, and one alone has nothing in common.
  assert.equal(commonBeginning(["robot", "robot2"]), "robo");
  assert.equal(commonBeginning(["robot"]), "");
  assert.equal(commonBeginning([]), "");
  assert.equal(commonBeginning(["a", "b"]), "");
});

test("a name is cut between letters, never inside one", () => {
  const robots = ["\u{1F600}\u{1F697}".repeat(9), "\u{1F600}\u{1F699}".repeat(9)];
  const common = commonBeginning(robots);
  assert.equal(common, "\u{1F600}");
  for (const most of [7, 8, 14, 15]) {
    for (const name of robots) assert.ok(shortened(name, common, most).isWellFormed?.() ?? true);
    assert.ok([...shortened(robots[0], common, most)].length <= most);
    assert.notEqual(shortened(robots[0], common, most), shortened(robots[1], common, most));
  }
});

test("an address names its pair however it was written down", () => {
  const pairs = [["a/1", "b/9"], ["a/1", "b,c/9"], ["50%2C/1", "b/9"], ["b/9", "a/12"], ["d, e/1", "f/2"]];
  const state = new State({ result: { robots: [], pairs: pairs.map(([target, source]) => ({ target, source })) } });
  const named = (fragment) => state.pairOfFragment(fragment);
  for (const same of ["#pair=b/9,a/1", "#pair=b%2F9%2Ca%2F1", "#pair=b%2f9,a/1", "#pair=b/9,%20a/1", "#pair=b/9, a/1", "#pair=a/1,b/9", "#pair=a%2F1%2C%20b%2F9", "#pair=b/9,a/1%20"]) {
    assert.equal(named(same), 0, same);
  }
  assert.equal(named("#pair=b%2Cc/9,a/1"), 1);
  assert.equal(named("#pair=b,c/9,a/1"), 1);
  assert.equal(named("#pair=b/9,50%252C/1"), 2);
  assert.equal(named("#pair=b/9,a/12"), 3);
  assert.equal(named("#pair=f/2, d, e/1"), 4);
  for (const stray of ["", "#", "#pair=", "#pair=b/9", "#pair=b/9,a/11", "#pair=%E0%A4%A,a/1", "#b/9,a/1"]) assert.equal(named(stray), -1, stray);
});

test("two robots are named whole, also where their names hold commas", () => {
  const words = meetingsInWords([{ name: "a" }, { name: "north, hall" }, { name: "south" }]);
  assert.deepEqual([...words], [["a,north, hall", "a with north, hall"], ["a,south", "a with south"], ["north, hall,south", "north, hall with south"]]);
});

test("one scan is one scan", () => {
  const one = archive();
  Object.assign(one.result.submaps[0], { first_scan: 4, last_scan: 4 });
  assert.match(action(one, 0), /The poses of scan 4 of a and scans 10 to 19 of a do not fit/);
});

test("a pair is not held against itself", () => {
  const registered = { T_target_source_registered: still };
  const failed = { T_target_source_registered: null };
  assert.ok(isUsualAlone([registered], registered));
  assert.ok(isUsualAlone([failed, registered], registered));
  assert.ok(!isUsualAlone([registered, { ...registered }], registered));
  assert.ok(!isUsualAlone([registered], failed));
});

const kOffset = "offset 48.2 cm (40.1 to 55.0 cm)";
// Reasons of pairs that are not decided, and what the report answers.
const kReasons = [
  ["too little overlap: 31 voxels of one match, 200 are needed", /saw too little in common/],
  ["too little overlap: 4 % of the voxels match, 10 % are needed", /saw too little in common/],
  ["too little overlap", /saw too little in common/],
  ["too little overlap: 4 % of the voxels match, 10 % are needed; moved by 1.2 m, within what odometry may have drifted, it would overlap 40 %", /if odometry drifted/],
  ["too little overlap: of 900 voxels that match, 3 show a side that both saw, and no free space speaks against the map: the places may differ", /from opposite sides/],
  ["registration failed: not tried", /could not be brought together/],
  ["registration failed: did not settle", /could not be brought together/],
  ["registration failed: nothing in the scene fixes the pose", /fixes no pose/],
  [`${kOffset}; of the 7 registrations around it that could tell, 5 ask for another correction: it may have settled in the wrong place`, /ended 48 cm off, but the pairs around it/],
  [`${kOffset}; it was found where a neighbour's correction would put it, and no registration around it confirms it`, /no other pair says the same/],
  [`${kOffset}; ambiguous: 2.5 m from there it fits 93 % as well`, /two places fit nearly as well/],
  [`${kOffset}; registration lost overlap (40 % to 20 %): the places may differ`, /share less than as mapped/],
  [`${kOffset}; after registration 9 % of what both saw still conflicts (typical of this map: 1 %): the places differ, or registration settled in the wrong place`, /contradict each other/],
  [`${kOffset}; after registration it agrees worse than other pairs of this map (log10 Theta 1.20, typically 3.10), and points alone cannot say why`, /agree worse than others/],
  [`${kOffset}, but what both saw conflicts more there: a similar place may be what fits`, /would fit 48 cm off, but there more stands/],
  [`${kOffset}, but the pair agrees no better there`, /agree no better there/],
  [`${kOffset}, but few voxels show a side that both saw, and no free space speaks against the map: the places may differ`, /from opposite sides/],
  [`${kOffset}: not told from the tolerance of 10.0 cm over the whole map`, /among so many pairs/],
  [`${kOffset}, 12.0 cm apart with what no rigid motion mends: not told from the tolerance of 10.0 cm over the whole map; its points are the centres of cells of 0.1 m, which leave 3.0 cm open (one sigma)`, /bent inside/],
  [`${kOffset}: below the tolerance of 10.0 cm, but with 0.5 of all pairs believed inconsistent before looking it is not told from that: 0.2 is left`, /prior_inconsistent/],
  [`${kOffset}, but a direction that nothing in the scene fixes could hide 30.0 cm`, /along the dashed axis/],
  [`${kOffset}: its points are the centres of cells of 0.4 m, which leave 9.0 cm open (one sigma), too much for the tolerance of 10.0 cm`, /cells are too coarse/],
  [`${kOffset}: too uncertain to be told from the tolerance of 10.0 cm; only 12 % show a side that both saw: the map's verdict does not wait for it`, /tells the offset no better/],
  ["Gamma is infinite: all distances are equal or zero, but registration does not verify it: it reaches infinity", /registration makes it no better/],
  ["registration failed: it ended where too few voxels match; Gamma is infinite: all distances are equal or zero", /could not be brought together/],
  ["Gamma has no scale of its own, and 1 registered pair is too few to compare it with (3 would do)", /here are too few/],
  ["log10 Gamma 1.20 is low for this map (from 2.00), but registration does not verify it: it reaches 1.30", /registration makes it no better/],
];

test("each reason for not deciding has its own advice", () => {
  for (const [reason, says] of kReasons) {
    const words = action(archive({ verdict: "unverified", p_value: null, reason, offset_m: 0.482 }), 0);
    assert.match(words, /^Not decided: /);
    assert.match(words, says, reason);
    const unmeasured = action(archive({ verdict: "unverified", p_value: null, reason, offset_m: null }), 0);
    assert.doesNotMatch(unmeasured, /@|  /);
  }
});

/** The string literals of a C++ source, neighbours joined, outside the tables of options. */
function literals(file) {
  const source = readFileSync(join(root, file), "utf8")
    .replace(/^ *\/\/.*$/gm, "")
    .replace(/^#include .*$/gm, "")
    .replace(/\nstd::vector<OptionField> fields[^]*?\n}\n/, "\n");
  return [...source.matchAll(/"(?:[^"\\]|\\.)*"(?:\s*"(?:[^"\\]|\\.)*")*/g)].map(([all]) => all.replace(/"\s*"/g, "").slice(1, -1));
}

test("every phrase that the program puts into such a reason is among them", () => {
  const escaped = (text) => text.replace(/[.*+?^$()|[\]\\]/g, "\\$&");
  const told = ["judge_pair.cc", "judge_notes.cc", "judge_by_gamma.cc"].flatMap((file) => literals(`src/kilter/verification/${file}`));
  const phrases = told.filter((text) => text.split(" ").length > 3);
  assert.ok(phrases.length > 20, String(phrases.length));
  // Of pairs that are decided all the same, or decided without registration.
  const decided = ["is {} this map (from {:.2f})", ", registered {}: verified", "Gamma is of the map's pose, and registration left it", "one of the two"];
  for (const phrase of phrases) {
    if (decided.some((known) => phrase.includes(known))) continue;
    const pattern = new RegExp(phrase.split(/\{[^}]*\}/).map(escaped).join(".*"));
    assert.ok(kReasons.some(([reason]) => pattern.test(reason)), phrase);
  }
});

test("a robot that lies off another as a whole is told with shift and turn", () => {
  const frame = { target: "a", source: "b", T_world_correction: [0, 0, 0, 0, 0, 0, 1], shift: [-0.09, 0.384, -0.001], agreeing: 41, witnesses: 42 };
  assert.match(frameInWords(frame), /^b lies off a as a whole: with its middle moved x-9 y\+38 z\+0 cm in world axes it would meet a in 41 of 42 pairs/);
  const turned = (x, z) => frameInWords({ ...frame, T_world_correction: [0, 0, 0, x, 0, z, Math.sqrt(1 - x * x - z * z)] });
  assert.match(turned(0, -0.01), /and all turned by 1\.1° to the right/);
  assert.match(turned(0, 0.01), /and all turned by 1\.1° to the left/);
  assert.match(turned(0.01, 0.002), /and all tilted by 1\.2°/);
});
