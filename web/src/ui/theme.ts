/** Light or dark theme: the system's setting until the reader chooses. */
import { forgetPageColours } from "./colours";
import { button, make } from "./dom";
import { store, stored } from "./storage";

type Choice = "light" | "dark";

const KEY = "feeler-theme";
const listeners: (() => void)[] = [];
const system = matchMedia("(prefers-color-scheme: dark)");

export function isDark(): boolean {
  const choice = document.documentElement.style.colorScheme;
  return choice ? choice === "dark" : system.matches;
}

/** Calls `listener` whenever the theme changes. */
export function onTheme(listener: () => void): void {
  listeners.push(listener);
}

export function themeButton(): HTMLElement {
  const toggle = button("", "", () => choose(isDark() ? "light" : "dark"));
  const label = make("span", { class: "sr" });
  toggle.classList.add("theme");
  const show = () => {
    const name = isDark() ? "Light colours" : "Dark colours";
    toggle.replaceChildren(isDark() ? "☀\ufe0e" : "☾\ufe0e", label);
    toggle.setAttribute("aria-label", name);
    toggle.title = name;
  };
  onTheme(show);
  show();
  return toggle;
}

/** Applies the reader's last choice and follows changes of the system. */
export function startTheme(): void {
  const choice = stored(KEY);
  if (choice === "light" || choice === "dark") document.documentElement.style.colorScheme = choice;
  system.addEventListener("change", changed);
}

function choose(choice: Choice): void {
  document.documentElement.style.colorScheme = choice;
  store(KEY, choice);
  changed();
}

function changed(): void {
  forgetPageColours();
  for (const listener of listeners) listener();
}
