// A mission in the fragment of an address: compressed, in base64 for addresses. No server gets a fragment.

export const MOST = 20_000; // characters; as MOST_CHARACTERS in btlang/playground/playground.py
const LONGEST = 32_000; // characters of a fragment: all browsers keep so many
const NAME = "#mission=";

/** The fragment of a text; null if that would be too long. */
export async function fragmentOf(text: string): Promise<string | null> {
  if (text.length > MOST) return null;
  const packed = await collected(new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw")), Infinity);
  const letters = btoa(Array.from(packed!, (byte) => String.fromCharCode(byte)).join(""));
  const fragment = NAME + letters.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
  return fragment.length > LONGEST ? null : fragment;
}

/** The text of a fragment: "" if there is none in it, null if it can't be read, or is too long. */
export async function textOf(fragment: string): Promise<string | null> {
  if (!fragment.startsWith(NAME)) return "";
  if (fragment.length > LONGEST) return null;
  try {
    const letters = atob(fragment.slice(NAME.length).replaceAll("-", "+").replaceAll("_", "/"));
    const packed = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
    const found = await collected(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw")), 4 * MOST);
    const text = found && new TextDecoder("utf-8", { fatal: true }).decode(found);
    return text !== null && text.length <= MOST ? text : null;
  } catch {
    return null;
  }
}

/** All bytes of a stream; null as soon as they are too many. */
async function collected(stream: ReadableStream<Uint8Array<ArrayBuffer>>, most: number): Promise<Uint8Array<ArrayBuffer> | null> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let length = 0;
  const reader = stream.getReader();
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    parts.push(next.value);
    if ((length += next.value.length) > most) {
      await reader.cancel();
      return null;
    }
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}
