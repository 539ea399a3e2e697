/** Mouse and touch gestures on a panel: one finger moves the cursor, two fingers zoom, a double tap resets. */

export interface Gestures {
  /** Moves the cursor to this position, in px from the panel's left and top. */
  point(x: number, y: number): void;
  /** Scales the axis so that the values at `from` appear at `to`: the two fingers of a pinch, in px from the left. */
  pinch(from: [number, number], to: [number, number]): void;
  reset(): void;
  /** A click or tap at this position, in px from the panel's left and top; not called at the end of a drag. */
  click(x: number, y: number): void;
}

/** Maximum time between two taps of a double tap (ms). */
const DOUBLE_TAP = 300;

export function startGestures(over: HTMLElement, gestures: Gestures): void {
  const fingers = new Map<number, number>();
  let lastTap = 0;
  // Vertical swipes still scroll the page.
  over.style.touchAction = "pan-y";
  const place = (event: MouseEvent): [number, number] => {
    const { left, top } = over.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  };
  const touch = (act: (event: PointerEvent) => void) => (event: PointerEvent) => {
    if (event.pointerType === "touch") act(event);
  };
  // uPlot suppresses the click at the end of a drag.
  over.addEventListener("click", (event) => gestures.click(...place(event)));
  over.addEventListener(
    "pointerdown",
    touch((event) => {
      fingers.set(event.pointerId, place(event)[0]);
      if (fingers.size > 1) return;
      if (event.timeStamp - lastTap < DOUBLE_TAP) gestures.reset();
      lastTap = event.timeStamp;
      gestures.point(...place(event));
    }),
  );
  over.addEventListener(
    "pointermove",
    touch((event) => {
      if (!fingers.has(event.pointerId)) return;
      const before = [...fingers.values()];
      fingers.set(event.pointerId, place(event)[0]);
      const after = [...fingers.values()];
      if (fingers.size === 1) gestures.point(...place(event));
      if (fingers.size === 2) gestures.pinch(before as [number, number], after as [number, number]);
    }),
  );
  for (const end of ["pointerup", "pointercancel"] as const) {
    over.addEventListener(
      end,
      touch((event) => fingers.delete(event.pointerId)),
    );
  }
}
