// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Elements are built, never parsed: a name from a file is text wherever it stands.

type Child = Node | string | null;

interface Properties {
  class?: string;
  id?: string;
  title?: string;
  type?: string;
  value?: string;
  min?: string;
  max?: string;
  step?: string;
  href?: string;
  label?: string;
  role?: string;
  checked?: boolean;
  disabled?: boolean;
  data?: Record<string, string>;
  on?: Partial<Record<string, (event: Event) => void>>;
}

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  const { class: classes, label, role, data, on, ...rest } = properties;
  if (classes) node.className = classes;
  if (label) node.setAttribute("aria-label", label);
  if (role) node.setAttribute("role", role);
  for (const [key, value] of Object.entries(data ?? {})) node.dataset[key] = value;
  for (const [key, listener] of Object.entries(on ?? {})) if (listener) node.addEventListener(key, listener);
  Object.assign(node, rest);
  for (const child of children) if (child !== null) node.append(child);
  return node;
}

/** Marks what shows the selected pair, for eyes and for those who have the page read to them. */
export function markCurrent(node: HTMLElement, current: boolean): void {
  node.classList.toggle("selected", current);
  if (current) node.setAttribute("aria-current", "true");
  else node.removeAttribute("aria-current");
}

export function byId(id: string): HTMLElement {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found;
}

/** A group of buttons of which one is down. */
export function choice<T extends string>(
  label: string,
  options: readonly (readonly [T, string, string?])[],
  start: T,
  chosen: (value: T) => void,
): { root: HTMLElement; set: (value: T) => void } {
  const buttons = options.map(([value, text, title]) =>
    element("button", { type: "button", title: title ?? "", data: { value }, on: { click: () => set(value) } }, text),
  );
  const mark = (value: T) =>
    buttons.forEach((button) => button.setAttribute("aria-pressed", String(button.dataset["value"] === value)));
  const set = (value: T) => {
    mark(value);
    chosen(value);
  };
  mark(start);
  return { root: element("span", { class: "choice", role: "group", label }, ...buttons), set };
}

const tip = (): HTMLElement => byId("tip");

export function showTip(content: Node, x: number, y: number): void {
  const box = tip();
  box.replaceChildren(content);
  box.hidden = false;
  const size = box.getBoundingClientRect();
  box.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - size.width - 8))}px`;
  box.style.top = `${y + 18 + size.height > innerHeight ? Math.max(4, y - size.height - 10) : y + 18}px`;
}

export function hideTip(): void {
  tip().hidden = true;
}

/** A canvas's drawing surface, sized to its place on the screen. */
export function fitted(canvas: HTMLCanvasElement): { context: CanvasRenderingContext2D; width: number; height: number } {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  const [across, down] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
  // A new size means new memory, also where it is the old one.
  if (canvas.width !== across) canvas.width = across;
  if (canvas.height !== down) canvas.height = down;
  const context = canvas.getContext("2d")!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}
