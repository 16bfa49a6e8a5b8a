// What is shown around the picture: numbers, the region, what is thrown next, what is carried, and
// passing notes.

import { icon_of } from "./icons";
import { Region, Status, Welcome } from "./protocol";

export function element(id: string): HTMLElement {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`index.html has no element #${id}`);
  return found;
}

export interface HudHandlers {
  on_choose(item: number): void;
}

const note_ms = 3600;
const notes_max = 3;

export class Hud {
  private regions_: Region[] = [];
  private throwables_ = "";
  private region_ = "";

  constructor(private readonly handlers_: HudHandlers) {}

  welcome(welcome: Welcome): void {
    this.regions_ = welcome.regions;
    this.region_ = "";
    text("world-name", welcome.world.name);
    text("world-description", welcome.world.description);
    const throwables = welcome.throwables.slice(0, 4);
    if (throwables.join("\n") === this.throwables_) return;
    this.throwables_ = throwables.join("\n");
    element("throwables").replaceChildren(...throwables.map((name, i) => this.slot(name, i + 1)));
  }

  status(status: Status): void {
    text("stat-players", String(status.players));
    text("stat-bodies", grouped(status.bodies));
    text("stat-awake", grouped(status.awake));
    text("stat-quality", String(Math.round(status.quality)));
    element("carrying").hidden = !status.carrying;
    text("touch-grab", status.carrying ? "Let go" : "Grab");
    const missing = status.regions - status.regions_up;
    element("regions-down").hidden = missing <= 0;
    text("regions-down-text", `${status.regions_up} of ${status.regions} regions up`);
    if (status.region === this.region_) return;
    this.region_ = status.region;
    text("stat-region", status.region || "–");
    const colour = this.regions_.find((region) => region.name === status.region)?.colour;
    element("region-mark").style.setProperty("--region", colour ?? "#9aa4b2");
  }

  /** Pictures shown in the last second, and the round trip. */
  rates(fps: number | null, rtt_ms: number | null): void {
    text("stat-fps", fps === null ? "–" : String(Math.round(fps)));
    text("stat-rtt", rtt_ms === null ? "–" : rtt_ms < 9.95 ? rtt_ms.toFixed(1) : rtt_ms.toFixed(0));
  }

  choose(item: number): void {
    for (const slot of Array.from(element("throwables").children)) {
      const chosen = slot.getAttribute("data-item") === String(item);
      slot.setAttribute("aria-pressed", String(chosen));
    }
  }

  /** Lets the chosen slot light up for a moment. */
  thrown(): void {
    const slot = element("throwables").querySelector('[aria-pressed="true"]');
    slot?.classList.remove("thrown");
    void slot?.getBoundingClientRect();
    slot?.classList.add("thrown");
  }

  toggles(state: { boundaries: boolean; colours: boolean; fullscreen: boolean }): void {
    element("toggle-boundaries").setAttribute("aria-pressed", String(state.boundaries));
    element("toggle-colours").setAttribute("aria-pressed", String(state.colours));
    element("toggle-fullscreen").setAttribute("aria-pressed", String(state.fullscreen));
  }

  waiting(is_waiting: boolean): void {
    element("waiting").hidden = !is_waiting;
  }

  note(sentence: string): void {
    const holder = element("notes");
    const note = document.createElement("p");
    note.textContent = sentence;
    holder.append(note);
    while (holder.children.length > notes_max) holder.firstElementChild?.remove();
    window.setTimeout(() => note.classList.add("leaving"), note_ms);
    window.setTimeout(() => note.remove(), note_ms + 400);
  }

  private slot(name: string, item: number): HTMLElement {
    const slot = document.createElement("button");
    slot.type = "button";
    slot.tabIndex = -1;
    slot.setAttribute("data-item", String(item));
    slot.setAttribute("aria-label", `Throw: ${name}`);
    const key = document.createElement("kbd");
    key.textContent = String(item);
    const label = document.createElement("span");
    label.textContent = name;
    slot.append(key, icon_of(name), label);
    slot.addEventListener("click", () => this.handlers_.on_choose(item));
    return slot;
  }
}

function text(id: string, value: string): void {
  const target = element(id);
  if (target.textContent !== value) target.textContent = value;
}

/** 12345 becomes 12 345 with a thin space. */
function grouped(value: number): string {
  return String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, "\u2009");
}
