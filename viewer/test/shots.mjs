// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node shots.mjs REPORT.html FOLDER: pictures of a report at several sizes, to be looked at.
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { launch, open } from "./browser.mjs";

const [report, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const browser = await launch();
const looks = [
  ["wide", { width: 1440, height: 900 }],
  ["wide-dark", { width: 1440, height: 900, dark: true }],
  ["small", { width: 800, height: 600 }],
];
for (const [name, options] of looks) {
  const { page, context, complaints, requests } = await open(browser, report, options);
  await page.waitForTimeout(400);
  await page.screenshot({ path: join(folder, `${name}.png`) });
  await page.screenshot({ path: join(folder, `${name}-whole.png`), fullPage: true });
  console.log(name, await page.evaluate(() => document.documentElement.dataset.ready), "ms", complaints, requests);
  if (name === "wide") await page.pdf({ path: join(folder, "print.pdf"), format: "A4", landscape: true, printBackground: true });
  await context.close();
}
await browser.close();
