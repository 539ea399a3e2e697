/** The tab that tracks the markers of the reader's fingertip in a video, images or the camera. */
import { PageProblem } from "../src/problem";
import { button, make, setText } from "../src/ui/dom";
import type { Engine } from "./engine";
import { dropZone, save } from "./files";
import { drawMarkers, NUMBERS } from "./markers";

/** Largest width of the tracked image (px); larger ones are scaled down. */
const WIDEST = 640;
/** Largest number of images in the table: ten minutes at 30 images a second. */
const MOST_ROWS = 18_000;

export class FingertipTab {
  readonly element: HTMLElement;
  readonly #engine: Engine;
  readonly #video = make("video", { muted: "", playsinline: "", hidden: "" });
  readonly #image = make("canvas", { role: "img", "aria-label": "Image of the fingertip with its markers" });
  readonly #status = make("p", { class: "note", role: "status", "aria-live": "polite" });
  readonly #rate = make("p", { class: "note" });
  readonly #save: HTMLButtonElement[];
  #layout = "";
  #located = false;
  /** Time (s) and the numbers of all markers of each tracked image. */
  #table: { time: number; markers: Float32Array }[] = [];
  /** Counts the sources, so that images of an earlier one are dropped. */
  #source = 0;
  #tracked = 0;
  #since = performance.now();

  constructor(engine: Engine) {
    this.#engine = engine;
    this.#video.muted = true;
    const text = "Drop a video or an image here, or choose one: ";
    const zone = dropZone("fingertip", "video/*,image/*", text, (file) => void this.#open(file));
    this.#save = [
      button("Save the layout", "Save the markers as a layout file for feeler sense", () =>
        save("layout.toml", this.#layout, "text/plain"),
      ),
      button("Save the table", "Save all tracked markers as a table", () =>
        save("markers.csv", this.#csv(), "text/csv"),
      ),
    ];
    this.element = make(
      "div",
      {},
      make(
        "p",
        {},
        "A fingertip with markers, such as TacTip, GelSight with dots, or your own: its markers are located in the first image, which must show it untouched, and tracked from there. No image leaves this computer.",
      ),
      zone,
      make(
        "div",
        { class: "orders" },
        button("Use the camera", "Use a camera of this computer", () => void this.#camera()),
        button(
          "Untouched now",
          "Take the current image as that of the untouched fingertip",
          () => (this.#located = false),
        ),
        button("Stop", "Stop the video or the camera", () => this.#stop("Stopped.")),
        ...this.#save,
      ),
      this.#status,
      make("div", { class: "picture" }, this.#image),
      this.#rate,
      this.#video,
    );
    this.#enable(false);
  }

  async #open(file: File): Promise<void> {
    this.#stop("");
    const url = URL.createObjectURL(file);
    if (file.type.startsWith("image/")) {
      const picture = new Image();
      picture.src = url;
      try {
        await picture.decode();
        this.#located = false;
        await this.#see(picture, picture.naturalWidth, picture.naturalHeight, 0);
      } catch (error) {
        setText(this.#status, problem(error, "This browser cannot read the image."));
      }
      return;
    }
    this.#video.src = url;
    await this.#play();
  }

  async #camera(): Promise<void> {
    this.#stop("");
    try {
      this.#video.srcObject = await navigator.mediaDevices.getUserMedia({ video: { width: WIDEST } });
    } catch (error) {
      setText(this.#status, `The camera cannot be used: ${error instanceof Error ? error.message : error}`);
      return;
    }
    await this.#play();
  }

  /** Tracks image after image until the video ends or another source is opened. */
  async #play(): Promise<void> {
    const source = ++this.#source;
    this.#located = false;
    this.#table = [];
    this.#tracked = 0;
    this.#since = performance.now();
    const video = this.#video;
    try {
      await video.play();
      while (source === this.#source && !video.ended) {
        if (video.videoWidth > 0)
          await this.#see(video, video.videoWidth, video.videoHeight, video.currentTime);
        await new Promise((resolve) => requestAnimationFrame(resolve));
      }
      if (source === this.#source)
        setText(this.#status, `The video has ended; ${this.#table.length} images were tracked.`);
    } catch (error) {
      if (source === this.#source) this.#stop(problem(error, "This browser cannot play the video."));
    }
  }

  async #see(picture: CanvasImageSource, width: number, height: number, time: number): Promise<void> {
    const scale = Math.min(1, WIDEST / width);
    const canvas = this.#image;
    [canvas.width, canvas.height] = [Math.round(scale * width), Math.round(scale * height)];
    const context = canvas.getContext("2d", { willReadFrequently: true });
    if (!context) throw new PageProblem("This browser cannot read images.");
    context.drawImage(picture, 0, 0, canvas.width, canvas.height);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const rgba = data.buffer as ArrayBuffer;
    if (!this.#located) {
      const located = await this.#engine.call("locate", { rgba, width: canvas.width, height: canvas.height });
      this.#located = true;
      this.#layout = located.layout;
      this.#table = [];
      this.#enable(true);
      const warnings = located.warnings.map((warning) => ` Warning: ${warning}.`);
      setText(this.#status, `${located.markers} markers.${warnings.join("")}`);
    }
    const markers = await this.#engine.call("track", { rgba });
    drawMarkers(context, markers);
    if (this.#table.length < MOST_ROWS) this.#table.push({ time, markers });
    const seconds = (performance.now() - this.#since) / 1000;
    setText(this.#rate, `${(++this.#tracked / Math.max(seconds, 1e-3)).toFixed(0)} images per second`);
  }

  #stop(status: string): void {
    this.#source++;
    const stream = this.#video.srcObject;
    if (stream instanceof MediaStream) for (const track of stream.getTracks()) track.stop();
    this.#video.srcObject = null;
    this.#video.removeAttribute("src");
    setText(this.#status, status);
  }

  #enable(any: boolean): void {
    for (const save of this.#save) save.disabled = !any;
  }

  #csv(): string {
    const lines = ["time,marker,column_px,row_px,column_displacement_px,row_displacement_px,confidence"];
    for (const { time, markers } of this.#table) {
      for (let marker = 0; marker * NUMBERS < markers.length; marker++) {
        const numbers = markers.subarray(marker * NUMBERS, (marker + 1) * NUMBERS);
        lines.push([time.toFixed(4), marker, ...[...numbers].map((number) => number.toFixed(3))].join(","));
      }
    }
    return `${lines.join("\n")}\n`;
  }
}

function problem(error: unknown, otherwise: string): string {
  return error instanceof PageProblem ? error.message : otherwise;
}
