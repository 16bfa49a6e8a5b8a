// What lies over the picture: the help, the invitation to click, and the notices of a world that is
// not complete and of a lost or refused connection.

import { element } from "./hud";

export interface OverlayHandlers {
  on_start(): void;
  on_retry(): void;
}

// The gateway keeps an avatar this long for a player whose connection was lost.
const grace_s = 30;
const missing_named_max = 3;

type Notice = "none" | "waiting" | "lost" | "refused";

export class Overlay {
  private notice_: Notice = "none";
  private has_avatar_ = false;
  private help_ = false;

  constructor(handlers: OverlayHandlers) {
    element("start").addEventListener("click", () => handlers.on_start());
    element("retry").addEventListener("click", () => handlers.on_retry());
    element("resume").addEventListener("click", () => handlers.on_start());
    element("help").addEventListener("mousedown", (event) => {
      // A click beside the card goes back to the game as well.
      if (event.target === element("help")) handlers.on_start();
    });
  }

  /** Whether keys and clicks belong to a dialog rather than to the game. */
  get open(): boolean {
    return this.help_ || this.notice_ === "refused";
  }

  get help_open(): boolean {
    return this.help_;
  }

  get notice(): Notice {
    return this.notice_;
  }

  show_help(first_time: boolean): void {
    this.help_ = true;
    element("start").textContent = first_time ? "Step inside" : "Back to the game";
    element("again").hidden = first_time;
    this.draw();
  }

  hide_help(): void {
    this.help_ = false;
    this.draw();
  }

  /** The small invitation to click while the pointer is not captured. */
  invite(shown: boolean): void {
    element("resume").hidden = !shown;
  }

  /** The player goes in by itself once these regions are there. */
  waiting_for(missing: string[]): void {
    this.notice_ = "waiting";
    const there = missing.length === 1 ? "it is" : "they are";
    const text = `Waiting for ${listed(missing)}. You go in as soon as ${there} there.`;
    this.write("The world is not complete yet", text);
    this.draw();
  }

  lost(has_avatar: boolean): void {
    if (this.notice_ === "lost") return;
    this.notice_ = "lost";
    this.has_avatar_ = has_avatar;
    if (has_avatar) this.write("Connection lost", "");
    else this.write("No answer yet", "The world does not answer yet. Trying again.");
    element("retry").textContent = "Try now";
    this.lost_for(0);
    this.draw();
  }

  /** Tells how long the avatar will still be there. */
  lost_for(seconds: number): void {
    if (this.notice_ !== "lost" || !this.has_avatar_) return;
    const left = Math.ceil(grace_s - seconds);
    element("notice-text").textContent =
      left > 0
        ? `Reconnecting. Your avatar waits for you for another ${left} s.`
        : "Still reconnecting. Your avatar has left the world by now; you will start anew.";
    element("notice-progress").style.setProperty("--left", String(Math.max(0, left / grace_s)));
  }

  refused(sentence: string): void {
    this.notice_ = "refused";
    this.write("The server closed the connection", sentence);
    element("retry").textContent = "Try again";
    this.draw();
    element("retry").focus({ preventScroll: true });
  }

  connected(): void {
    this.notice_ = "none";
    this.draw();
  }

  /** The ring is full until `lost_for` says otherwise. */
  private write(title: string, text: string): void {
    element("notice-title").textContent = title;
    element("notice-text").textContent = text;
    element("notice-progress").style.setProperty("--left", "1");
  }

  private draw(): void {
    const notice = element("notice");
    notice.hidden = this.notice_ === "none";
    notice.classList.toggle("waiting", this.notice_ === "waiting");
    notice.classList.toggle("refused", this.notice_ === "refused");
    element("retry").hidden = this.notice_ === "waiting";
    document.body.classList.toggle("dimmed", this.notice_ !== "none");
    // One card at a time: the help comes back after the notice.
    const help = element("help");
    const was_hidden = help.hidden;
    help.hidden = !this.help_ || this.notice_ !== "none";
    if (was_hidden && !help.hidden) element("start").focus({ preventScroll: true });
  }
}

/** "a", "a and b", "a, b and c", "a, b, c and 4 more". */
function listed(names: string[]): string {
  if (names.length === 0) return "the last regions";
  const more = names.length - missing_named_max;
  const parts = more > 0 ? [...names.slice(0, missing_named_max), `${more} more`] : [...names];
  const last = parts.pop();
  return parts.length === 0 ? `${last}` : `${parts.join(", ")} and ${last}`;
}
