// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node readme_pictures.mjs REPORT.html FOLDER: the pictures of the README; tools/draw_report.py runs it.
import { join } from "node:path";
import { launch, open } from "./browser.mjs";

const [report, folder] = process.argv.slice(2);
const browser = await launch();
const { page } = await open(browser, report, { width: 1280, height: 760 });
const settle = () => page.waitForTimeout(600);
await settle();
await page.screenshot({ path: join(folder, "report.png") });
await page.locator("#matrices").screenshot({ path: join(folder, "report-matrices.png") });
// The worst pair as in the map and once registered, side by side.
const pane = page.locator("#pair .pane");
const box = await pane.boundingBox();
const shots = [];
for (const alpha of [0, 1]) {
  await page.evaluate((alpha) => window.kilter.pair.set(alpha), alpha);
  await settle();
  shots.push((await pane.screenshot()).toString("base64"));
}
const both = await browser.newPage({ viewport: { width: 2 * Math.round(box.width) + 12, height: Math.round(box.height) } });
await both.setContent(`<body style="margin:0;display:flex;gap:12px;background:white">${shots.map((shot) => `<img src="data:image/png;base64,${shot}">`).join("")}</body>`);
await both.waitForTimeout(200);
await both.screenshot({ path: join(folder, "report-pair.png") });
await browser.close();
