// What somebody writes, kept in a store: saved unless somebody else saved in between, and a draft in the browser until then.
import { t } from "../texts";
import type { Editor } from "./editor";
import { merge } from "./merge";
import { Draft, Stale, type Kept, type Store } from "./store";

const DRAFT_AFTER = 300; // milliseconds after a key

/** `told` is called when it may be saved or not any more, `failed` with what went wrong, "" for nothing. */
export interface Listener {
  told: () => void;
  failed: (problem: string) => void;
}

/** An editor is for reading alone until what is kept is in it. */
export class SavedMission {
  kept: Kept = { text: "", revision: 0 };
  draft: Draft;
  private writing: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private store: Store,
    private editor: Editor,
    private listener: Listener,
  ) {
    this.draft = new Draft(store.key);
  }

  get name(): string {
    return this.store.name;
  }

  get isChanged(): boolean {
    return this.editor.text !== this.kept.text;
  }

  /** Whether it is saved, in words: "" for what never was. */
  get state(): string {
    return this.isChanged ? t("write.changed") : this.kept.revision ? t("write.saved") : "";
  }

  /** What the store has. Throws RequestError. */
  async load(): Promise<Kept> {
    return (this.kept = await this.store.load());
  }

  /** Keeps it where the English of a tree is kept from now on. Throws RequestError. */
  async loadEnglish(): Promise<Kept> {
    const beside = this.store.english();
    this.kept = await beside.load();
    this.store = beside;
    this.draft = new Draft(beside.key);
    return this.kept;
  }

  /** The text has changed. */
  changed(): void {
    clearTimeout(this.writing);
    this.writing = setTimeout(() => this.keepDraft(), DRAFT_AFTER);
    this.listener.told();
  }

  keepDraft(): void {
    clearTimeout(this.writing);
    if (!this.editor.view.state.readOnly && this.isChanged) this.draft.write({ text: this.editor.text, revision: this.kept.revision });
  }

  /** Saves the text, or lets somebody merge it with what is kept by now. */
  async save(): Promise<void> {
    const text = this.editor.text;
    try {
      this.kept = { ...this.kept, problem: "", ...(await this.store.save(text, this.kept.revision)) };
      if (this.editor.text === text) this.draft.clear();
      this.listener.failed("");
    } catch (error) {
      this.keepDraft();
      if (error instanceof Stale && error.theirs.text === text) {
        this.kept = { ...this.kept, ...error.theirs }; // an earlier save arrived, but not its answer
        this.draft.clear();
        this.listener.failed("");
      } else if (error instanceof Stale) {
        merge(error.message, error.theirs, text, (merged, from) => {
          this.kept = { ...this.kept, ...from };
          this.editor.text = merged;
          this.listener.told();
        });
      } else this.listener.failed(`${t("write.not_saved")} ${(error as Error).message}`);
    }
    this.listener.told();
  }
}
