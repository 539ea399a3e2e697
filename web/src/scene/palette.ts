/** Materials of a scene and their colours in light and dark themes. */
import { Color, FrontSide, LineBasicMaterial, MeshBasicMaterial, MeshLambertMaterial } from "three";
import { fingerColour, pageColour } from "../ui/colours";

export class Palette {
  readonly object = new MeshLambertMaterial();
  readonly mark = new MeshLambertMaterial();
  readonly fixture = new MeshLambertMaterial();
  readonly contour = new LineBasicMaterial();
  readonly grid = new LineBasicMaterial({ transparent: true, opacity: 0.6 });
  readonly #links = new Map<number | undefined, MeshLambertMaterial>();
  readonly #domes = new Map<number, MeshLambertMaterial>();
  readonly #arrows = new Map<number, MeshBasicMaterial>();
  readonly resting = new Color();

  link(finger: number | undefined): MeshLambertMaterial {
    return kept(this.#links, finger, () => new MeshLambertMaterial());
  }

  /** Translucent rubber, through which elements and forces are visible. */
  dome(finger: number): MeshLambertMaterial {
    const clear = { transparent: true, opacity: 0.28, depthWrite: false, side: FrontSide };
    return kept(this.#domes, finger, () => new MeshLambertMaterial(clear));
  }

  arrow(finger: number): MeshBasicMaterial {
    return kept(this.#arrows, finger, () => new MeshBasicMaterial());
  }

  /** Applies the colours of the current theme. */
  paint(dark: boolean): void {
    this.object.color.set(dark ? "#b9b4a6" : "#e9e4d4");
    this.mark.color.set(dark ? "#1d1d1d" : "#333333");
    this.fixture.color.set(dark ? "#59616b" : "#aab2bb");
    this.contour.color.set(pageColour("ink"));
    this.grid.color.set(pageColour("rule"));
    this.resting.set(dark ? "#8d98a3" : "#9aa4ae");
    const metal = new Color(dark ? "#79838e" : "#c3cad1");
    for (const [finger, material] of this.#links) {
      material.color.copy(metal);
      if (finger !== undefined) material.color.lerp(new Color(fingerColour(finger, dark)), 0.35);
    }
    for (const materials of [this.#domes, this.#arrows]) {
      for (const [finger, material] of materials) material.color.set(fingerColour(finger, dark));
    }
  }
}

function kept<K, V>(map: Map<K, V>, key: K, create: () => V): V {
  const value = map.get(key) ?? create();
  map.set(key, value);
  return value;
}
