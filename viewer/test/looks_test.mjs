// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node looks_test.mjs LONG.html ALONE.html MANY.html FOLDER: what a report looks like where names are long, on paper,
// with other colours or without a graphics card; LONG has long names, ALONE no pair, MANY more than fit the table's
// window. Prints a line of JSON per test; screenshots go to FOLDER. tests/viewer_test.py runs it.
import assert from "node:assert/strict";
import { join } from "node:path";
import { launch, open } from "./browser.mjs";
import { frame, painted, tester } from "./harness.mjs";

const [report, alone, many, folder] = process.argv.slice(2);
const browser = await launch();
const test = tester(browser, report, folder);

await test("the table tells pairs apart whose robots' names are long", { width: 1600, height: 1000 }, async (page) => {
  const names = await page.locator("#table td.c-target, #table td.c-source").evaluateAll((cells) =>
    cells.map((cell) => {
      const [, own, piece] = cell.querySelectorAll(".name span");
      const whole = (part) => part.scrollWidth <= part.clientWidth + 1 || getComputedStyle(part).overflow === "visible";
      const inside = piece.getBoundingClientRect().right <= cell.getBoundingClientRect().right;
      return { text: cell.textContent, title: cell.title, seen: whole(own) && inside && `${own.textContent}${piece.textContent}` };
    }),
  );
  assert.ok(names.length > 0);
  for (const { text, title, seen } of names) {
    assert.equal(title, text);
    assert.match(seen, /^[ab]\/\d+$/, text);
  }
  await page.screenshot({ path: join(folder, "long.png"), fullPage: true });
});

for (const width of [1600, 400]) {
  await test(`the title of a pair shows source and verdict, ${width} pixels wide`, { width, height: 900 }, async (page) => {
    const seen = await page.locator("#pair h2").evaluate((title) => {
      const box = title.getBoundingClientRect();
      const parts = [...title.querySelectorAll(".swatch, .verdict")].map((part) => part.getBoundingClientRect());
      return {
        inside: parts.map((part) => part.width > 5 && part.right <= box.right + 1 && part.bottom <= box.bottom + 1),
        verdict: title.querySelector(".verdict").scrollWidth <= title.querySelector(".verdict").clientWidth,
        names: title.querySelector(".names").scrollHeight <= title.querySelector(".names").clientHeight + 1,
        page: document.documentElement.scrollWidth <= innerWidth,
      };
    });
    assert.deepEqual(seen, { inside: [true, true, true], verdict: true, names: true, page: true });
  });
}

await test("long names leave room for the table's other columns on paper", { width: 720, height: 1000 }, async (page) => {
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const [table, panel] = await page.evaluate(() => ["#table table", "#table"].map((what) => document.querySelector(what).scrollWidth));
  assert.ok(table <= panel, `${table} px in ${panel} px`);
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
});

await test("paper says which pose, colours and slice the pair's picture shows", {}, async (page) => {
  await page.emulateMedia({ media: "print" });
  const line = page.locator("#pair .as-drawn");
  assert.equal(await line.textContent(), "Drawn as in the map; coloured by submap; walls only.");
  assert.ok(await line.isVisible());
  assert.ok(!(await page.locator("#pair .hint").isVisible()));
  await page.keyboard.press("r");
  assert.match(await line.textContent(), /^Drawn after registration;/);
  await page.evaluate(() => {
    window.kilter.pair.set(0.4);
    document.querySelector('#pair button[data-value="distance"]').click();
    document.querySelector('#pair button[data-value="all"]').click();
  });
  assert.equal(await line.textContent(), "Drawn 40 % of the way from the map's pose to the registered one; coloured by the distance to the other submap; everything.");
  assert.match(await page.locator("#pair .legend").textContent(), /^dark: /);
  assert.ok(await page.locator("#pair .legend").isVisible());
  await page.emulateMedia({ media: null });
  assert.ok(!(await line.isVisible()));
});

await test("nothing is left to read of a pair that is no longer selected", {}, async (page) => {
  await page.locator('#pair button[data-value="conflict"]').click();
  assert.notEqual(await page.locator("#pair .legend").textContent(), "");
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#pair .legend").textContent(), "");
  assert.equal(await page.locator("#pair .as-drawn").textContent(), "");
});

await test("a hover draws lines anew, not all points of the map", {}, async (page) => {
  const frames = () => page.evaluate(() => window.kilter.map.pane.frames);
  const before = await painted(page, "#map .overlay");
  const drawn = await frames();
  for (const event of ["hover", "select"]) {
    await page.evaluate((event) => window.kilter.state[event](window.kilter.table.rows.at(event === "hover" ? -1 : -2)), event);
    assert.notEqual((await painted(page, "#map .overlay")).hash, before.hash);
    assert.equal(await frames(), drawn);
  }
  await page.evaluate(() => {
    window.kilter.map.pane.repaint();
    window.kilter.map.pane.render();
  });
  await frame(page);
  assert.equal(await frames(), drawn + 1, "both at once draw all");
});

await test("points come back with the graphics card", {}, async (page, opened) => {
  const points = ["#map .points", "#pair .points"];
  const before = [];
  for (const canvas of points) before.push((await painted(page, canvas)).hash);
  for (const canvas of points) {
    await page.evaluate(async (canvas) => {
      const surface = document.querySelector(canvas);
      const lose = surface.getContext("webgl2").getExtension("WEBGL_lose_context");
      const restored = new Promise((done) => surface.addEventListener("webglcontextrestored", done));
      lose.loseContext();
      await new Promise((done) => setTimeout(done, 50));
      lose.restoreContext();
      await restored;
    }, canvas);
  }
  for (const [i, canvas] of points.entries()) assert.equal((await painted(page, canvas)).hash, before[i], canvas);
  opened.complaints.length = 0; // three.js tells of what was lost
});

await test("without any pair nobody is sent to choose one", { file: alone }, async (page) => {
  const reason = await page.evaluate(() => window.kilter.state.archive.result.system.reason);
  for (const panel of ["#places", "#details", "#verdict"]) {
    assert.ok((await page.locator(panel).textContent()).toLowerCase().includes(reason.toLowerCase()), panel);
  }
  assert.doesNotMatch(await page.locator("main").textContent(), /Choose a pair|No place is known/);
  assert.ok(!(await page.locator("#matrices").isVisible()));
  await page.screenshot({ path: join(folder, "alone-again.png"), fullPage: true });
});

await test("without WebGL paper keeps the pictures' shape, and no walls are promised", { webgl: false }, async (page, opened) => {
  assert.equal(await page.locator(".missing").count(), 2);
  assert.doesNotMatch(await page.locator("#pair").textContent(), /walls that stand twice|drag to turn|Drawn /);
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const sizes = await page.evaluate(() =>
    ["#map", "#pair"].map((where) => {
      const [overlay, copy] = [`${where} .overlay`, `${where} .printed`].map((what) => document.querySelector(what));
      return [copy.width - overlay.width, copy.height - overlay.height];
    }),
  );
  assert.deepEqual(sizes, [[0, 0], [0, 0]]);
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  opened.complaints.length = 0; // three.js tells of what is missing
});

await test("what is selected is told, not only shown", {}, async (page) => {
  const current = () => page.locator("[aria-current]").evaluateAll((all) => all.map((one) => [one.tagName, Number(one.dataset.pair), one.classList.contains("selected")]));
  const worst = await page.evaluate(() => window.kilter.state.selected);
  assert.deepEqual(await current(), [["BUTTON", worst, true], ["TR", worst, true]]);
  await page.locator("#table tbody tr").last().click();
  const { number, pair } = await page.evaluate(() => ({ number: window.kilter.state.selected, pair: window.kilter.state.pairs[window.kilter.state.selected] }));
  assert.deepEqual((await current()).filter(([tag]) => tag === "TR"), [["TR", number, true]]);
  const told = await page.locator("[aria-live]").textContent();
  assert.ok(told.startsWith(`Pair ${pair.target} and ${pair.source}: ${pair.verdict}, `) && told.endsWith(" apart."), told);
  await page.keyboard.press("Escape");
  assert.deepEqual(await current(), []);
  assert.equal(await page.locator("[aria-live]").textContent(), "No pair is selected.");
  const groups = await page.locator(".choice").evaluateAll((all) => all.map((one) => [one.getAttribute("role"), one.ariaLabel !== null]));
  assert.ok(groups.length >= 5 && groups.every(([role, named]) => role === "group" && named), JSON.stringify(groups));
});

await test("swatches keep their colours where others are forced", {}, async (page) => {
  await page.emulateMedia({ forcedColors: "active" });
  const swatches = await page.locator(".swatch").evaluateAll((all) => all.map((one) => [one.style.background, getComputedStyle(one).backgroundColor]));
  assert.ok(swatches.length >= 4);
  for (const [own, drawn] of swatches) assert.equal(drawn.replaceAll(",", ""), own.replaceAll(",", ""));
  await page.screenshot({ path: join(folder, "forced-colours.png") });
});

await test("a pair that is opened by its address is seen in the table", { file: many }, async (page) => {
  const last = await page.evaluate(() => window.kilter.table.rows.at(-1));
  const hash = await page.evaluate((n) => (window.kilter.state.select(n), location.hash), last);
  const again = await open(browser, many, { hash });
  const seen = await again.page.evaluate(() => {
    const row = document.querySelector("#table tr.selected").getBoundingClientRect();
    const box = document.querySelector("#table .scroll").getBoundingClientRect();
    return { inside: row.top >= box.top && row.bottom <= box.bottom + 1, scrolled: scrollY };
  });
  assert.deepEqual(seen, { inside: true, scrolled: 0 });
  await again.context.close();
});

await browser.close();
