// The text of a mission, with the words of nodes marked.
import { fill, h } from "../dom";
import { t } from "../texts";

/** Where the text says a node: from a character to another one, null where it doesn't. */
export type Place = [start: number, end: number] | null;

/** A piece of a text in which something runs now, that somebody selected, or both. */
export type Piece = [start: number, end: number, kind: "runs" | "chosen" | "runs chosen"];

/** The pieces of a text to mark, in their order; none overlaps another one. */
export function pieces(running: readonly Place[], chosen: Place): Piece[] {
  const now = running.filter((place) => place !== null);
  const edges = [...new Set([...now, chosen ?? []].flat())].sort((one, other) => one - other);
  const holds = (places: readonly Place[], at: number): boolean => places.some((place) => place !== null && place[0] <= at && at < place[1]);
  return edges.slice(1).flatMap((end, index): Piece[] => {
    const start = edges[index]!;
    const runs = holds(now, start);
    if (holds([chosen], start)) return [[start, end, runs ? "runs chosen" : "chosen"]];
    return runs ? [[start, end, "runs"]] : [];
  });
}

/** The smallest node that is said at a character, -1 for none. */
export function nodeAt(nodes: readonly { start: number | null; end: number | null }[], at: number): number {
  let [best, size] = [-1, Infinity];
  nodes.forEach(({ start, end }, index) => {
    if (start === null || end === null || at < start || at > end || end - start >= size) return;
    [best, size] = [index, end - start];
  });
  return best;
}

export class Words {
  readonly element = h("pre", { class: "film-text", tabindex: 0, dir: "auto", lang: "en", "aria-label": t("write.text") });
  private shown = "";

  /** `choose` gets the number of the character that somebody clicks on. */
  constructor(choose?: (at: number) => void) {
    this.element.addEventListener("click", () => {
      const selection = getSelection();
      if (!choose || !selection?.isCollapsed || !selection.anchorNode || !this.element.contains(selection.anchorNode)) return;
      const before = document.createRange();
      before.setStart(this.element, 0);
      before.setEnd(selection.anchorNode, selection.anchorOffset);
      choose(before.toString().length);
    });
  }

  /** Shows a text with some pieces marked; brings the first of them into view. */
  show(text: string, marked: readonly Piece[]): void {
    const shown = JSON.stringify([text, marked]);
    if (this.shown === shown) return;
    this.shown = shown;
    const parts: (string | HTMLElement)[] = [];
    let done = 0;
    for (const [start, end, kind] of marked) {
      parts.push(text.slice(done, start), h("mark", { class: kind }, text.slice(start, end)));
      done = end;
    }
    fill(this.element, ...parts, text.slice(done));
    this.element.querySelector("mark")?.scrollIntoView({ block: "nearest" });
  }
}
