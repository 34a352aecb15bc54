// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Names of robots and submaps where there is little room: what tells them apart is kept.

/** What all names begin with, less at least one letter of each; nothing where there is only one. */
export function commonBeginning(names: readonly string[]): string {
  if (names.length < 2) return "";
  const letters = names.map((name) => [...name]); // whole letters: half of an emoji is none
  let length = Math.min(...letters.map((name) => name.length)) - 1;
  for (const name of letters) {
    for (let i = 0; i < length; i++) if (name[i] !== letters[0]![i]) length = i;
  }
  return letters[0]!.slice(0, Math.max(0, length)).join("");
}

/** A name in at most so many letters: without what all begin with, then without its middle; ~ stands for what is left out. */
export function shortened(name: string, common: string, most = 14): string {
  const all = [...name];
  if (all.length <= most) return name;
  const cut = common !== "" && name.startsWith(common);
  const own = cut ? ["~", ...name.slice(common.length)] : all;
  if (own.length <= most) return own.join("");
  const tail = Math.floor((most - 1) / 2);
  return [...own.slice(0, most - 1 - tail), "~", ...own.slice(-tail)].join("");
}

/** A submap's name in three: what all robots' names begin with, the rest of its robot's, and its number. */
export function partsOfName(id: string, robot: string, common: string): [string, string, string] {
  if (!id.startsWith(robot)) return ["", id, ""];
  const begins = robot.startsWith(common) ? common : "";
  return [begins, robot.slice(begins.length), id.slice(robot.length)];
}
