import { PageProblem } from "./problem";

/** The bytes that are stored compressed (raw deflate) and in base64. */
export async function inflate(base64: string): Promise<Uint8Array> {
  if (typeof DecompressionStream === "undefined") {
    throw new PageProblem(
      "This browser cannot unpack the run's data: it lacks DecompressionStream (2023). The still figures are below.",
    );
  }
  try {
    const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new PageProblem("The run's data in this file are damaged and cannot be unpacked.");
  }
}
