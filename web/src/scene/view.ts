/** Scene view: camera and canvas; draws only after changes. */
import { PerspectiveCamera, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Scene } from "../page_data";
import { PageProblem } from "../problem";
import { isDark, onTheme } from "../ui/theme";
import type { Model } from "./model";
import { Resolution } from "./resolution";

/** Viewing direction of the home view: from the front, slightly left, from above. */
const HOME_DIRECTION = new Vector3(-0.35, -1, 0.75).normalize();

export class SceneView {
  readonly #model: Model;
  readonly #home: Scene["home"];
  readonly #renderer: WebGLRenderer;
  readonly #camera = new PerspectiveCamera(35, 1, 0.001, 10);
  readonly #controls: OrbitControls;
  readonly #resolution: Resolution;
  readonly #canvas: HTMLCanvasElement;
  #row = 0;
  #frame = 0;
  #visible = true;

  constructor(canvas: HTMLCanvasElement, model: Model, home: Scene["home"]) {
    this.#canvas = canvas;
    this.#model = model;
    this.#home = home;
    // Requested here, because the renderer would log an error to the console if there is no context.
    const context = canvas.getContext("webgl2", { antialias: true, alpha: true });
    if (!context) {
      throw new PageProblem(
        "The 3-D scene is not shown because this browser has no WebGL 2. The rest of the page works.",
      );
    }
    this.#renderer = new WebGLRenderer({ canvas, context, antialias: true, alpha: true });
    this.#resolution = new Resolution(this.#renderer, context, this.request);
    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.minDistance = 0.1 * home.radius;
    this.#controls.maxDistance = 20 * home.radius;
    this.#controls.addEventListener("change", this.request);
    this.#watch();
    this.#paint();
    // Compile now, so that the first touched element does not delay the page during a run.
    this.#renderer.compile(model.scene, this.#camera);
    this.goHome();
  }

  /** Shows a row. Draws immediately, so call it at most once per animation frame. */
  moveTo(row: number): void {
    this.#row = row;
    if (this.#visible) this.#draw();
  }

  goHome(): void {
    const { centre, radius } = this.#home;
    // The whole sphere must fit, also in a narrow window.
    const half = (0.5 * this.#camera.fov * Math.PI) / 180;
    const narrow = Math.min(1, this.#camera.aspect);
    const distance = radius / Math.sin(Math.atan(Math.tan(half) * narrow));
    this.#controls.target.set(...centre);
    this.#camera.position.set(...centre).addScaledVector(HOME_DIRECTION, distance);
    this.#controls.update();
    this.request();
  }

  /** Zooms in (factor below 1) or out (above 1). */
  zoom(factor: number): void {
    const { target, minDistance, maxDistance } = this.#controls;
    const offset = this.#camera.position.clone().sub(target).multiplyScalar(factor);
    offset.clampLength(minDistance, maxDistance);
    this.#camera.position.copy(target).add(offset);
    this.#controls.update();
    this.request();
  }

  readonly request = (): void => {
    if (this.#visible) this.#frame ||= requestAnimationFrame(this.#draw);
  };

  readonly #draw = (): void => {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    this.#model.moveTo(this.#row);
    this.#renderer.render(this.#model.scene, this.#camera);
    this.#resolution.drawn();
  };

  #watch(): void {
    const holder = this.#canvas.parentElement ?? this.#canvas;
    let first = true;
    new ResizeObserver(() => {
      const { clientWidth: width, clientHeight: height } = holder;
      if (width === 0 || height === 0) return;
      this.#camera.aspect = width / height;
      this.#camera.updateProjectionMatrix();
      this.#renderer.setSize(width, height, false);
      if (first) this.goHome();
      first = false;
      this.request();
    }).observe(holder);
    new IntersectionObserver(([entry]) => {
      this.#visible = entry?.isIntersecting ?? true;
      this.request();
    }).observe(holder);
    // The browser may drop and restore the context.
    this.#canvas.addEventListener("webglcontextrestored", this.request);
    onTheme(() => {
      this.#paint();
      this.moveTo(this.#row);
    });
  }

  #paint(): void {
    this.#model.paint(isDark());
  }
}
