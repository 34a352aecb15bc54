// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node build.mjs PAGE.html SOURCE.cc: bundles src/ into one page whose policy allows its own script and style and
// nothing else, and writes that page as a C++ source for the program.
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const [pageFile, sourceFile] = process.argv.slice(2);
if (!pageFile || !sourceFile) throw new Error("usage: node build.mjs PAGE.html SOURCE.cc");

const bundle = await build({
  absWorkingDir: here,
  entryPoints: ["src/main.ts"],
  bundle: true,
  minify: true,
  format: "iife",
  target: ["es2022"],
  charset: "ascii",
  legalComments: "none",
  write: false,
  outdir: "unused",
});
const text = (suffix) => bundle.outputFiles.find((file) => file.path.endsWith(suffix)).text;
// Inside a page nothing may look like the end of its script.
const script = text(".js").replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const style = text(".css").replaceAll("</style", "<\\/style");
const hash = (content) => `'sha256-${createHash("sha256").update(content, "utf8").digest("base64")}'`;
const policy = [
  "default-src 'none'",
  `script-src ${hash(script)}`,
  `style-src ${hash(style)}`,
  "img-src data: blob:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");

const notices = ["three", "uplot"].map((name) => {
  const about = JSON.parse(readFileSync(join(here, "node_modules", name, "package.json"), "utf8"));
  const licence = readFileSync(join(here, "node_modules", name, "LICENSE"), "utf8").trim().replaceAll("--", "- -");
  return `${name} ${about.version}:\n${licence}`;
});
// A function as replacement: the text may hold "$&".
const page = readFileSync(join(here, "src/page.html"), "utf8")
  .replace("@POLICY@", () => policy)
  .replace("@NOTICES@", () => notices.join("\n\n"))
  .replace("@STYLE@", () => style)
  .replace("@SCRIPT@", () => script);
writeFileSync(pageFile, page);

// Compilers read long literals slowly or not at all, so the page comes in pieces.
const pieces = [];
for (let i = 0; i < page.length; i += 8000) pieces.push(JSON.stringify(page.slice(i, i + 8000)).replaceAll("?", "\\?"));
const escaped = pieces.map((piece) => piece.replace(/[^\x20-\x7e]/g, (c) => {
  return [...Buffer.from(c, "utf8")].map((byte) => `\\${byte.toString(8).padStart(3, "0")}`).join("");
}));
writeFileSync(sourceFile, `// Made by viewer/build.mjs.
#include "kilter/report/viewer_page.h"

namespace kilter {

std::string viewer_page() {
  static const char* const kPieces[] = {
${escaped.map((piece) => `      ${piece},`).join("\n")}
  };
  std::string page;
  page.reserve(${Buffer.byteLength(page, "utf8")});
  for (const char* piece : kPieces) page += piece;
  return page;
}

}  // namespace kilter
`);
