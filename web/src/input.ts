// The keyboard: which movement keys are held, and what a press of the others means. Keys are
// places, not letters (`code`).

import { ActionName, Key } from "./protocol";

export type Command =
  | { kind: "action"; action: Exclude<ActionName, "throw"> }
  | { kind: "choose"; item: number }
  | { kind: "boundaries" | "colours" | "help" | "fullscreen" };

export interface InputHandlers {
  /** False while a dialog is open: then keys belong to the dialog. */
  playing(): boolean;
  on_move(): void;
  on_command(command: Command): void;
}

const movement: Readonly<Record<string, number>> = {
  KeyW: Key.forward,
  ArrowUp: Key.forward,
  KeyS: Key.back,
  ArrowDown: Key.back,
  KeyA: Key.left,
  ArrowLeft: Key.left,
  KeyD: Key.right,
  ArrowRight: Key.right,
  Space: Key.jump,
  ShiftLeft: Key.sprint,
  ShiftRight: Key.sprint,
};

const commands: Readonly<Record<string, Command>> = {
  KeyE: { kind: "action", action: "grab" },
  KeyQ: { kind: "action", action: "blast" },
  KeyR: { kind: "action", action: "respawn" },
  KeyB: { kind: "boundaries" },
  KeyC: { kind: "colours" },
  KeyF: { kind: "fullscreen" },
  KeyH: { kind: "help" },
  ...Object.fromEntries(
    [1, 2, 3, 4].flatMap((item) => [
      [`Digit${item}`, { kind: "choose", item }],
      [`Numpad${item}`, { kind: "choose", item }],
    ]),
  ),
};

export class Input {
  private readonly held_ = new Set<string>();
  private touch_keys_ = 0;

  constructor(private readonly handlers_: InputHandlers) {
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("keyup", (event) => this.lift(event));
    window.addEventListener("blur", () => this.release_all());
    document.addEventListener("visibilitychange", () => this.release_all());
  }

  /**
   * The bits of `input.keys`. Two codes may mean one bit, so the bits are made from what is held.
   */
  get keys(): number {
    let bits = this.touch_keys_;
    for (const code of this.held_) bits |= movement[code] ?? 0;
    return bits;
  }

  set_touch_keys(bits: number): void {
    if (bits === this.touch_keys_) return;
    this.touch_keys_ = bits;
    this.handlers_.on_move();
  }

  release_all(): void {
    if (this.keys === 0) return;
    this.held_.clear();
    this.touch_keys_ = 0;
    this.handlers_.on_move();
  }

  private press(event: KeyboardEvent): void {
    // Shortcuts of the browser stay what they are.
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const command = commands[event.code];
    if (command?.kind === "help" && !event.repeat) {
      event.preventDefault();
      this.handlers_.on_command(command);
      return;
    }
    if (!this.handlers_.playing()) return;
    const moves = event.code in movement;
    if (moves || command !== undefined) event.preventDefault();
    if (event.repeat) return;
    if (moves) {
      this.held_.add(event.code);
      this.handlers_.on_move();
    } else if (command !== undefined) {
      this.handlers_.on_command(command);
    }
  }

  private lift(event: KeyboardEvent): void {
    if (this.held_.delete(event.code)) this.handlers_.on_move();
  }
}
