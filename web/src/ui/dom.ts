/** Creates an element with attributes and content. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...content: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...content);
  return element;
}

/** Creates a button; `name` is its accessible name and tooltip. */
export function button(text: string, name: string, act: () => void): HTMLButtonElement {
  const element = make("button", { type: "button", "aria-label": name, title: name }, text);
  element.addEventListener("click", act);
  return element;
}

/** Sets text only if it differs, because writing triggers a layout. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
