/** Five lessons, each with a task that the page checks. */
import { button, make, setText } from "../src/ui/dom";
import type { RunSettings } from "./protocol";
import { shownClaims, type Summary } from "./result";
import type { RunTab } from "./run_tab";
import type { PageSettings } from "./settings_link";

interface Lesson {
  title: string;
  text: string[];
  /** Settings that the lesson starts with. */
  start: Partial<PageSettings>;
  task: string;
  /** The answer to a finished run: whether it solves the task, and why. */
  check(summary: Summary, settings: RunSettings): [solved: boolean, text: string];
}

const CAP: Partial<PageSettings> = {
  experiment: "cap-closing",
  seed: 0,
  sensing: "direct",
  set: [],
  compare: "",
};
const percent = (share: number) => `${(100 * share).toFixed(0)} %`;
const millimetres = (length: number | null) => `${(1e3 * (length ?? 0)).toFixed(2)} mm`;
const degrees = (angle: number | null) => ((angle ?? 0) * 180) / Math.PI;
const mean = (values: number[]) => values.reduce((sum, value) => sum + value, 0) / Math.max(1, values.length);

const LESSONS: Lesson[] = [
  {
    title: "What SLIP sees",
    text: [
      "Each fingertip has 41 rubber feelers. While a finger drags the cap, its feelers bend: the tangential force on them grows. If a feeler lets go, that force drops at once.",
      "SLIP is raised when the tangential force of the most loaded feeler changes faster than the threshold dr. A threshold that is too high misses slips; one that is too low takes ordinary loading for a slip.",
    ],
    start: CAP,
    task: "Find a slip threshold with which the hand misses the slips: SLIP in less than 5 % of the last stroke, although the fingers truly slip.",
    check({ strokes }) {
      const last = strokes.at(-1);
      if (!last) return [false, "The run has no stroke."];
      const text = `In the last stroke, SLIP was raised in ${percent(last.slip_fraction)} of the time; the fingers truly slipped in ${percent(last.true_slip_fraction ?? 0)}.`;
      return [last.slip_fraction < 0.05 && (last.true_slip_fraction ?? 0) > 0.05, text];
    },
  },
  {
    title: "Why the path bends",
    text: [
      "The plan of each finger is a straight line. When a fingertip slips along the round cap, its contact force falls, and the law of the paper presses the finger inwards (re-compression). Step by step, the straight line becomes an arc that follows the cap: the hand has found the cap's shape by touch.",
    ],
    start: CAP,
    task: "Let the fingers follow a cap of another radius (at least 10 % off), and still bend inwards by more than 1 mm in the last stroke.",
    check({ strokes }, { set }) {
      const bend = strokes.at(-1)?.path_inward_bend ?? null;
      const radius = Number(
        set.find((setting) => setting.includes("cylinder.radius"))?.split("=")[1] ?? 0.014,
      );
      const text = `The cap's radius is ${millimetres(radius)}; the path bends inwards by ${millimetres(bend)} in the last stroke.`;
      return [Math.abs(radius / 0.014 - 1) >= 0.1 && (bend ?? 0) > 1e-3, text];
    },
  },
  {
    title: "What happens without shear",
    text: [
      "A fingertip that only feels pressure cannot see slip before the grip is lost. The law “normal-only” has no tangential forces: it assumes a friction and presses accordingly. The law “open-loop” follows its plan blindly.",
    ],
    start: { ...CAP, compare: "open-loop" },
    task: "Run a law without shear (“normal-only” or “open-loop”) in which fewer claims hold than with the tri-axial law.",
    check(summary, { set }) {
      const claims = shownClaims(summary);
      const held = claims.filter(({ holds }) => holds).length;
      const blind = set.some((setting) => /law="(normal-only|open-loop)"/.test(setting));
      const law = blind ? "without shear" : "with shear";
      return [blind && held < claims.length, `The law ${law}: ${held} of ${claims.length} claims hold.`];
    },
  },
  {
    title: "How a closed cap is noticed",
    text: [
      "In the first stroke the cap turns with the fingers, against little torque. When it meets its seat, torque rises and the cap stops: now every stroke slips from its start. The hand needs no torque sensor to notice: the slips tell.",
    ],
    start: CAP,
    task: "Compare the first and the last stroke of the reference run: the cap must turn in the first and stand still (below 1°) in the last, with more than twice the slip.",
    check({ strokes }) {
      const [first, last] = [strokes[0], strokes.at(-1)];
      if (!first || !last) return [false, "The run has no stroke."];
      const [turned, stood] = [degrees(first.cap_turn), degrees(last.cap_turn)];
      const text = `The cap turned by ${turned.toFixed(1)}° in the first stroke and ${stood.toFixed(1)}° in the last; SLIP in ${percent(first.slip_fraction)} and ${percent(last.slip_fraction)} of the time.`;
      return [turned > 5 && stood < 1 && last.slip_fraction > 2 * first.slip_fraction, text];
    },
  },
  {
    title: "How to break it",
    text: [
      "A controller is only as good as the conditions it survives. Make the rubber slippery, the cap small or off centre, or the feelers soft, until the hand cannot close the cap any more.",
    ],
    start: CAP,
    task: "Find settings with which the cap is turned by less than half of the usual 50°, or the run is given up.",
    check({ cap_angle, state, reason, strokes }) {
      const turned = degrees(cap_angle);
      const slips = mean(strokes.map(({ slip_fraction }) => slip_fraction));
      const text = `The run is ${state}${reason ? `: ${reason}` : ""}. The cap turned by ${turned.toFixed(1)}°; SLIP in ${percent(slips)} of the strokes.`;
      return [turned < 25 || state !== "done", text];
    },
  },
];

/** Shows the lessons; `open` brings the tab of runs to the front. */
export function lessonsTab(runs: RunTab, open: () => void): HTMLElement {
  let current: { lesson: Lesson; answer: HTMLElement } | undefined;
  runs.onFinished((settings, summary) => {
    if (!current) return;
    const [solved, text] = current.lesson.check(summary, settings);
    setText(current.answer, `${solved ? "✓ Solved." : "Not yet."} ${text}`);
    current.answer.className = `answer ${solved ? "holds" : "fails"}`;
  });
  const lessons = LESSONS.map((lesson, place) => {
    const answer = make("p", { class: "answer", role: "status", "aria-live": "polite" });
    const begin = button("Start", `Start the lesson “${lesson.title}”`, () => {
      current = { lesson, answer };
      setText(answer, "The lesson is open: change the settings, run, and come back for the answer.");
      answer.className = "answer";
      open();
      void runs.start(lesson.start, 4);
    });
    return make(
      "section",
      { class: "lesson" },
      make("h2", {}, `${place + 1}. ${lesson.title}`),
      ...lesson.text.map((text) => make("p", {}, text)),
      make("p", {}, make("b", {}, "Task: "), lesson.task),
      begin,
      answer,
    );
  });
  return make("div", {}, ...lessons);
}
