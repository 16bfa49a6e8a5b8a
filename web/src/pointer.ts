// The mouse: captured, it turns the view and its button throws. Where it cannot be captured,
// dragging turns the view.

import { Look } from "./look";

export type PointerState = "released" | "locked" | "free";

export interface PointerHandlers {
  playing(): boolean;
  on_look(): void;
  on_throw(): void;
  /** The wheel was turned by one notch: +1 is the next thing to throw, −1 the one before. */
  on_step(direction: number): void;
  on_state(state: PointerState): void;
}

const wheel_step_pixels = 50;
const drag_threshold_pixels = 5;

export class Pointer {
  private state_: PointerState = "released";
  private was_locked_ = false;
  private wheel_pixels_ = 0;
  private drag_ = { active: false, distance: 0 };

  constructor(
    private readonly target_: HTMLElement,
    private readonly look_: Look,
    private readonly handlers_: PointerHandlers,
  ) {
    document.addEventListener("pointerlockchange", () => this.lock_changed());
    document.addEventListener("pointerlockerror", () => this.lock_failed());
    document.addEventListener("mousemove", (event) => this.move(event));
    document.addEventListener("mouseup", (event) => this.lift(event));
    target_.addEventListener("mousedown", (event) => this.press(event));
    target_.addEventListener("contextmenu", (event) => event.preventDefault());
    window.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  get state(): PointerState {
    return this.state_;
  }

  /** Must come from a click or a key; the browser refuses it otherwise. */
  capture(): void {
    if (this.state_ === "locked") return;
    if (typeof this.target_.requestPointerLock !== "function") {
      this.lock_failed();
      return;
    }
    const ask = this.target_.requestPointerLock.bind(this.target_) as (
      options?: object,
    ) => Promise<void> | undefined;
    // Movement without the system's acceleration turns the view evenly; not every system offers it.
    void ask({ unadjustedMovement: true })?.catch((problem: unknown) => {
      const unsupported = problem instanceof DOMException && problem.name === "NotSupportedError";
      if (unsupported) void ask()?.catch(() => this.lock_failed());
      else this.lock_failed();
    });
  }

  release(): void {
    if (this.state_ === "locked") document.exitPointerLock();
    else this.set_state("released");
  }

  private lock_changed(): void {
    const locked = document.pointerLockElement === this.target_;
    if (locked) this.was_locked_ = true;
    this.set_state(locked ? "locked" : "released");
  }

  private lock_failed(): void {
    // Right after Escape browsers refuse for a second: another click will do. Where it never
    // worked, drag instead.
    if (!this.was_locked_) this.set_state("free");
  }

  private set_state(state: PointerState): void {
    if (state === this.state_) return;
    this.state_ = state;
    this.drag_.active = false;
    this.handlers_.on_state(state);
  }

  private press(event: MouseEvent): void {
    if (event.button !== 0 || !this.handlers_.playing()) return;
    event.preventDefault();
    if (this.state_ === "locked") this.handlers_.on_throw();
    else if (this.state_ === "free") this.drag_ = { active: true, distance: 0 };
    else this.capture();
  }

  private move(event: MouseEvent): void {
    const dragging = this.state_ === "free" && this.drag_.active;
    if (this.state_ !== "locked" && !dragging) return;
    this.drag_.distance += Math.abs(event.movementX) + Math.abs(event.movementY);
    this.look_.turn(event.movementX, event.movementY);
    this.handlers_.on_look();
  }

  private lift(event: MouseEvent): void {
    if (event.button !== 0 || !this.drag_.active) return;
    this.drag_.active = false;
    if (this.drag_.distance < drag_threshold_pixels) this.handlers_.on_throw();
  }

  private wheel(event: WheelEvent): void {
    // A dialog scrolls; pinching and Ctrl+wheel zoom the page.
    if (!this.handlers_.playing() || event.ctrlKey) return;
    event.preventDefault();
    this.wheel_pixels_ +=
      event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY : event.deltaY * 40;
    if (Math.abs(this.wheel_pixels_) < wheel_step_pixels) return;
    this.handlers_.on_step(Math.sign(this.wheel_pixels_));
    this.wheel_pixels_ = 0;
  }
}
