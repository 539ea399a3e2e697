/** The watcher's settings of rumble and tone, remembered by the browser. */
import { store, stored } from "../ui/storage";

/** Grasp forces that can be chosen as full strength (N). */
export const FULL_FORCES = [0.5, 1, 2, 5, 10, 20, 50];

export interface Settings {
  on: boolean;
  /** Number of the finger that is felt; undefined for the strongest. */
  finger?: number | undefined;
  /** Grasp force that is played at full strength (N), one of {@link FULL_FORCES}. */
  fullForce: number;
}

const KEY = "feeler-feel";

/** Settings in a remembered text; the default for each that is missing or invalid. */
export function readSettings(text: string | null, fingers: number): Settings {
  let found: Partial<Record<keyof Settings, unknown>> | null = null;
  try {
    found = JSON.parse(text ?? "null");
  } catch {
    // Not written by this page.
  }
  const { on, finger, fullForce } = found ?? {};
  const isFinger = typeof finger === "number" && Number.isInteger(finger) && finger >= 0 && finger < fingers;
  return {
    on: on === true,
    finger: isFinger ? finger : undefined,
    fullForce: FULL_FORCES.find((force) => force === fullForce) ?? 2,
  };
}

export function recall(fingers: number): Settings {
  return readSettings(stored(KEY), fingers);
}

export function remember(settings: Settings): void {
  store(KEY, JSON.stringify(settings));
}
