// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
import "./style.css";
import { correctionOpen, notBelieved } from "./advice.js";
import { readArchive, unpack } from "./archive.js";
import { Details } from "./details.js";
import { byId, element, hideTip } from "./dom.js";
import { MapView } from "./map_view.js";
import { Matrices } from "./matrices.js";
import { PairView } from "./pair_view.js";
import { showPlaces, worstFirst, worstPlaces } from "./places.js";
import { forgetTheme } from "./scene.js";
import { readable, State } from "./state.js";
import { Table } from "./table.js";
import { showVerdict } from "./verdict.js";
import { centimetres } from "./words.js";

const kKeys: [string, string][] = [
  ["j or ↓, k or ↑", "next, previous pair in the order of the table"],
  ["n", "next of the worst places"],
  ["m, r, p", "the pair as in the map, as registered, moving between them"],
  ["1, 2, 3", "colour the map by robot, height, misalignment"],
  ["t", "look at the whole map from above"],
  ["d", "dark or light"],
  ["Esc", "select nothing, close this"],
  ["?", "this help"],
];

function help(): HTMLDialogElement {
  const dialog = byId("help") as HTMLDialogElement;
  const close = element("button", { type: "button", on: { click: () => dialog.close() } }, "close");
  dialog.replaceChildren(
    element("h2", {}, "How to read this"),
    element(
      "p",
      {},
      "The map was cut into submaps: short pieces of each robot's way. Every two that saw the same place were compared. " +
        "Where they are apart, the map shows one wall twice. Registration slides one onto the other: the way it has to go is the offset.",
    ),
    element("p", {}, "Click a pair anywhere, a line or pin of the map, a cell of a matrix, a row or a place, and everything follows. The address of the page then names the pair: send it on."),
    element("table", {}, ...kKeys.map(([key, text]) => element("tr", {}, element("th", {}, key), element("td", {}, text)))),
    close,
  );
  return dialog;
}

function dark(): boolean {
  const set = document.documentElement.dataset["theme"];
  return set ? set === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

function switchTheme(state: State, theme: "dark" | "light" | ""): void {
  if (theme === "") delete document.documentElement.dataset["theme"];
  else document.documentElement.dataset["theme"] = theme;
  forgetTheme();
  state.themeChanged();
}

/** Paper has another width than the screen, and canvases do not follow: copies of what they show do. */
function copyForPrint(): void {
  for (const holder of document.querySelectorAll(".pane, figure")) {
    const layers = [...holder.querySelectorAll("canvas")];
    if (layers.length === 0) continue;
    const copy = element("canvas", { class: "printed" });
    // Without WebGL the lowest layer has no size of its own.
    copy.width = Math.max(...layers.map((layer) => layer.width));
    copy.height = Math.max(...layers.map((layer) => layer.height));
    const context = copy.getContext("2d")!;
    for (const layer of layers.slice(holder.querySelector(".missing") ? 1 : 0)) context.drawImage(layer, 0, 0, copy.width, copy.height);
    holder.after(copy);
    if (holder.tagName === "FIGURE") holder.append(copy);
  }
}

function foot(state: State, dialog: HTMLDialogElement): void {
  const archive = state.archive;
  const all = archive.clouds.reduce((sum, cloud) => sum + cloud.voxels, 0);
  const shown = archive.clouds.reduce((sum, cloud) => sum + cloud.misalignment.length, 0);
  const sampled = archive.pairs.find((pair) => pair.sourceSamples.before.length > 0)?.stride ?? 1;
  const thinned =
    shown < all
      ? `Points are thinned: ${shown} of ${all} voxels are drawn (report_max_points).`
      : `All ${all} voxels are drawn.`;
  const distances = sampled > 1 ? ` Distances of a pair are known at one in ${sampled} of them.` : "";
  byId("foot").replaceChildren(
    element("span", {}, `${thinned}${distances} Histograms, offsets and matrices come from all voxels. `),
    element("span", { class: "quiet" }, `kilter ${archive.result.version}, configuration ${archive.result.config_digest}. `),
    element("button", { type: "button", id: "theme", on: { click: () => switchTheme(state, dark() ? "light" : "dark") } }, "dark / light"),
    element("button", { type: "button", on: { click: () => dialog.showModal() } }, "help (?)"),
  );
}

/** The selected pair for those who have the page read to them. */
function inShort(state: State): string {
  const pair = state.pairs[state.selected];
  if (!pair) return "No pair is selected.";
  const offset = pair.offset_m === null ? "offset not measured" : correctionOpen(pair) ? notBelieved(pair) : `${centimetres(pair.offset_m)} apart`;
  return `Pair ${pair.target} and ${pair.source}: ${pair.verdict}, ${offset}.`;
}

/** Says so where the address names a pair that this report does not have; until another is selected. */
function tellStray(state: State, instead = ""): void {
  const holder = document.querySelector("#verdict .why")!;
  holder.querySelector(".stray")?.remove();
  if (!location.hash.startsWith("#pair=") || state.pairOfFragment(location.hash) >= 0) return;
  const note = element("p", { class: "stray" }, `The address names a pair that is not in this report (${readable(location.hash.slice(6))}).${instead}`);
  holder.append(note);
  state.on("selection", () => note.remove());
}

async function main(): Promise<void> {
  const start = performance.now();
  const holder = byId("archive");
  const archive = readArchive(await unpack((holder.textContent ?? "").trim()));
  holder.remove();
  const state = new State(archive);
  const places = worstPlaces(archive);
  showVerdict(archive.result);
  const markPlaces = showPlaces(state, places);
  state.select(state.pairOfFragment(location.hash));
  const worst = places[0]?.pair ?? archive.result.pairs.map((_, n) => n).sort(worstFirst(archive.result.pairs))[0] ?? -1;
  if (state.selected < 0) {
    // The worst place is shown at once; the address stays as it was typed.
    state.selected = worst;
  }
  const map = new MapView(state, places);
  const pair = new PairView(state);
  new Details(state);
  const matrices = new Matrices(state);
  const table = new Table(state);
  const dialog = help();
  foot(state, dialog);
  tellStray(state, " The worst place is shown.");
  state.select(state.selected);
  markPlaces();
  state.on("selection", () => (byId("now").textContent = inShort(state)));

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    forgetTheme();
    state.themeChanged();
  });
  window.addEventListener("hashchange", () => {
    const named = state.pairOfFragment(location.hash);
    if (named >= 0) state.select(named);
    else tellStray(state);
  });
  let before: string | undefined;
  window.addEventListener("beforeprint", () => {
    before = document.documentElement.dataset["theme"];
    switchTheme(state, "light");
    table.print(true);
    map.pane.draw();
    pair.pane.draw();
    matrices.all.forEach((matrix) => matrix.draw());
    copyForPrint();
  });
  window.addEventListener("afterprint", () => {
    for (const copy of document.querySelectorAll(".printed")) copy.remove();
    table.print(false);
    switchTheme(state, (before ?? "") as "dark" | "light" | "");
  });
  window.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || target.matches("input:not([type=range]):not([type=checkbox]), select")) return;
    if (target.matches("input[type=range]") && event.key.startsWith("Arrow")) return;
    if (dialog.open && event.key !== "?") return; // Esc closes it by itself
    const keys: Record<string, () => void> = {
      j: () => state.select(table.beside(1)),
      k: () => state.select(table.beside(-1)),
      ArrowDown: () => state.select(table.beside(1)),
      ArrowUp: () => state.select(table.beside(-1)),
      n: () => {
        const now = places.findIndex((place) => place.pairs.includes(state.selected));
        if (places.length > 0) state.select(places[(now + 1) % places.length]!.pair);
      },
      m: () => pair.set(0),
      r: () => pair.set(1),
      p: () => pair.play(),
      "1": () => map.chooseColours("robot"),
      "2": () => map.chooseColours("height"),
      "3": () => map.chooseColours("misalignment"),
      t: () => map.top(),
      d: () => switchTheme(state, dark() ? "light" : "dark"),
      "?": () => (dialog.open ? dialog.close() : dialog.showModal()),
      Escape: () => {
        hideTip();
        state.select(-1);
      },
    };
    const act = keys[event.key];
    if (!act) return;
    if (event.key !== "Escape") event.preventDefault();
    act();
  });
  requestAnimationFrame(() =>
    requestAnimationFrame(() => {
      document.documentElement.dataset["ready"] = String(Math.round(performance.now() - start));
    }),
  );
  // For tests and for the curious: what is drawn, in numbers.
  Object.assign(window, { kilter: { state, map, pair, matrices, table } });
}

main().catch((error: unknown) => {
  const text = error instanceof Error ? error.message : String(error);
  byId("verdict").replaceChildren(
    element("h1", {}, "This report cannot be drawn"),
    element("p", {}, `${text}. It needs a browser of 2023 or newer; the same numbers are in result.json and pairs.csv.`),
  );
  document.documentElement.dataset["ready"] = "failed";
});
