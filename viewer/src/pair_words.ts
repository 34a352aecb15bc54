// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// What stands below the picture of a pair.

export type Colouring = "submap" | "distance" | "conflict";

interface Shown {
  drawn: boolean; // whether points are
  registered: boolean; // whether there is a registered pose
  after: boolean; // whether distances are those at the registered pose
  d: number; // how far surfaces are looked for [m]
  measured: boolean; // whether there are distances
  free: boolean; // whether free space was compared
  through: string; // how many points stand where the other saw through
}

/** How to read the colours, or to use the picture. */
export function legendOf(colouring: Colouring, shown: Shown): string {
  const pose = shown.after ? "after registration" : "as in the map";
  if (!shown.drawn) return "without its points only names and axes are drawn; what was measured stands below";
  if (colouring === "submap") {
    const slides = shown.registered ? "walls that stand twice meet when the slider goes right" : "no registered pose: both stay as in the map";
    return `drag to turn, wheel to zoom; ${slides}`;
  }
  if (!shown.measured) return "this pair overlaps too little: no distances were measured";
  if (colouring === "distance") return `dark: the other surface is here; bright: ${shown.d} m away; grey: nothing within ${shown.d} m (${pose})`;
  if (!shown.free) return "not measured: these clouds carry no free space here";
  return `${shown.through} points stand where the other submap saw through (${pose})`;
}

const kColours: Record<Colouring, string> = {
  submap: "coloured by submap",
  distance: "coloured by the distance to the other submap",
  conflict: "coloured by what the other submap saw through",
};

/** What a picture on paper shows, where 0 is the map's pose and 1 the registered one. */
export function drawnAs(alpha: number, colouring: Colouring, walls: boolean): string {
  const share = Math.round(100 * alpha);
  const between = `${share} % of the way from the map's pose to the registered one`;
  const pose = share === 0 ? "as in the map" : share === 100 ? "after registration" : between;
  return `Drawn ${pose}; ${kColours[colouring]}; ${walls ? "walls only" : "everything"}.`;
}
