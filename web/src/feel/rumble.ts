/** Rumble of a feeling (Gamepad API). Each effect ends by itself when its data are stale. */
import { type Feeling, SILENT } from "./mapping";

export class Rumble {
  /** Actuator of the latest effect, and the index of its gamepad: an actuator may be another object at each query. */
  #playing: { actuator: GamepadHapticActuator; index: number } | undefined;
  /** Error of the latest effect, if it failed. */
  #error = "";

  /** Plays the feeling of data of this age (ms) until they are stale. Returns whether a gamepad accepted it. */
  play({ strong, weak }: Readonly<Feeling>, age: number): boolean {
    const gamepad = gamepads().find(actuatorOf);
    const actuator = gamepad && actuatorOf(gamepad);
    if (gamepad?.index !== this.#playing?.index) this.silence();
    const duration = SILENT - age;
    if (!actuator || duration <= 0 || (strong === 0 && weak === 0)) {
      this.silence();
      return actuator !== undefined;
    }
    this.#playing = { actuator, index: gamepad.index };
    const effect = { startDelay: 0, duration, strongMagnitude: strong, weakMagnitude: weak };
    this.#report(actuator.playEffect("dual-rumble", effect));
    return this.#error === "";
  }

  /** Ends the effect at once. */
  silence(): void {
    const playing = this.#playing;
    this.#playing = undefined;
    // A gamepad that is gone may reject.
    void playing?.actuator.reset().catch(() => {});
  }

  /** Name of the gamepad that rumbles, or the reason why there is none. */
  get state(): string {
    if (typeof navigator.getGamepads !== "function") return "This browser does not support gamepads.";
    const [first] = gamepads();
    if (!first) return "No gamepad: connect one and press a button on it.";
    const rumbling = gamepads().find(actuatorOf);
    if (rumbling && this.#error) return `The gamepad ${rumbling.id} does not rumble: ${this.#error}.`;
    if (rumbling) return `Rumble on ${rumbling.id}.`;
    if ("vibrationActuator" in Gamepad.prototype) return `The gamepad ${first.id} has no rumble.`;
    return "This browser does not support the rumble of gamepads (vibrationActuator).";
  }

  #report(playing: Promise<unknown>): void {
    playing.then(
      () => (this.#error = ""),
      (error: unknown) => (this.#error = error instanceof Error ? error.message : String(error)),
    );
  }
}

function gamepads(): Gamepad[] {
  if (typeof navigator.getGamepads !== "function") return [];
  return navigator.getGamepads().filter((gamepad) => gamepad?.connected === true) as Gamepad[];
}

function actuatorOf({ vibrationActuator }: Gamepad): GamepadHapticActuator | undefined {
  return typeof vibrationActuator?.playEffect === "function" ? vibrationActuator : undefined;
}
