/** The tab that tracks the markers of the reader's fingertip in a video, an image or the camera. */
import { PageProblem } from "../src/problem";
import { button, make, setText } from "../src/ui/dom";
import type { Engine } from "./engine";
import { FeltView } from "./felt_view";
import { dropZone, save } from "./files";
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
  readonly #felt = new FeltView();
  readonly #thresholds = new ThresholdFields(() => void this.#calibrate());
  readonly #table = new MarkerTable();
  #located: LocatedFingertip | undefined;
  /** The markers come from a layout file. */
  #given = false;
  /** Content of the calibration file, if any. */
  #calibration = "";
  /** Counts the sources, so that images of an earlier one are dropped. */
  #source = 0;

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
      button("Untouched now", "Take the current image as that of the untouched fingertip", () =>
        this.#forget(),
      ),
      button("Stop", "Stop the video or the camera", () => this.#stop("Stopped.")),
      ...this.#save,
      make("label", {}, this.#heat, ` Heat map of the displacement, blue: 0, red: ${WARM} px or more`),
    );
    const picture = make("div", { class: "picture" }, this.#image);
    this.element = make("div", {}, make("p", {}, ABOUT), zone, orders, this.#thresholds.element);
    this.element.append(this.#status, this.#felt.element, picture, this.#rate, this.#video);
    this.#enable();
  }

  async #open(file: File): Promise<void> {
    try {
      if (file.name.endsWith(".toml")) await this.#openText(await file.text());
      else if (file.type.startsWith("image/")) await this.#openImage(file);
      else await this.#openVideo(file);
    } catch (error) {
      this.#stop(`${file.name}: ${problem(error, "this browser cannot read the file.")}`);
    }
  }

  async #openText(text: string): Promise<void> {
    // A calibration states what it was made for; a layout does not.
    if (text.includes("[made_for]")) {
      this.#calibration = text;
      return this.#calibrate();
    }
    this.#stop("");
    const located = await this.#engine.call("layout", { text });
    this.#forget();
    this.#given = true;
    this.#use(located);
  }

  async #openImage(file: File): Promise<void> {
    this.#stop("");
    const picture = new Image();
    picture.src = URL.createObjectURL(file);
    await picture.decode().finally(() => URL.revokeObjectURL(picture.src));
    this.#restart();
    await this.#see(picture, picture.naturalWidth, picture.naturalHeight, 0);
  }

  async #openVideo(file: File): Promise<void> {
    this.#stop("");
    this.#video.src = URL.createObjectURL(file);
    await this.#play().finally(() => URL.revokeObjectURL(this.#video.src));
  }

  async #camera(): Promise<void> {
    this.#stop("");
    try {
      this.#video.srcObject = await navigator.mediaDevices.getUserMedia({ video: { width: WIDEST } });
      await this.#play();
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      this.#stop(error instanceof PageProblem ? reason : `The camera cannot be used: ${reason}`);
    }
  }

  /** Tracks image after image until the video ends or another source is opened. */
  async #play(): Promise<void> {
    const source = ++this.#source;
    this.#restart();
    // Checks the first image again, and restarts the flags.
    if (this.#calibration) await this.#calibrate();
    const video = this.#video;
    await video.play();
    const start = performance.now();
    for (;;) {
      const time = await nextImage(video);
      if (source !== this.#source) return;
      if (time === undefined) break;
      await this.#see(video, video.videoWidth, video.videoHeight, time);
      const rate = (1000 * this.#table.images) / Math.max(1, performance.now() - start);
      if (!this.#table.full) setText(this.#rate, `${rate.toFixed(0)} images per second`);
      else setText(this.#rate, `The table is full: it ends after ${this.#table.images} images.`);
    }
    setText(this.#status, `The video has ended; ${this.#table.images} images were tracked.`);
  }

  /** Locates the markers again in the next image, unless they come from a layout. */
  #restart(): void {
    this.#table.clear();
    if (!this.#given) this.#forget();
  }

  /** Forgets the markers, and the calibration that was made for them. */
  #forget(): void {
    this.#located = undefined;
    this.#given = false;
    this.#calibration = "";
    this.#thresholds.element.hidden = true;
    this.#felt.show(undefined);
    this.#table.clear();
    this.#enable();
  }

  #use(located: LocatedFingertip): void {
    this.#located = located;
    this.#enable();
    const warnings = located.warnings.map((warning) => ` Warning: ${warning}.`);
    const next = this.#given ? " Open a video of this fingertip, or its calibration." : "";
    setText(this.#status, `${located.markers} markers.${next}${warnings.join("")}`);
  }

  async #calibrate(): Promise<void> {
    try {
      const thresholds = this.#thresholds.values();
      await this.#engine.call("calibrate", { text: this.#calibration, thresholds });
      this.#thresholds.element.hidden = false;
      setText(this.#status, "The calibration is in use.");
    } catch (error) {
      this.#calibration = "";
      setText(this.#status, `The calibration is not used: ${problem(error, String(error))}`);
    }
  }

  async #see(picture: CanvasImageSource, width: number, height: number, time: number): Promise<void> {
    const scale = this.#given ? 1 : Math.min(1, WIDEST / width);
    this.#checkSize(width, height);
    const frame = this.#frame;
    [frame.width, frame.height] = [Math.round(scale * width), Math.round(scale * height)];
    const pixels = frame.getContext("2d", { willReadFrequently: true });
    const shown = this.#image.getContext("2d");
    if (!pixels || !shown) throw new PageProblem("this browser cannot read images.");
    pixels.drawImage(picture, 0, 0, frame.width, frame.height);
    const rgba = pixels.getImageData(0, 0, frame.width, frame.height).data.buffer as ArrayBuffer;
    if (!this.#located)
      this.#use(await this.#engine.call("locate", { rgba, width: frame.width, height: frame.height }));
    const { markers, felt } = await this.#engine.call("track", { rgba, time });
    // The image and its markers appear together.
    [this.#image.width, this.#image.height] = [frame.width, frame.height];
    shown.drawImage(frame, 0, 0);
    if (this.#heat.checked) this.#heatMap.draw(shown, markers);
    drawMarkers(shown, markers);
    this.#felt.show(felt);
    this.#table.add(time, markers);
  }

  #checkSize(width: number, height: number): void {
    const expected = this.#given ? this.#located : undefined;
    if (!expected || (expected.width === width && expected.height === height)) return;
    const size = `${expected.width} x ${expected.height} px`;
    throw new PageProblem(`the layout is for images of ${size}, but these are of ${width} x ${height} px.`);
  }

  #stop(status: string): void {
    this.#source++;
    const stream = this.#video.srcObject;
    if (stream instanceof MediaStream) for (const track of stream.getTracks()) track.stop();
    this.#video.srcObject = null;
    this.#video.removeAttribute("src");
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

function problem(error: unknown, otherwise: string): string {
  return error instanceof PageProblem ? error.message : otherwise;
}
