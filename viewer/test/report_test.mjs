// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node report_test.mjs REPORT.html HOSTILE.html FLEET.html CLOUDS.html ALONE.html FOLDER: uses a report as a person would,
// one whose robots have hostile names, one of many robots, one of finished clouds in world coordinates and one without
// any pair. Prints a line of JSON per test; screenshots go to FOLDER. tests/viewer_test.py runs it.
import assert from "node:assert/strict";
import { join } from "node:path";
import { launch, open } from "./browser.mjs";
import { frame, painted, tester } from "./harness.mjs";

const [report, hostile, fleet, clouds, alone, folder] = process.argv.slice(2);
const browser = await launch();
const test = tester(browser, report, folder);

const selected = (page) => page.evaluate(() => window.kilter.state.selected);

/** What every view says is selected. */
async function everywhere(page, pair) {
  await frame(page);
  const seen = await page.evaluate(() => {
    const state = window.kilter.state;
    return {
      state: state.selected,
      names: [state.pairs[state.selected].target, state.pairs[state.selected].source],
      fragment: decodeURIComponent(location.hash),
      title: document.querySelector("#pair h2").textContent,
      rows: [...document.querySelectorAll("#table tr.selected")].map((row) => Number(row.dataset.pair)),
      details: document.querySelector("#details").textContent,
      reason: state.pairs[state.selected].reason,
    };
  });
  assert.equal(seen.state, pair);
  const [target, source] = seen.names;
  assert.equal(seen.fragment, `#pair=${source},${target}`);
  assert.ok(seen.title.includes(target) && seen.title.includes(source), seen.title);
  assert.deepEqual(seen.rows, [pair]);
  assert.ok(seen.details.includes(seen.reason));
}

const pairs = (page) => page.evaluate(() => window.kilter.state.pairs.map((pair, n) => ({ n, verdict: pair.verdict, kind: pair.kind, offset: pair.offset_m, registered: pair.T_target_source_registered !== null })));

await test("opens from disk and shows the verdict and the worst place without scrolling", {}, async (page) => {
  const seen = await page.evaluate(() => {
    const inside = (selector) => {
      const box = document.querySelector(selector).getBoundingClientRect();
      return box.width > 100 && box.top >= 0 && box.bottom <= innerHeight + 1 && box.right <= innerWidth + 1;
    };
    return {
      word: document.querySelector("#verdict h1").textContent,
      verdict: window.kilter.state.archive.result.system.verdict,
      inside: ["#verdict", ".place.selected", "#map .pane", "#pair .pane"].map(inside),
      card: document.querySelector(".place.selected").textContent,
      policy: document.querySelector("meta[http-equiv]").content,
    };
  });
  assert.equal(seen.word.toLowerCase(), seen.verdict);
  assert.deepEqual(seen.inside, [true, true, true, true]);
  assert.match(seen.card, /cm/);
  assert.match(seen.policy, /default-src 'none'; script-src 'sha256-[^']+'; style-src 'sha256-[^']+';/);
  await page.screenshot({ path: join(folder, "wide.png") });
});

await test("draws points, lines and matrices", {}, async (page) => {
  for (const canvas of ["#map .points", "#pair .points", "#map .overlay", "#pair .overlay"]) {
    assert.ok((await painted(page, canvas)).share > 0.002, canvas);
  }
  for (let i = 1; i <= 3; i++) {
    assert.ok((await painted(page, `#matrices figure:nth-child(${i}) canvas`)).colours > 5, `matrix ${i}`);
  }
  assert.ok((await painted(page, ".chart canvas")).colours > 5);
});

await test("a cell of each matrix selects its pair everywhere", {}, async (page) => {
  const all = await pairs(page);
  for (let m = 0; m < 3; m++) {
    const pair = all[(m * 7 + 3) % all.length].n;
    const at = await page.evaluate(([m, pair]) => window.kilter.matrices.all[m].cellOf(pair), [m, pair]);
    await page.locator("#matrices canvas").nth(m).click({ position: at });
    await everywhere(page, pair);
  }
});

await test("a line of the map selects its pair everywhere", {}, async (page) => {
  const target = await page.evaluate(() => {
    const { map, state } = window.kilter;
    for (let n = 0; n < state.pairs.length; n++) {
      const at = map.middleOf(n);
      if (n !== state.selected && map.pick(at.x, at.y) === n) return { n, at };
    }
    return null;
  });
  assert.ok(target, "no line can be hit");
  await page.locator("#map .overlay").click({ position: target.at });
  await everywhere(page, target.n);
});

await test("a card tells an offset only where a registration is believed", {}, async (page) => {
  const cards = await page.evaluate(() =>
    [...document.querySelectorAll(".place")].map((card) => {
      const pair = window.kilter.state.pairs[Number(card.dataset.pair)];
      const witness = ["conflict", "support", "agreeing"].some((name) => (pair.evidence[name]?.log_ratio ?? null) !== null);
      return { head: card.querySelector("b").textContent, believed: pair.p_value !== null || pair.verdict === "consistent", witness };
    }),
  );
  assert.ok(cards.length > 0);
  for (const { head, believed, witness } of cards) assert.equal(head.endsWith(" apart"), believed && !witness, head);
  const order = cards.map((card) => Number(card.believed && !card.witness));
  if (cards.length < 6) assert.deepEqual(order, [...order].sort().reverse(), "those that are believed come first");
});

await test("a row and a place select their pair everywhere", {}, async (page) => {
  const row = page.locator("#table tbody tr").nth(2);
  const number = Number(await row.getAttribute("data-pair"));
  await row.click();
  await everywhere(page, number);
  const place = page.locator(".place").last();
  const pair = Number(await place.getAttribute("data-pair"));
  await place.click();
  await everywhere(page, pair);
  assert.ok(await place.evaluate((node) => node.classList.contains("selected")));
});

await test("hovering a cell shows its numbers", {}, async (page) => {
  const at = await page.evaluate(() => window.kilter.matrices.all[0].cellOf(0));
  await page.locator("#matrices canvas").first().hover({ position: at });
  const tip = page.locator("#tip");
  assert.ok(await tip.isVisible());
  const names = await page.evaluate(() => [window.kilter.state.pairs[0].target, window.kilter.state.pairs[0].source]);
  for (const text of [...names, "Γ", "Θ", "offset", "overlap"]) assert.ok((await tip.textContent()).includes(text), text);
});

await test("the slider moves the source's points to where registration puts them", {}, async (page) => {
  const read = () => page.evaluate(() => window.kilter.pair.sourcePoint(10));
  const set = async (value) => page.locator("#slider").evaluate((node, value) => {
    node.value = value;
    node.dispatchEvent(new Event("input"));
  }, String(value));
  const start = await read();
  await set(0.5);
  const half = await read();
  await set(1);
  const end = await read();
  const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
  const offset = await page.evaluate(() => window.kilter.state.pairs[window.kilter.state.selected].offset_m);
  assert.ok(distance(start, end) > 0.5 * offset && distance(start, end) < 2 * offset + 0.5, `${distance(start, end)} m for ${offset} m`);
  assert.ok(distance(start, half) > 0.3 * distance(start, end) && distance(half, end) > 0.3 * distance(start, end));
  const before = (await painted(page, "#pair .points")).hash;
  await page.keyboard.press("m");
  assert.deepEqual(await read(), start);
  assert.notEqual((await painted(page, "#pair .points")).hash, before);
  await page.keyboard.press("r");
  assert.deepEqual(await read(), end);
});

await test("colours and slices change what is drawn", {}, async (page) => {
  const seen = new Set();
  for (const key of ["1", "2", "3"]) {
    await page.keyboard.press(key);
    seen.add((await painted(page, "#map .points")).hash);
    await page.locator("#map").screenshot({ path: join(folder, `map-${key}.png`) });
  }
  assert.equal(seen.size, 3);
  const slice = (await painted(page, "#map .points")).hash;
  await page.locator("#map button", { hasText: "everything" }).click();
  assert.notEqual((await painted(page, "#map .points")).hash, slice);
  const modes = new Set();
  for (const value of ["submap", "distance", "conflict"]) {
    await page.locator(`#pair button[data-value="${value}"]`).click();
    modes.add((await painted(page, "#pair .points")).hash);
    await page.locator("#pair").screenshot({ path: join(folder, `pair-${value}.png`) });
  }
  assert.equal(modes.size, 3);
  await page.locator("#map button", { hasText: "side" }).click();
  await page.waitForTimeout(300);
  await page.locator("#map").screenshot({ path: join(folder, "map-side.png") });
  const lines = (await painted(page, "#map .overlay")).hash;
  await page.locator("#map .edge.inconsistent input").click();
  assert.notEqual((await painted(page, "#map .overlay")).hash, lines);
});

await test("the table filters and sorts", {}, async (page) => {
  const all = await pairs(page);
  const rows = () => page.evaluate(() => window.kilter.table.rows);
  const texts = (column) => page.locator(`#table td.c-${column}`).allTextContents();
  await page.selectOption("#filter-verdict", "inconsistent");
  assert.equal((await rows()).length, all.filter((pair) => pair.verdict === "inconsistent").length);
  assert.deepEqual(new Set(await texts("verdict")), new Set(["inconsistent"]));
  await page.selectOption("#filter-kind", "global");
  assert.equal((await rows()).length, all.filter((pair) => pair.verdict === "inconsistent" && pair.kind === "global").length);
  await page.selectOption("#filter-verdict", "");
  await page.selectOption("#filter-kind", "");
  await page.fill("#filter-offset", "10");
  assert.equal((await rows()).length, all.filter((pair) => pair.offset !== null && pair.offset >= 0.1).length);
  await page.fill("#filter-offset", "");
  const robot = await page.evaluate(() => window.kilter.state.archive.result.robots[0].name);
  await page.selectOption("#filter-robot", robot);
  assert.ok((await rows()).length < all.length);
  await page.selectOption("#filter-robot", "");
  await page.fill("#filter-text", "no such thing");
  assert.equal((await rows()).length, 0);
  await page.fill("#filter-text", "");
  const header = page.locator('#table th[data-column="offset"]');
  for (const sign of [-1, 1]) {
    await header.locator("button").click();
    const offsets = (await rows()).map((n) => all[n].offset).filter((offset) => offset !== null);
    for (let i = 1; i < offsets.length; i++) assert.ok(sign * (offsets[i] - offsets[i - 1]) >= 0);
    assert.equal(await header.getAttribute("aria-sort"), sign > 0 ? "ascending" : "descending");
  }
});

await test("a pair whose correction is open is not told how to mend it", {}, async (page) => {
  const said = await page.evaluate(() => {
    const { state } = window.kilter;
    const witnesses = (pair) => ["conflict", "support", "agreeing"].filter((name) => (pair.evidence[name]?.log_ratio ?? null) !== null);
    const number = state.pairs.findIndex((pair) => pair.verdict === "inconsistent" && witnesses(pair).length === 0);
    const other = number === 0 ? 1 : 0;
    const words = () => {
      state.select(other);
      state.select(number);
      return document.querySelector("#details").textContent;
    };
    const { evidence } = state.pairs[number];
    const decided = words();
    evidence.support = { value: 10, null: 900, log_ratio: 4 };
    return { decided, open: words(), source: state.pairs[number].source };
  });
  assert.match(said.decided, new RegExp(`move ${said.source} `));
  assert.doesNotMatch(said.open, new RegExp(`move ${said.source} `));
  assert.match(said.open, /constraints\.g2o has no link here/);
});

await test("a permalink opens its pair", { hash: "" }, async (page) => {
  const link = await page.evaluate(() => {
    const { state } = window.kilter;
    state.select(state.pairs.length - 1);
    return { hash: location.hash, pair: state.selected };
  });
  const again = await open(browser, report, { hash: link.hash });
  assert.equal(await selected(again.page), link.pair);
  await everywhere(again.page, link.pair);
  await again.page.evaluate(() => (location.hash = ""));
  const other = await page.evaluate(() => {
    const pair = window.kilter.state.pairs[0];
    return `#pair=${pair.source},${pair.target}`;
  });
  await again.page.evaluate((hash) => (location.hash = hash), other);
  await again.page.waitForFunction(() => window.kilter.state.selected === 0);
  await again.context.close();
});

await test("keys go through pairs and places, help and theme", {}, async (page) => {
  const rows = await page.evaluate(() => window.kilter.table.rows);
  await page.evaluate((n) => window.kilter.state.select(n), rows[0]);
  await page.keyboard.press("j");
  assert.equal(await selected(page), rows[1]);
  await page.keyboard.press("ArrowDown");
  assert.equal(await selected(page), rows[2]);
  await page.keyboard.press("k");
  await page.keyboard.press("ArrowUp");
  assert.equal(await selected(page), rows[0]);
  await page.keyboard.press("n");
  assert.ok((await selected(page)) >= 0);
  await page.keyboard.press("?");
  assert.ok(await page.locator("#help").isVisible());
  await page.keyboard.press("Escape");
  assert.ok(!(await page.locator("#help").isVisible()));
  await page.keyboard.press("Escape");
  assert.equal(await selected(page), -1);
  assert.equal(await page.evaluate(() => location.hash), "");
  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await paper();
  await page.keyboard.press("d");
  assert.notEqual(await paper(), light);
  await page.locator("#theme").click();
  assert.equal(await paper(), light);
});

await test("dark, small and printed it still fits", { dark: true, width: 800, height: 600 }, async (page) => {
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await page.screenshot({ path: join(folder, "small-dark.png") });
  await page.setViewportSize({ width: 1440, height: 900 });
  await page.waitForTimeout(300);
  await page.screenshot({ path: join(folder, "wide-dark-whole.png"), fullPage: true });
  await page.setViewportSize({ width: 390, height: 800 });
  await page.waitForTimeout(500);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await page.emulateMedia({ media: "print" });
  assert.ok(!(await page.locator(".slider").isVisible()));
  await page.emulateMedia({ media: null });
  await page.setViewportSize({ width: 1440, height: 900 });
  await page.waitForTimeout(500);
  await page.pdf({ path: join(folder, "printed.pdf"), format: "A4", printBackground: true });
});

await test("hostile names are only names", { file: hostile }, async (page) => {
  const names = await page.evaluate(() => window.kilter.state.archive.result.robots.map((robot) => robot.name));
  assert.ok(names.some((name) => name.includes("<img src=x onerror=alert(1)>")), names.join());
  assert.equal(await page.locator("img, svg, iframe").count(), 0);
  for (let m = 0; m < 3; m++) {
    const at = await page.evaluate((m) => window.kilter.matrices.all[m].cellOf(0), m);
    await page.locator("#matrices canvas").nth(m).click({ position: at });
  }
  await page.keyboard.press("j");
  assert.equal(await page.locator("img, svg, iframe").count(), 0);
  const link = await page.evaluate(() => location.hash);
  const again = await open(browser, hostile, { hash: link });
  assert.equal(await selected(again.page), await selected(page));
  await again.context.close();
  await page.screenshot({ path: join(folder, "hostile.png") });
});

await test("many robots leave the verdict short", { file: fleet, width: 1366, height: 768 }, async (page) => {
  const seen = await page.evaluate(() => ({
    height: document.querySelector("#verdict").getBoundingClientRect().height,
    words: document.querySelector("#verdict .quiet").textContent,
    robots: window.kilter.state.archive.result.robots.length,
    meetings: Object.keys(window.kilter.state.archive.result.system.decided.global).length,
  }));
  assert.ok(seen.words.includes(`${seen.robots} robots, `), seen.words);
  assert.ok(seen.words.includes(`two robots, ${seen.meetings} times, `), seen.words);
  assert.ok(seen.height < 0.2 * 768, `${seen.height} px`);
  await page.screenshot({ path: join(folder, "fleet.png") });
});

await test("finished clouds are seen wherever the world's origin is", { file: clouds }, async (page) => {
  for (const canvas of ["#map .points", "#pair .points"]) {
    assert.ok((await painted(page, canvas)).share > 0.004, canvas);
    const button = page.locator(`${canvas.split(" ")[0]} button`, { hasText: "everything" });
    await button.click();
    assert.ok((await painted(page, canvas)).share > 0.004, `all of ${canvas}`);
  }
  // The lines run between the clouds, where they can be clicked.
  const seen = await page.evaluate(() => {
    const { map, state } = window.kilter;
    const { clientWidth, clientHeight } = map.pane.overlay;
    return state.pairs.map((_, n) => map.middleOf(n)).filter(({ x, y }) => x > 0 && y > 0 && x < clientWidth && y < clientHeight);
  });
  assert.ok(seen.length > 0 && new Set(seen.map(({ x, y }) => `${Math.round(x)},${Math.round(y)}`)).size > 1);
  await page.screenshot({ path: join(folder, "clouds.png") });
});

/** Changes the selected pair, then selects it anew. */
const changed = (page, change) =>
  page.evaluate((change) => {
    const { state } = window.kilter;
    const number = state.selected;
    new Function("pair", change)(state.pairs[number]);
    state.select(-1);
    state.select(number);
  }, change);

await test("the table starts as the places do", {}, async (page) => {
  const seen = await page.evaluate(() => {
    const { state, table } = window.kilter;
    const places = [...document.querySelectorAll(".place")].map((card) => Number(card.dataset.pair));
    return { places, rows: table.rows, verdicts: table.rows.map((n) => state.pairs[n].verdict) };
  });
  assert.equal(seen.rows[0], seen.places[0]);
  const order = seen.rows.filter((n) => seen.places.includes(n));
  assert.deepEqual(order, seen.places);
  assert.deepEqual(seen.verdicts, [...seen.verdicts].sort((a, b) => ["inconsistent", "unverified", "consistent"].indexOf(a) - ["inconsistent", "unverified", "consistent"].indexOf(b)));
});

await test("an offset that is not believed is called that everywhere", {}, async (page) => {
  await changed(page, "pair.evidence.support = { value: 10, null: 900, log_ratio: 4 }");
  assert.match(await page.locator("#details").textContent(), /registration ended \d+ cm off, not believed/);
  assert.match(await page.locator('[data-evidence="displacement"]').textContent(), /not believed$/);
  const at = await page.evaluate(() => window.kilter.matrices.all[0].cellOf(window.kilter.state.selected));
  await page.locator("#matrices canvas").first().hover({ position: at });
  assert.match(await page.locator("#tip").textContent(), /ended \d+ cm off, not believed/);
  await page.locator('#table th[data-column="offset"] button').click();
  assert.match(await page.locator("#table tr.selected td.c-offset").textContent(), /cm\?$/);
});

await test("without a registered pose nothing slides", {}, async (page) => {
  await changed(page, "pair.T_target_source_registered = null");
  assert.deepEqual(await page.locator(".slider button, .slider input").evaluateAll((all) => all.map((one) => one.disabled)), [true, true, true, true]);
  assert.match(await page.locator("#pair").textContent(), /no registered pose/);
  for (const key of ["r", "p"]) await page.keyboard.press(key);
  await page.waitForTimeout(200);
  assert.equal(await page.evaluate(() => window.kilter.pair.alpha), 0);
});

await test("what is played ends where the user takes over", {}, async (page) => {
  const alpha = () => page.evaluate(() => window.kilter.pair.alpha);
  await page.keyboard.press("p");
  await page.waitForFunction(() => window.kilter.pair.alpha > 0);
  await page.keyboard.press("m");
  await page.waitForTimeout(400);
  assert.equal(await alpha(), 0);
  await page.keyboard.press("p");
  await page.waitForFunction(() => window.kilter.pair.alpha > 0);
  await page.locator("#slider").evaluate((node) => {
    node.value = "0.75";
    node.dispatchEvent(new Event("input"));
  });
  await page.waitForTimeout(400);
  assert.equal(await alpha(), 0.75);
});

await test("what was not measured is not counted", {}, async (page) => {
  await changed(page, "delete pair.evidence.conflict; pair.evidence.agreeing = { value: 0, null: 0, log_ratio: null }");
  await page.locator('#pair button[data-value="conflict"]').click();
  assert.match(await page.locator("#pair").textContent(), /not measured: these clouds carry no free space/);
  assert.match(await page.locator('[data-evidence="agreeing"]').textContent(), /no other pair around/);
  await changed(page, "for (const other of window.kilter.state.pairs) if (other !== pair) other.T_target_source_registered = null");
  assert.match(await page.locator('[data-evidence="log10_gamma"]').textContent(), /^Γ, as a power of ten[-\d.]+nothing to compare with$/);
  await changed(page, "pair.evidence.agreeing = { value: 3, null: 3, log_ratio: null }");
  assert.match(await page.locator('[data-evidence="agreeing"]').textContent(), /divided/);
  await page.evaluate(() => {
    window.kilter.state.archive.result.config.tolerance = 0.005;
    window.kilter.map.chooseColours("misalignment");
  });
  assert.match(await page.locator("#map").textContent(), /off by 0\.05 cm5\.0 cm or more/);
});

await test("keys do what is in front", {}, async (page) => {
  const start = await selected(page);
  await page.locator("#slider").focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowUp");
  assert.equal(await selected(page), start);
  assert.ok((await page.evaluate(() => window.kilter.pair.alpha)) > 0.01);
  await page.locator("#slider").evaluate((node) => node.blur());
  await page.keyboard.press("?");
  for (const key of ["j", "n", "d", "r"]) await page.keyboard.press(key);
  assert.equal(await selected(page), start);
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), undefined);
  await page.keyboard.press("Escape");
  assert.equal(await selected(page), start);
  await page.fill("#filter-text", "no such thing");
  await page.locator("#filter-text").evaluate((node) => node.blur());
  await page.keyboard.press("j");
  assert.equal(await selected(page), start);
});

await test("an address of another report leads to the worst place, and says so", { hash: "#pair=zz/1,a/1" }, async (page) => {
  const worst = Number(await page.locator(".place").first().getAttribute("data-pair"));
  assert.equal(await selected(page), worst);
  assert.match(await page.locator("#verdict").textContent(), /not in this report \(zz\/1,a\/1\)\. The worst/);
  await page.keyboard.press("j");
  assert.equal(await page.locator(".stray").count(), 0);
});

await test("it can be read: contrast, and names that are long", { dark: true, width: 390, height: 800 }, async (page) => {
  const contrasts = await page.evaluate(() => {
    const bright = (colour) => {
      const [r, g, b] = colour.match(/[\d.]+/g).map((part) => (part / 255 <= 0.03928 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    return ["inconsistent", "unverified", "consistent"].map((verdict) => {
      const rank = document.querySelector(".place .rank");
      rank.className = `rank ${verdict}`;
      const { color, backgroundColor } = getComputedStyle(rank);
      const [low, high] = [bright(color), bright(backgroundColor)].sort((a, b) => a - b);
      return (high + 0.05) / (low + 0.05);
    });
  });
  for (const contrast of contrasts) assert.ok(contrast >= 4.5, contrasts.join());
  await page.evaluate(() => (document.querySelector("#filter-robot option:last-child").textContent = "long ".repeat(30)));
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
});

await test("paper holds every row, or says how many", { file: fleet }, async (page) => {
  const rows = () => page.locator("#table tbody tr").count();
  const [before, all] = [await rows(), await page.evaluate(() => window.kilter.table.rows.length)];
  assert.ok(before < all, `${before} of ${all}`);
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.equal(await rows(), all);
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  assert.equal(await rows(), before);
  await page.selectOption("#filter-kind", "local");
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.match(await page.locator(".on-paper").textContent(), /^\d+ of \d+ pairs: local$/);
});

await test("numbers sort as numbers whatever is missing", {}, async (page) => {
  const header = page.locator('#table th[data-column="gamma"]');
  await page.evaluate(() => (window.kilter.state.pairs[0].gamma = null));
  await header.locator("button").click();
  assert.equal(await header.getAttribute("aria-sort"), "descending");
});

await test("without any pair the page stands", { file: alone }, async (page) => {
  assert.equal(await page.evaluate(() => window.kilter.state.pairs.length), 0);
  for (const header of await page.locator("#table th button").all()) await header.click();
  for (const key of ["j", "k", "n", "m", "r", "p", "3", "Escape"]) await page.keyboard.press(key);
  assert.match(await page.locator("#verdict").textContent(), /\(1 piece, /);
  await page.screenshot({ path: join(folder, "alone.png"), fullPage: true });
});

await browser.close();
