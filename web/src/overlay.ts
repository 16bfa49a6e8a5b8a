// What lies over the picture: the help, the invitation to click, and the notices of a lost or
// refused connection.

import { element } from "./hud";

export interface OverlayHandlers {
  on_start(): void;
  on_retry(): void;
}

// The gateway keeps an avatar this long for a player whose connection was lost.
const grace_s = 30;

export class Overlay {
  private notice_: "none" | "lost" | "refused" = "none";
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

  get notice(): "none" | "lost" | "refused" {
    return this.notice_;
  }

  show_help(first_time: boolean): void {
    this.help_ = true;
    element("start").textContent = first_time ? "Step inside" : "Back to the game";
    this.draw();
    element("start").focus({ preventScroll: true });
  }

  hide_help(): void {
    this.help_ = false;
    this.draw();
  }

  /** The small invitation to click while the pointer is not captured. */
  invite(shown: boolean): void {
    element("resume").hidden = !shown;
  }

  lost(): void {
    if (this.notice_ === "lost") return;
    this.notice_ = "lost";
    element("notice-title").textContent = "Connection lost";
    element("retry").textContent = "Try now";
    this.lost_for(0);
    this.draw();
  }

  /** Tells how long the avatar will still be there. */
  lost_for(seconds: number): void {
    if (this.notice_ !== "lost") return;
    const left = Math.ceil(grace_s - seconds);
    element("notice-text").textContent =
      left > 0
        ? `Reconnecting. Your avatar waits for you for another ${left} s.`
        : "Still reconnecting. Your avatar has left the world by now; you will start anew.";
    element("notice-progress").style.setProperty("--left", String(Math.max(0, left / grace_s)));
  }

  refused(sentence: string): void {
    this.notice_ = "refused";
    element("notice-title").textContent = "The server closed the connection";
    element("notice-text").textContent = sentence;
    element("retry").textContent = "Try again";
    this.draw();
    element("retry").focus({ preventScroll: true });
  }

  connected(): void {
    this.notice_ = "none";
    this.draw();
  }

  private draw(): void {
    element("help").hidden = !this.help_ || this.notice_ === "refused";
    element("notice").hidden = this.notice_ === "none";
    element("notice").classList.toggle("refused", this.notice_ === "refused");
    document.body.classList.toggle("dimmed", this.notice_ !== "none");
  }
}
