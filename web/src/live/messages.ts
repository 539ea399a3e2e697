/** Messages of a live page's socket. */
import type { LiveState } from "../page_data";
import { PageProblem } from "../problem";

export function readState(text: string): LiveState {
  let state: Partial<LiveState>;
  try {
    state = JSON.parse(text);
  } catch {
    throw new PageProblem("The hand sent a state that is not valid JSON.");
  }
  if (typeof state?.state !== "string" || typeof state.stopped !== "boolean") {
    throw new PageProblem("The hand sent a state that this page cannot read.");
  }
  const { answer } = state;
  return { state: state.state, stopped: state.stopped, over: state.over === true, ...(answer && { answer }) };
}
