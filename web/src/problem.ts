/** What is wrong with a page's data or the browser, in words for the reader. */
export class PageProblem extends Error {}

/** Says in `place` what is wrong. The rest of the page stays. */
export function showProblem(place: Element, what: unknown): void {
  const box = document.createElement("p");
  box.className = "problem";
  box.setAttribute("role", "alert");
  box.textContent = what instanceof Error ? what.message : String(what);
  place.prepend(box);
}

/** Runs `part` of the page; says in `place` what is wrong with it instead of ending the program. */
export function guarded<T>(place: Element, part: () => T): T | undefined {
  try {
    return part();
  } catch (error) {
    showProblem(place, error);
    return undefined;
  }
}
