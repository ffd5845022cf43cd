// What a robot without a speaker says, played in the page.
import { h, set } from "../dom";
import type { Entry } from "../fleet";
import { command } from "../tasks/queue";
import { t } from "../texts";
import type { Context } from "../view";

const KEPT = "btlang.muted";

export class Voice {
  readonly element = h("button", { type: "button", class: "mute", hidden: true, onclick: () => this.turn() }, t("watch.mute"));
  private audio: AudioContext | null = null;
  private playing: AudioBufferSourceNode | null = null;
  private refused = false; // this robot can't be heard here
  private latest = 0;

  constructor(private context: Context) {
    this.show();
  }

  /** Something happens on the robot. */
  note({ event }: Entry): void {
    if (event.event === "say") void this.say(event.text);
    if (event.event === "stop" || event.event === "end") this.silence();
  }

  silence(): void {
    this.latest++;
    this.playing?.stop();
    this.playing = null;
  }

  close(): void {
    this.silence();
    void this.audio?.close();
    this.audio = null;
  }

  private async say(text: string): Promise<void> {
    this.silence();
    if (this.refused || this.muted) return;
    const number = this.latest;
    try {
      const { wav, text: said, seconds } = await command(this.context, "voice");
      this.element.hidden = false;
      this.audio ??= new AudioContext();
      const bytes = Uint8Array.from(atob(wav), (letter) => letter.charCodeAt(0));
      const buffer = await this.audio.decodeAudioData(bytes.buffer);
      if (number !== this.latest || said !== text) return;
      this.playing = new AudioBufferSourceNode(this.audio, { buffer });
      this.playing.connect(this.audio.destination);
      this.playing.start(0, seconds);
    } catch {
      this.refused ||= this.element.hidden as boolean;
    }
  }

  private get muted(): boolean {
    return localStorage.getItem(KEPT) === "yes";
  }

  private turn(): void {
    localStorage.setItem(KEPT, this.muted ? "no" : "yes");
    if (this.muted) this.silence();
    this.show();
  }

  private show(): void {
    set(this.element, { "aria-pressed": String(this.muted) });
    if (this.muted) this.element.hidden = false;
  }
}
