/** Files that the reader drops or chooses, and files that the page saves. */
import { make } from "../src/ui/dom";

/** An area to drop or choose a file, which is passed to `open`. `id` is the input element's. */
export function dropZone(id: string, accept: string, text: string, open: (file: File) => void): HTMLElement {
  const input = make("input", { type: "file", id, accept });
  const first = (files: FileList | null | undefined) => files?.[0] && open(files[0]);
  input.addEventListener("change", () => first(input.files));
  const zone = make("div", { class: "drop" }, make("label", { for: id }, text), input);
  zone.addEventListener("dragover", (event) => event.preventDefault());
  zone.addEventListener("drop", (event) => {
    event.preventDefault();
    first(event.dataTransfer?.files);
  });
  return zone;
}

/** Lets the browser save `content` as a file. */
export function save(name: string, content: BlobPart, type: string): void {
  const link = make("a", { download: name });
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.click();
  // A download that has started no longer needs the address.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
