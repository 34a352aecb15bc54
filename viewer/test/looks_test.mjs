// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node looks_test.mjs LONG.html ALONE.html FOLDER: what a report looks like where names are long, on paper, with other
// colours or without a graphics card; LONG has long names, ALONE no pair. Prints a line of JSON per test; screenshots go
// to FOLDER. tests/viewer_test.py runs it.
import assert from "node:assert/strict";
import { join } from "node:path";
import { launch, open } from "./browser.mjs";
import { frame, painted, tester } from "./harness.mjs";

const [report, alone, folder] = process.argv.slice(2);
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

await browser.close();
