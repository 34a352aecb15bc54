// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node speed.mjs REPORT.html: how long the first picture takes, and how many frames a second follow while the map and
// the pair are turned, in a Chromium that draws in software.
import { launch, open } from "./browser.mjs";

const report = process.argv[2];
const browser = await launch();
const first = [];
for (let i = 0; i < 5; i++) {
  const { page, context } = await open(browser, report);
  // From the start of the navigation to the frame after the first that has everything on it.
  first.push(await page.evaluate(() => new Promise((done) => {
    requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now())));
  })));
  await context.close();
}
const { page } = await open(browser, report);
const rate = (which) => page.evaluate((which) => new Promise((done) => {
  const pane = window.kilter[which].pane;
  const before = pane.frames;
  const start = performance.now();
  let turn = 0;
  const step = () => {
    turn += 0.02;
    pane.camera.position.set(1000 * Math.sin(turn), -1000 * Math.cos(turn), 700).add(pane.controls.target);
    pane.controls.update();
    const now = performance.now();
    if (now - start < 4000) requestAnimationFrame(step);
    else done((pane.frames - before) / ((now - start) / 1000));
  };
  requestAnimationFrame(step);
}), which);
const points = await page.evaluate(() => window.kilter.state.archive.clouds.reduce((sum, cloud) => sum + cloud.misalignment.length, 0));
const submaps = await page.evaluate(() => window.kilter.state.archive.clouds.length);
console.log(`${points} points, ${submaps} submaps, ${await page.evaluate(() => window.kilter.state.pairs.length)} pairs`);
first.sort((a, b) => a - b);
console.log(`first picture: ${Math.round(first[2])} ms (median of 5; ${Math.round(first[0])} to ${Math.round(first[4])})`);
console.log(`turning the map: ${(await rate("map")).toFixed(0)} frames a second`);
await page.evaluate(() => {
  const { state, matrices } = window.kilter;
  const times = [];
  for (let n = 0; n < Math.min(20, state.pairs.length); n++) {
    const start = performance.now();
    state.select(n);
    matrices.all.forEach((matrix) => matrix.draw());
    times.push(performance.now() - start);
  }
  window.selecting = times.sort((a, b) => a - b)[Math.floor(times.length / 2)];
});
console.log(`selecting a pair: ${Math.round(await page.evaluate(() => window.selecting))} ms (median)`);
console.log(`turning the pair: ${(await rate("pair")).toFixed(0)} frames a second`);
await browser.close();
