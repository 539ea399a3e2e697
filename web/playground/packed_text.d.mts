export function pack(bytes: Uint8Array): string;
export function unpack(text: string): Uint8Array;
