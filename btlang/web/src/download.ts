// Files for the computer of whoever reads: their names, and the menu that offers them.
import { h, type MenuItem } from "./dom";
import { t, type Key } from "./texts";
import { asPng, asSvg } from "./tree/picture";
import type { TreeView } from "./tree/tree_view";

const LONGEST = 60; // characters of the words in a name

/** What can be had: its name in the menu, the kind of file, and its content, or an address of this server that has it. */
export interface Offer {
  key: Key;
  ending: string;
  content: () => Promise<Blob | string>;
}

/** A tree as it's drawn, with its statuses. */
export const pictures = (tree: TreeView): Offer[] => [
  { key: "download.svg", ending: "svg", content: async () => asSvg(tree.shown) },
  { key: "download.png", ending: "png", content: () => asPng(asSvg(tree.shown)) },
];

/** The lines of a menu for files, which are named after the words and the moment (seconds since 1970) that `named` gives. */
export function downloadItems(named: () => [words: string, seconds: number], offers: Offer[], fail: (problem: string) => void): MenuItem[] {
  const give = async ({ ending, content }: Offer): Promise<void> => {
    try {
      save(fileName(...named(), ending), await content());
    } catch (error) {
      fail((error as Error).message);
    }
  };
  return offers.map((offer) => ({ label: t(offer.key), run: () => void give(offer) }));
}

/** A name that every computer takes: letters, digits and dashes, the time of the day, an ending. */
export function fileName(words: string, seconds: number, ending: string): string {
  const said = words.normalize("NFC").replace(/[^\p{L}\p{N}]+/gu, "-").slice(0, LONGEST).replace(/^-+|-+$/g, "");
  const at = new Date(seconds * 1000);
  const two = (number: number): string => String(number).padStart(2, "0");
  const day = [at.getFullYear(), two(at.getMonth() + 1), two(at.getDate())].join("-");
  return `${said || "mission"}-${day}-${two(at.getHours())}${two(at.getMinutes())}${two(at.getSeconds())}.${ending}`;
}

/** Keeps something, or what is at an address of this server. */
function save(name: string, content: Blob | string): void {
  const made = typeof content === "string" ? null : URL.createObjectURL(content);
  const link = h("a", { href: made ?? String(content), download: name });
  link.click();
  if (made) setTimeout(() => URL.revokeObjectURL(made), 10_000);
}

/** A text as the content of a file. */
export const textBlob = (text: string): Blob => new Blob([text], { type: "text/plain;charset=utf-8" });
