/** A problem with the page's data or the browser. Its message is shown to the reader. */
export class PageProblem extends Error {}

/** Shows an error message at the start of `place`. */
export function showProblem(place: Element, what: unknown): void {
  const box = document.createElement("p");
  box.className = "problem";
  box.setAttribute("role", "alert");
  box.textContent = what instanceof Error ? what.message : String(what);
  place.prepend(box);
}

/** Runs `part`. If it throws, shows the error message in `place` and returns undefined. */
export function guarded<T>(place: Element, part: () => T): T | undefined {
  try {
    return part();
  } catch (error) {
    showProblem(place, error);
    return undefined;
  }
}
