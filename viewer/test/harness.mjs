// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// A test opens a report, does something and looks; what it found becomes a line of JSON.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { open } from "./browser.mjs";

/** Runs one test after the other, each in a page of its own: of `report`, where its options name no other file. */
export function tester(browser, report, folder) {
  mkdirSync(folder, { recursive: true });
  return async function test(name, options, body) {
    let error = null;
    const opened = await open(browser, options.file ?? report, options);
    try {
      await body(opened.page, opened);
      assert.deepEqual(opened.complaints, [], "the browser complained");
      assert.deepEqual(opened.requests, [], "the page asked the network");
    } catch (caught) {
      error = String(caught.stack ?? caught);
      await opened.page.screenshot({ path: join(folder, `failed-${name.replaceAll(/\W+/g, "-")}.png`) }).catch(() => undefined);
    }
    await opened.context.close();
    console.log(JSON.stringify({ name, ok: error === null, error }));
  };
}

export const frame = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** Share of a canvas's pixels that differ from its commonest colour, and a number that changes with what is drawn. */
export async function painted(page, selector) {
  // What was asked for is drawn with the next frame, and once more in full when movement has ended.
  await frame(page);
  await page.waitForTimeout(300);
  await frame(page);
  return page.evaluate((selector) => {
    const canvas = document.querySelector(selector);
    const copy = new OffscreenCanvas(canvas.width, canvas.height);
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const words = new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
    const counts = new Map();
    let hash = 0;
    for (const word of words) {
      counts.set(word, (counts.get(word) ?? 0) + 1);
      hash = (Math.imul(hash, 31) + word) | 0;
    }
    return { share: 1 - Math.max(...counts.values()) / words.length, colours: counts.size, hash };
  }, selector);
}
