/** A gamepad of the test, and access to the sound of a page. */
import type { Page } from "playwright-core";

export interface Effect {
  /** Time of the call (ms). */
  start: number;
  duration: number;
  strong: number;
  weak: number;
}

export interface Felt {
  effects: Effect[];
  resets: number;
  /** Number of audio contexts. */
  contexts: number;
}

export interface Mocked {
  /** The audio context renders on request only. */
  isOffline?: boolean;
  /** The browser does not know `vibrationActuator`. */
  lacksRumble?: boolean;
}

/** Replaces the gamepads of `page`, and adds `plug`, `loudness` and `render` to its window. */
export async function mock(page: Page, mocked: Mocked = {}): Promise<void> {
  await page.addInitScript(({ isOffline, lacksRumble }) => {
    const felt: Felt = { effects: [], resets: 0, contexts: 0 };
    let kind = lacksRumble ? "plain" : "good";
    if (lacksRumble) delete (Gamepad.prototype as { vibrationActuator?: unknown }).vibrationActuator;
    const actuator = {
      playEffect(_: string, { duration, strongMagnitude, weakMagnitude }: GamepadEffectParameters) {
        if (kind === "broken") return Promise.reject(new Error("out of order"));
        felt.effects.push({
          start: performance.now(),
          duration: duration ?? 0,
          strong: strongMagnitude ?? 0,
          weak: weakMagnitude ?? 0,
        });
        return Promise.resolve("complete");
      },
      reset() {
        felt.resets++;
        return kind === "good" ? Promise.resolve("complete") : Promise.reject(new Error("gone"));
      },
    };
    // A new object at each query, as in some browsers.
    const pad = () => ({
      index: 1,
      id: "test pad",
      connected: true,
      vibrationActuator: kind === "plain" ? null : { ...actuator },
    });
    navigator.getGamepads = () => (kind === "none" ? [null] : [null, pad()]) as unknown as Gamepad[];
    const plug = (plugged: string) => {
      kind = plugged;
      dispatchEvent(new Event(kind === "none" ? "gamepaddisconnected" : "gamepadconnected"));
    };

    let context: BaseAudioContext | undefined;
    let analyser: AnalyserNode | undefined;
    type Connect = (this: AudioNode, to: AudioNode | AudioParam) => AudioNode;
    const connect = AudioNode.prototype.connect as Connect;
    AudioNode.prototype.connect = function (this: AudioNode, to: AudioNode | AudioParam) {
      if (to instanceof AudioDestinationNode) {
        analyser = new AnalyserNode(this.context, { fftSize: 1024 });
        connect.call(this, analyser);
      }
      return connect.call(this, to);
    } as AudioNode["connect"];
    const loudness = () => {
      const sound = new Float32Array(1024);
      analyser?.getFloatTimeDomainData(sound);
      return Math.max(...sound.map(Math.abs));
    };
    const Live = class extends AudioContext {
      constructor(options?: AudioContextOptions) {
        super(options);
        felt.contexts++;
      }
    };
    const Offline = class extends OfflineAudioContext {
      constructor() {
        super(1, 48_000, 48_000);
        felt.contexts++;
        context = this;
      }
      override resume = async () => {};
      override suspend = async () => {};
    };
    const render = async () => {
      const buffer = await (context as OfflineAudioContext).startRendering();
      return { sound: [...buffer.getChannelData(0)], rate: buffer.sampleRate };
    };
    Object.assign(window, { AudioContext: isOffline ? Offline : Live, felt, plug, loudness, render });
  }, mocked);
}

export const felt = (page: Page): Promise<Felt> =>
  page.evaluate(() => (window as unknown as { felt: Felt }).felt);
