/** Mapping of a finger's grip and slip to rumble and tone. Pure functions of the data, their age, and one setting. */

/** Age up to which data are played at full strength (ms). Rows arrive 33 to 46 ms apart. */
export const HOLD = 60;
/** Age from which nothing is played (ms). Less than 100 ms, so that timers and audio buffers end in time, too. */
export const SILENT = 90;

/** Shear rate at which slip is played at full strength (N/s). */
const FULL_SHEAR_RATE = 20;
/** Strength of the slowest slip that sets the flag SLIP. */
const LEAST_SLIP = 0.5;
/** Pitch at zero grip (Hz); it rises by an octave up to full grip. */
const LOWEST = 150;
/** Factor of the pitch during slip: two octaves. */
const SLIP_PITCH = 4;
/** Gain of the loudest tone. */
const LOUDEST = 0.3;

/** Touch of one finger. Unknown values are NaN. */
export interface Touch {
  /** Grasp force (N). */
  force: number;
  /** Flag TOUCH. */
  touch: boolean;
  /** Flag SLIP. */
  slip: boolean;
  /** Largest shear rate of an element (N/s). */
  shearRate: number;
}

/** Rumble and tone at one time. All zero but the frequency if nothing is played. */
export interface Feeling {
  /** Magnitude of the strong, low-frequency motor (0 to 1): grip. */
  strong: number;
  /** Magnitude of the weak, high-frequency motor (0 to 1): slip. */
  weak: number;
  /** Frequency of the tone (Hz): 150 to 300 by grip, two octaves higher during slip. */
  frequency: number;
  /** Gain of the tone (0 to 0.3). */
  gain: number;
}

export const NOTHING: Readonly<Feeling> = { strong: 0, weak: 0, frequency: LOWEST, gain: 0 };

/** Feeling of a touch that was measured `age` ms ago. The grasp force `fullForce` (N) is played at full strength. */
export function feel(touch: Touch, fullForce: number, age: number): Feeling {
  const fresh = freshness(age);
  const grip = touch.touch ? share(touch.force, fullForce) : 0;
  const fast = share(touch.shearRate, FULL_SHEAR_RATE);
  const slip = touch.slip ? LEAST_SLIP + (1 - LEAST_SLIP) * fast : 0;
  return {
    strong: grip * fresh,
    weak: slip * fresh,
    frequency: LOWEST * 2 ** grip * (touch.slip ? SLIP_PITCH : 1),
    gain: LOUDEST * Math.max(grip, slip) * fresh,
  };
}

/** Strength of data of this age (ms): 1 up to {@link HOLD}, then a linear fade to 0 at {@link SILENT}. */
export function freshness(age: number): number {
  return share(SILENT - age, SILENT - HOLD);
}

/** The strongest of several feelings; nothing if there is none. */
export function strongest(feelings: Feeling[]): Feeling {
  const strength = ({ strong, weak }: Feeling) => Math.max(strong, weak);
  return feelings.reduce<Feeling>((a, b) => (strength(b) > strength(a) ? b : a), { ...NOTHING });
}

/** `value / full`, limited to 0 to 1; 0 if unknown. */
function share(value: number, full: number): number {
  const share = value / full;
  return share > 0 ? Math.min(share, 1) : 0;
}
