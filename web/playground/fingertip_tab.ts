/** The tab that tracks the markers of the reader's fingertip in a video, an image or the camera. */
import { PageProblem } from "../src/problem";
import { button, make, setText } from "../src/ui/dom";
import type { Engine } from "./engine";
import { dropZone, save } from "./files";
import { ForcesView } from "./forces_view";
import { MarkerTable } from "./marker_table";
import { drawMarkers, HeatMap, WARM } from "./markers";
import type { LocatedFingertip } from "./protocol";
import { ThresholdFields } from "./thresholds";

/** Largest width of the tracked image (px); larger ones are scaled down unless a layout is given. */
const WIDEST = 640;
const ABOUT =
  "A fingertip with markers, such as TacTip, GelSight with dots, or your own: its markers are located in the first image, which must show it untouched, and tracked from there. Add a layout and a calibration, as feeler locate and feeler calibrate write them, for forces and flags. Nothing leaves this computer.";

export class FingertipTab {
  readonly element: HTMLElement;
  readonly #engine: Engine;
  readonly #video = make("video", { muted: "", playsinline: "", hidden: "" });
  readonly #image = make("canvas", { role: "img", "aria-label": "Image of the fingertip with its markers" });
  /** The current image without markers. */
  readonly #frame = document.createElement("canvas");
  readonly #status = make("p", { class: "note", role: "status", "aria-live": "polite" });
  readonly #rate = make("p", { class: "note" });
  readonly #save: HTMLButtonElement[];
  readonly #heat = make("input", { type: "checkbox", id: "heat-map" });
  readonly #heatMap = new HeatMap();
  readonly #forces = new ForcesView();
  readonly #thresholds = new ThresholdFields(() => void this.#setThresholds());
  readonly #table = new MarkerTable();
  #located: LocatedFingertip | undefined;
  /** `true` if the markers come from a layout file. */
  #given = false;
  /** Content of the calibration file, if any. */
  #calibration = "";
  /** Counts the sources, so that images of an earlier one are dropped. */
  #source = 0;
  /** Number of images tracked. */
  #tracked = 0;
  /** Time at which tracking started (ms). */
  #since = performance.now();

  constructor(engine: Engine) {
    this.#engine = engine;
    this.#video.muted = true;
    const text = "Drop a video, an image, a layout or a calibration here, or choose one: ";
    const zone = dropZone("fingertip", "video/*,image/*,.toml", text, (file) => void this.#open(file));
    this.#save = [
      button("Save the layout", "Save the markers as a layout file for feeler sense", () =>
        save("layout.toml", this.#located?.layout ?? "", "text/plain"),
      ),
      button("Save the table", "Save all tracked markers as a table", () =>
        save("markers.csv", this.#table.csv(), "text/csv"),
      ),
    ];
    const orders = make(
      "div",
      { class: "orders" },
      button("Use the camera", "Use a camera of this computer", () => void this.#camera()),
      button("Untouched now", "Take the next image as that of the untouched fingertip", () =>
        this.#untouched(),
      ),
      button("Stop", "Stop the video or the camera", () => this.#stop("Stopped.")),
      ...this.#save,
      make("label", {}, this.#heat, ` Heat map of the displacement, blue: 0, red: ${WARM} px or more`),
    );
    const picture = make("div", { class: "picture" }, this.#image);
    this.element = make("div", {}, make("p", {}, ABOUT), zone, orders, this.#thresholds.element);
    this.element.append(this.#status, this.#forces.element, picture, this.#rate, this.#video);
    this.#enable();
  }

  async #open(file: File): Promise<void> {
    const text = file.name.endsWith(".toml") ? await file.text() : undefined;
    // A calibration states what it was made for; a layout does not.
    if (text?.includes("[made_for]")) {
      this.#calibration = text;
      return this.#calibrate();
    }
    const source = this.#begin();
    try {
      if (text !== undefined) await this.#openLayout(text, source);
      else if (file.type.startsWith("image/")) await this.#openImage(file, source);
      else await this.#openVideo(file, source);
    } catch (error) {
      if (source === this.#source)
        this.#stop(`${file.name}: ${problem(error, "this browser cannot read the file.")}`);
    }
  }

  async #openLayout(text: string, source: number): Promise<void> {
    const located = await this.#engine.call("layout", { text });
    if (source !== this.#source) return;
    this.#forget();
    this.#given = true;
    this.#use(located);
  }

  async #openImage(file: File, source: number): Promise<void> {
    const picture = new Image();
    const url = URL.createObjectURL(file);
    picture.src = url;
    await picture.decode().finally(() => URL.revokeObjectURL(url));
    this.#restart();
    await this.#process(source, picture, picture.naturalWidth, picture.naturalHeight, 0);
  }

  async #openVideo(file: File, source: number): Promise<void> {
    const url = URL.createObjectURL(file);
    this.#video.src = url;
    await this.#play(source).finally(() => URL.revokeObjectURL(url));
  }

  async #camera(): Promise<void> {
    const source = this.#begin();
    try {
      const stream = await navigator.mediaDevices.getUserMedia({ video: { width: WIDEST } });
      if (source !== this.#source) return stop(stream);
      this.#video.srcObject = stream;
      await this.#play(source);
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      if (source !== this.#source) return;
      this.#stop(error instanceof PageProblem ? reason : `The camera cannot be used: ${reason}`);
    }
  }

  /** Tracks image after image until the video ends or another source is opened. */
  async #play(source: number): Promise<void> {
    this.#restart();
    // Resets the flags and the check of the first image.
    if (this.#calibration) await this.#calibrate();
    const video = this.#video;
    // Requested before the video plays, so that its first image is not missed.
    let next = nextImage(video);
    await video.play();
    for (;;) {
      const time = await next;
      if (source !== this.#source) return;
      if (time === undefined) break;
      await this.#process(source, video, video.videoWidth, video.videoHeight, time);
      const rate = (1000 * ++this.#tracked) / Math.max(1, performance.now() - this.#since);
      if (!this.#table.full) setText(this.#rate, `${rate.toFixed(0)} images per second`);
      else setText(this.#rate, `The table is full: it contains only the first ${this.#table.images} images.`);
      next = nextImage(video);
    }
    setText(this.#status, `The video has ended; ${this.#tracked} images were tracked.`);
  }

  /** Locates the markers again in the next image, unless they come from a layout. */
  #restart(): void {
    if (this.#given) this.#clearTable();
    else this.#forget();
  }

  /** Forgets the markers, and the calibration that was made for them. */
  #forget(): void {
    this.#located = undefined;
    this.#given = false;
    this.#calibration = "";
    this.#thresholds.element.hidden = true;
    this.#forces.show(undefined);
    this.#clearTable();
    this.#enable();
  }

  #clearTable(): void {
    this.#table.clear();
    [this.#tracked, this.#since] = [0, performance.now()];
  }

  #use(located: LocatedFingertip): void {
    this.#located = located;
    this.#enable();
    const warnings = located.warnings.map((warning) => ` Warning: ${warning}.`);
    const next = this.#given ? " Open a video of this fingertip, or its calibration." : "";
    setText(this.#status, `${located.markers} markers.${next}${warnings.join("")}`);
  }

  async #calibrate(): Promise<void> {
    this.#forces.show(undefined);
    try {
      const hasFlags = await this.#engine.call("calibrate", { text: this.#calibration });
      this.#thresholds.element.hidden = !hasFlags;
      await this.#setThresholds();
      setText(this.#status, "The calibration is in use. The next image must show the untouched fingertip.");
    } catch (error) {
      this.#calibration = "";
      this.#thresholds.element.hidden = true;
      setText(this.#status, `The calibration is not used: ${problem(error, String(error))}`);
    }
  }

  #setThresholds(): Promise<undefined> {
    return this.#engine.call("thresholds", this.#thresholds.values());
  }

  /** Shows an image with its markers and adds them to the table, unless another source was opened meanwhile. */
  async #process(
    source: number,
    picture: CanvasImageSource,
    width: number,
    height: number,
    time: number,
  ): Promise<void> {
    const scale = this.#given ? 1 : Math.min(1, WIDEST / width);
    this.#checkSize(width, height);
    const frame = this.#frame;
    [frame.width, frame.height] = [Math.round(scale * width), Math.round(scale * height)];
    const pixels = frame.getContext("2d", { willReadFrequently: true });
    const shown = this.#image.getContext("2d");
    if (!pixels || !shown) throw new PageProblem("this browser cannot read images.");
    pixels.drawImage(picture, 0, 0, frame.width, frame.height);
    const rgba = pixels.getImageData(0, 0, frame.width, frame.height).data.buffer as ArrayBuffer;
    if (!this.#located) {
      const size = { width: frame.width, height: frame.height };
      const located = await this.#engine.call("locate", { rgba, ...size });
      if (source !== this.#source) return;
      this.#use(located);
    }
    const located = this.#located;
    const { markers, sensed } = await this.#engine.call("track", { rgba, time });
    if (source !== this.#source || located !== this.#located) return;
    // The image and its markers appear together.
    [this.#image.width, this.#image.height] = [frame.width, frame.height];
    shown.drawImage(frame, 0, 0);
    if (this.#heat.checked) this.#heatMap.draw(shown, markers);
    drawMarkers(shown, markers);
    this.#forces.show(sensed);
    this.#table.add(time, markers);
  }

  #checkSize(width: number, height: number): void {
    const expected = this.#given ? this.#located : undefined;
    if (!expected || (expected.width === width && expected.height === height)) return;
    const size = `${expected.width} x ${expected.height} px`;
    throw new PageProblem(
      `expected images of ${size} as in the layout, got ${width} x ${height} px; use the layout of this camera.`,
    );
  }

  /** Locates the markers again in the next image of the running source. */
  #untouched(): void {
    if (this.#given) setText(this.#status, "The layout defines the untouched fingertip.");
    else if (this.#video.paused) setText(this.#status, "This needs a running video or camera.");
    else this.#forget();
  }

  /** Ends the current source and returns the number of the next one. */
  #begin(): number {
    this.#stop("");
    this.#forces.show(undefined);
    setText(this.#rate, "");
    return this.#source;
  }

  #stop(status: string): void {
    this.#source++;
    const video = this.#video;
    const stream = video.srcObject;
    if (stream instanceof MediaStream) stop(stream);
    video.pause();
    video.srcObject = null;
    video.removeAttribute("src");
    // Releases the file.
    video.load();
    setText(this.#status, status);
  }

  #enable(): void {
    for (const save of this.#save) save.disabled = !this.#located;
  }
}

/** Returns the time of the next image of `video` (s), or `undefined` at its end. */
function nextImage(video: HTMLVideoElement): Promise<number | undefined> {
  return new Promise((done) => {
    if (video.ended) return done(undefined);
    const ended = () => {
      video.cancelVideoFrameCallback(callback);
      done(undefined);
    };
    const callback = video.requestVideoFrameCallback((_, { mediaTime }) => {
      video.removeEventListener("ended", ended);
      done(mediaTime);
    });
    video.addEventListener("ended", ended, { once: true });
  });
}

function stop(stream: MediaStream): void {
  for (const track of stream.getTracks()) track.stop();
}

function problem(error: unknown, otherwise: string): string {
  return error instanceof PageProblem ? error.message : otherwise;
}
