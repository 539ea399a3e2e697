/** Settings of a run in the page's address, and as a command of the program. */
import type { RunSettings } from "./protocol";

/** Settings of the page: a run, and the law that it is compared with, if any. */
export interface PageSettings extends Required<RunSettings> {
  compare: string;
}

/** Start of the setting of the control law. */
const LAW = "control.law=";

/** Law that `set` chooses, or "" if it leaves the experiment's. */
export function lawOf(set: string[]): string {
  const setting = set.find((setting) => setting.startsWith(LAW));
  return setting?.slice(LAW.length).replaceAll('"', "") ?? "";
}

/** Settings with the given law; "" stands for the experiment's. */
export function withLaw(set: string[], law: string): string[] {
  const others = set.filter((setting) => !setting.startsWith(LAW));
  return law ? [`${LAW}"${law}"`, ...others] : others;
}

export function toHash({ experiment, seed, sensing, set, compare }: PageSettings): string {
  const parameters = new URLSearchParams({ experiment, seed: String(seed), sensing });
  for (const setting of set) parameters.append("set", setting);
  if (compare) parameters.set("compare", compare);
  return `#${parameters}`;
}

/** Settings in the page's address, as far as it has them. */
export function fromHash(hash: string): Partial<PageSettings> {
  const parameters = new URLSearchParams(hash.replace(/^#/, ""));
  const sensing = parameters.get("sensing");
  const seed = Number(parameters.get("seed") ?? Number.NaN);
  return {
    ...(parameters.has("experiment") && { experiment: parameters.get("experiment") ?? "" }),
    ...(Number.isSafeInteger(seed) && seed >= 0 && { seed }),
    ...((sensing === "direct" || sensing === "image") && { sensing }),
    set: parameters.getAll("set"),
    compare: parameters.get("compare") ?? "",
  };
}

/** The command that repeats a run, for a POSIX shell. */
export function toCommand({ experiment, seed, sensing, set }: Required<RunSettings>): string {
  const settings = set.map((setting) => `--set ${quoted(setting)}`);
  return ["feeler run", experiment, `--seed ${seed}`, `--sensing ${sensing}`, ...settings].join(" ");
}

function quoted(word: string): string {
  return /^[\w.=+-]+$/.test(word) ? word : `'${word.replaceAll("'", String.raw`'\''`)}'`;
}
