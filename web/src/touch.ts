// Fingers: the left of the screen is a stick that walks, the rest of it turns the view, and a
// tap there throws.

import { Look } from "./look";
import { Key } from "./protocol";

export interface TouchHandlers {
  playing(): boolean;
  on_keys(bits: number): void;
  on_look(): void;
  on_throw(): void;
  on_first_touch(): void;
}

const dead_zone_pixels = 14;
const sprint_pixels = 70;
const tap_ms_max = 250;
const tap_pixels_max = 12;
const look_speed = 2.2;

interface Finger {
  role: "walk" | "look";
  start_x: number;
  start_y: number;
  x: number;
  y: number;
  began_ms: number;
  path: number;
}

export class Touch {
  private readonly fingers_ = new Map<number, Finger>();
  private touched_ = false;
  private jumping_ = false;

  constructor(
    target: HTMLElement,
    jump_button: HTMLElement,
    private readonly look_: Look,
    private readonly handlers_: TouchHandlers,
  ) {
    const active = { passive: false };
    target.addEventListener("touchstart", (event) => this.begin(event), active);
    target.addEventListener("touchmove", (event) => this.move(event), active);
    target.addEventListener("touchend", (event) => this.end(event, true), active);
    target.addEventListener("touchcancel", (event) => this.end(event, false), active);
    const jump = (down: boolean) => (event: Event) => {
      event.preventDefault();
      this.jumping_ = down;
      this.send_keys();
    };
    jump_button.addEventListener("pointerdown", jump(true));
    for (const name of ["pointerup", "pointercancel", "pointerleave"]) {
      jump_button.addEventListener(name, jump(false));
    }
  }

  private begin(event: TouchEvent): void {
    if (!this.touched_) this.handlers_.on_first_touch();
    this.touched_ = true;
    if (!this.handlers_.playing()) return;
    event.preventDefault();
    for (const touch of Array.from(event.changedTouches)) {
      const { identifier, clientX: x, clientY: y } = touch;
      const role = x < window.innerWidth * 0.4 ? "walk" : "look";
      this.fingers_.set(identifier, {
        role,
        start_x: x,
        start_y: y,
        x,
        y,
        began_ms: performance.now(),
        path: 0,
      });
    }
  }

  private move(event: TouchEvent): void {
    event.preventDefault();
    for (const touch of Array.from(event.changedTouches)) {
      const finger = this.fingers_.get(touch.identifier);
      if (finger === undefined) continue;
      const right = touch.clientX - finger.x;
      const down = touch.clientY - finger.y;
      finger.x = touch.clientX;
      finger.y = touch.clientY;
      finger.path += Math.abs(right) + Math.abs(down);
      if (finger.role === "look") {
        this.look_.turn(right, down, look_speed);
        this.handlers_.on_look();
      }
    }
    this.send_keys();
  }

  private end(event: TouchEvent, lifted: boolean): void {
    for (const touch of Array.from(event.changedTouches)) {
      const finger = this.fingers_.get(touch.identifier);
      if (finger === undefined) continue;
      event.preventDefault();
      this.fingers_.delete(touch.identifier);
      const short =
        performance.now() - finger.began_ms < tap_ms_max && finger.path < tap_pixels_max;
      if (lifted && finger.role === "look" && short) this.handlers_.on_throw();
    }
    this.send_keys();
  }

  private send_keys(): void {
    let bits: number = this.jumping_ ? Key.jump : 0;
    for (const finger of this.fingers_.values()) {
      if (finger.role !== "walk") continue;
      const right = finger.x - finger.start_x;
      const back = finger.y - finger.start_y;
      if (right > dead_zone_pixels) bits |= Key.right;
      if (right < -dead_zone_pixels) bits |= Key.left;
      if (back > dead_zone_pixels) bits |= Key.back;
      if (back < -dead_zone_pixels) bits |= Key.forward;
      if (Math.hypot(right, back) > sprint_pixels) bits |= Key.sprint;
    }
    this.handlers_.on_keys(bits);
  }
}
