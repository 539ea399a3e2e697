/** Texts that the browser stores. A page opened from disk may have no storage, or access may throw. */

/** Text stored under `key`, or null if there is none. */
export function stored(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** Stores `text` under `key`; without storage, it is lost when the page is closed. */
export function store(key: string, text: string): void {
  try {
    localStorage.setItem(key, text);
  } catch {
    // The text applies to this visit only.
  }
}
