// Makes elements of the page.

type Child = Node | string | null | undefined;
type Attributes = Record<string, string | number | boolean | ((event: never) => void) | undefined>;

/** An element. Attributes that are functions listen to events; a false or undefined one is left out. */
export function h<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, String(value));
  }
  element.append(...children.filter((child): child is Node | string => child !== null && child !== undefined));
  return element;
}

/** The paths of icons, on a grid of 24. */
const ICONS = {
  play: "M7 4.5v15l12.5-7.5z",
  pause: "M6 4.5h4.2v15H6zM13.8 4.5H18v15h-4.2z",
  back: "M17.5 5v14L8 12zM5 5h2.6v14H5z",
  ahead: "M6.5 5v14L16 12zM16.4 5H19v14h-2.6z",
  restart: "M12 5a7 7 0 1 1-6.6 4.7l-2-.7A9 9 0 1 0 12 3V0L7 4l5 4z",
  hand: "M8 11V4.5a1.5 1.5 0 0 1 3 0V10h1V2.8a1.5 1.5 0 0 1 3 0V10h1V5a1.5 1.5 0 0 1 3 0v9.5c0 4.5-2.6 7.5-6.6 7.5-3 0-4.6-1.3-6-3.6L3.600 14a1.500 1.500 0 0 1 2.500-1.600z",
  pad: "M7 7h10a5 5 0 0 1 5 5.500c0 2.500-.8 5.500-2.800 5.500-1.700 0-2.200-2.500-3.700-2.500h-7C7 15.500 6.500 18 4.800 18 2.800 18 2 15 2 12.500A5 5 0 0 1 7 7zM7 9v1.500H5.500V12H7v1.500h1.500V12H10v-1.500H8.500V9zM15 9.500a1.200 1.200 0 1 0 0 2.400 1.200 1.200 0 0 0 0-2.400zM17.500 11.500a1.200 1.200 0 1 0 0 2.400 1.200 1.200 0 0 0 0-2.400z",
  loop: "M7 7h9V3.500L21.500 8 16 12.500V9H7a3 3 0 0 0 0 6h1v2H7A5 5 0 0 1 7 7zM12 15h5v2h-5z",
  map: "M3 4h7v7H3zM14 4h7v5h-7zM14 13h7v7h-7zM3 15h7v5H3z",
  sun: "M12 7a5 5 0 1 1 0 10 5 5 0 0 1 0-10zM11 1h2v4h-2zM11 19h2v4h-2zM1 11h4v2H1zM19 11h4v2h-4zM4.200 2.800l2.900 2.900-1.400 1.400-2.900-2.900zM18.300 16.900l2.900 2.900-1.400 1.400-2.900-2.900zM2.800 19.800l2.900-2.900 1.400 1.400-2.900 2.900zM16.900 5.700l2.900-2.900 1.400 1.400-2.900 2.900z",
  moon: "M20.500 14.500A9 9 0 0 1 9.500 3.500a9 9 0 1 0 11 11z",
  panel: "M3 4h18v16H3zM15 6v12h4V6zM5 6v12h8V6z",
  close: "M5.600 4.200 12 10.600l6.400-6.400 1.400 1.400-6.400 6.400 6.400 6.400-1.400 1.400-6.400-6.400-6.400 6.400-1.400-1.400 6.400-6.400-6.400-6.400z",
} as const;

export type IconName = keyof typeof ICONS;

/** A picture for a button; its meaning is said by the button's label. */
export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("icon");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", ICONS[name]);
  path.setAttribute("fill-rule", "evenodd");
  svg.append(path);
  return svg;
}

/** A button with a picture. */
export function iconButton(name: IconName, label: string, click: () => void, key?: string): HTMLButtonElement {
  const title = key ? `${label} (${key})` : label;
  return h("button", { type: "button", class: "icon-button", "aria-label": label, title, onclick: click }, icon(name));
}

/** A button with a text. */
export function button(text: string, click: () => void, kind = ""): HTMLButtonElement {
  return h("button", { type: "button", class: `button ${kind}`, onclick: click }, text);
}

/** A switch with a label. */
export function toggle(text: string, isOn: boolean, change: (isOn: boolean) => void, key?: string): HTMLLabelElement {
  const input = h("input", {
    type: "checkbox",
    class: "switch",
    checked: isOn,
    onchange: () => change(input.checked),
  });
  return h("label", { class: "toggle" }, input, h("span", {}, text), key ? h("kbd", {}, key) : null);
}

/** A part of a panel with a heading. */
export function section(title: string, ...children: Child[]): HTMLElement {
  return h("section", { class: "section" }, h("h2", {}, title), ...children);
}

/** A number as people read it. */
export function short(value: number, digits = 2): string {
  return Number.isFinite(value) ? String(Number(value.toFixed(digits))) : "∞";
}
