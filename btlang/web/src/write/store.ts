// Where missions are kept: in the library of a robot, or in a file on this computer. And drafts, in the browser.
import { request, RequestError } from "../api";
import type { Context } from "../view";

/**
 * A mission as it is kept. `revision` is that of the store, for a stale save to be noticed; `tree` and `copy` are the
 * files of a tree that it is written for, `problem` what went wrong beside it.
 */
export interface Kept {
  text: string;
  revision: number | string;
  tree?: string;
  copy?: string;
  problem?: string;
}

/** A save that was refused, since somebody else saved in between. */
export class Stale extends Error {
  constructor(
    message: string,
    readonly theirs: Kept,
  ) {
    super(message);
  }
}

/** One mission. Throws RequestError. */
export interface Store {
  readonly key: string;
  readonly name: string;
  load(): Promise<Kept>;
  /** Where the English of a tree is kept, if this is a tree. */
  english(): Store;
  /** Throws Stale, too. */
  save(text: string, revision: Kept["revision"]): Promise<Kept>;
}

/** A mission of the library, or the tests of one. */
export class LibraryStore implements Store {
  readonly key: string;
  private query: string;

  constructor(
    readonly context: Context,
    readonly name: string,
    private kind: "mission" | "test" = "mission",
  ) {
    this.key = `${kind}:${context.robot}:${name}`;
    this.query = context.robot ? `?robot=${encodeURIComponent(context.robot)}` : "";
  }

  /** From the list, since asking for one that isn't there is an error. */
  async load(): Promise<Kept> {
    const { data } = await request("GET", `/api/${this.kind}s${this.query}`);
    const found = (data[`${this.kind}s`] as { name: string; text: string; number: number }[]).find(({ name }) => name === this.name);
    return found ? { text: found.text, revision: found.number } : { text: "", revision: 0 };
  }

  english(): Store {
    return new LibraryStore(this.context, `${this.name} in English`);
  }

  async save(text: string, revision: Kept["revision"]): Promise<Kept> {
    try {
      const { data } = await request("PUT", this.path, { text, revision });
      return { text, revision: data[this.kind].number };
    } catch (error) {
      throw stale(error);
    }
  }

  private get path(): string {
    return `/api/${this.kind}s/${encodeURIComponent(this.name)}${this.query}`;
  }
}

/** A file that the server was started with. */
export class FileStore implements Store {
  readonly key: string;

  constructor(readonly name: string) {
    this.key = `file:${name}`;
  }

  async load(): Promise<Kept> {
    return known(await request("GET", this.path));
  }

  /** The server has it ready. */
  english(): Store {
    return this;
  }

  async save(text: string, revision: Kept["revision"]): Promise<Kept> {
    try {
      return { ...known(await request("PUT", this.path, { text, revision })), text };
    } catch (error) {
      throw stale(error);
    }
  }

  private get path(): string {
    return `/api/files/${encodeURIComponent(this.name)}`;
  }
}

/** A refusal that comes with what is kept by now. */
function stale(error: unknown): unknown {
  const kept = error instanceof RequestError && error.status === 409 ? error.data.data : null;
  return kept && typeof kept.diff === "string" ? new Stale((error as Error).message, { text: kept.text, revision: kept.revision }) : error;
}

function known({ data }: any): Kept {
  return { ...data, text: data.text ?? "" };
}

/** What somebody wrote and hasn't saved: it outlives the page, the connection and the server. */
export class Draft {
  constructor(private key: string) {}

  /** The draft, with the revision that it began from; null if there is none. */
  read(): Kept | null {
    try {
      return JSON.parse(localStorage.getItem(this.name) ?? "null");
    } catch {
      return null;
    }
  }

  write(kept: Kept): void {
    try {
      localStorage.setItem(this.name, JSON.stringify(kept));
    } catch {
      // the browser's store is full or shut: the page itself still has the text
    }
  }

  clear(): void {
    localStorage.removeItem(this.name);
  }

  private get name(): string {
    return `btlang.draft.${this.key}`;
  }
}
