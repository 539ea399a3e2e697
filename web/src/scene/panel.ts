/** The scene in the document: canvas, buttons and colour key. */
import type { Scene } from "../page_data";
import { significant } from "../format";
import { guarded } from "../problem";
import type { FingerColumns, Run } from "../run";
import { OVER_COLOUR, SLIP_COLOUR, TOUCH_COLOUR } from "../ui/colours";
import { button, make } from "../ui/dom";
import { ARROW_LENGTH } from "./elements";
import { GRID, Model } from "./model";
import { SceneView } from "./view";

export interface ScenePanel {
  element: HTMLElement;
  view: SceneView | undefined;
  model: Model | undefined;
}

export function scenePanel(scene: Scene, run: Run, fingers: FingerColumns[]): ScenePanel {
  const canvas = make("canvas", { role: "img", "aria-label": description(scene) });
  const holder = make("div", { class: "scene-canvas" }, canvas);
  const element = make("div", { class: "scene-view" }, holder, key());
  const made = guarded(holder, () => {
    const model = new Model(scene, run, fingers);
    return { model, view: new SceneView(canvas, model, scene.home) };
  });
  if (!made) {
    canvas.remove();
    holder.classList.add("without");
  } else {
    holder.append(buttons(made.view));
  }
  return { element, view: made?.view, model: made?.model };
}

function description(scene: Scene): string {
  const names = scene.fingers.map((finger) => finger.name).join(", ");
  return `3-D scene at the current time: ${names}, the object, and the force on each sensing element.`;
}

function buttons(view: SceneView): HTMLElement {
  return make(
    "div",
    { class: "scene-buttons" },
    button("⌂", "Home view (H)", () => view.goHome()),
    button("+", "Zoom in", () => view.zoom(0.8)),
    button("−", "Zoom out", () => view.zoom(1.25)),
  );
}

function key(): HTMLElement {
  const state = (colour: string, name: string) =>
    make("span", {}, make("i", { class: "spot", style: `background:${colour}` }), name);
  return make(
    "p",
    { class: "scene-key" },
    state(TOUCH_COLOUR, "touching"),
    state(SLIP_COLOUR, "touching, SLIP"),
    state(OVER_COLOUR, "above F2 (larger)"),
    make("span", {}, `10\u00a0mm arrow: ${significant(0.01 / ARROW_LENGTH)}\u00a0N`),
    make("span", {}, `grid: ${significant(1e3 * GRID)}\u00a0mm`),
    make("span", {}, "dots: path of the touching tips in this stroke"),
  );
}
