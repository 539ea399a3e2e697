import { PageProblem } from "./problem";

/** Decodes base64 and decompresses raw deflate data. */
export async function inflate(base64: string): Promise<Uint8Array> {
  if (typeof DecompressionStream === "undefined") {
    throw new PageProblem(
      "This browser cannot decompress the run's data: it lacks DecompressionStream (2023). See the static figures below.",
    );
  }
  try {
    const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new PageProblem("The run's data in this file are damaged and cannot be decompressed.");
  }
}
