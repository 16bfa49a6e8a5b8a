// The player page: joins the world, shows its pictures, and sends what the player does.

import { Connection, ConnectionState } from "./connection";
import { Display, fitting_size } from "./display";
import { Hud, element } from "./hud";
import { Command, Input } from "./input";
import { label_keys } from "./layout";
import { Look } from "./look";
import { Overlay } from "./overlay";
import { Pointer } from "./pointer";
import { View, Welcome, is_token } from "./protocol";
import { page_options, recall, remember } from "./settings";
import { Session, expose_statistics } from "./statistics";
import { Touch } from "./touch";

const input_interval_ms = 1000 / 60;
const resize_settle_ms = 250;
const waiting_after_ms = 1500;
const rates_interval_ms = 500;

const options = page_options(window.location.search);
const look = new Look();
const view: View = { ...wanted_size(), region_colours: false, boundaries: false };

const stored_token = recall("sessionStorage", "token");
const session: Session = {
  token: is_token(stored_token) ? stored_token : null,
  player: null,
  resumed: false,
  status: null,
  item: 1,
  fps: null,
  bad_messages: 0,
  last_problem: null,
};
let first_picture = false;

const overlay = new Overlay({ on_start: start, on_retry: () => connection.connect() });
const hud = new Hud({ on_choose: choose });

const display = new Display(element("picture") as HTMLCanvasElement, {
  on_finished: (number) => connection.send_ack(number),
  on_problem: note_problem,
  on_first_picture: () => {
    first_picture = true;
    document.body.classList.add("has-picture");
  },
});

const scheme = window.location.protocol === "https:" ? "wss" : "ws";
const connection = new Connection(
  `${scheme}://${window.location.host}/ws`,
  () => ({ name: options.name, token: session.token, view }),
  {
    on_state: connection_changed,
    on_welcome: welcomed,
    on_waiting: (missing) => overlay.waiting_for(missing),
    on_status: (message) => {
      session.status = message;
      hud.status(message);
      if (message.notice) hud.note(message.notice);
    },
    on_picture: (picture) => display.offer(picture),
    on_refused: (sentence) => overlay.refused(sentence),
    on_problem: note_problem,
  },
);

const input = new Input({
  playing: () => !overlay.open,
  on_move: send_soon,
  on_command: obey,
});

const pointer = new Pointer(element("stage"), look, {
  playing: () => !overlay.open,
  on_look: send_soon,
  on_throw: throw_item,
  on_step: (direction) => choose(((session.item - 1 + direction + 4) % 4) + 1),
  on_state: (state) => {
    document.body.classList.toggle("captured", state === "locked");
    if (state === "released") input.release_all();
    invite();
  },
});

new Touch(element("stage"), element("touch-jump"), look, {
  playing: () => !overlay.open,
  on_keys: (bits) => input.set_touch_keys(bits),
  on_look: send_soon,
  on_throw: throw_item,
  on_first_touch: () => {
    document.body.classList.add("touch");
    invite();
  },
});

// Input: at once when the last message is old enough, otherwise as soon as it is; the newest state
// always arrives.
let sent_at_ms = 0;
let send_timer = 0;

function send_soon(): void {
  if (send_timer !== 0) return;
  const wait_ms = sent_at_ms + input_interval_ms - performance.now();
  if (wait_ms <= 0) send_input();
  else send_timer = window.setTimeout(send_input, wait_ms);
}

function send_input(): void {
  send_timer = 0;
  sent_at_ms = performance.now();
  const sent = connection.send_input(input.keys, look.yaw, look.pitch);
  // A full line: try again until it has room. After a lost connection the welcome sends what is
  // held.
  if (!sent && connection.state === "joined") send_timer = window.setTimeout(send_input, 50);
}

function throw_item(): void {
  if (connection.send_action("throw", look.yaw, look.pitch, session.item)) hud.thrown();
}

function obey(command: Command): void {
  switch (command.kind) {
    case "action":
      connection.send_action(command.action, look.yaw, look.pitch, session.item);
      return;
    case "choose":
      choose(command.item);
      return;
    case "boundaries":
      view.boundaries = !view.boundaries;
      view_changed(view.boundaries ? "Boundaries shown" : "Boundaries hidden");
      return;
    case "colours":
      view.region_colours = !view.region_colours;
      view_changed(
        view.region_colours ? "Bodies coloured by region" : "Bodies in their own colours",
      );
      return;
    case "help":
      if (overlay.help_open) start();
      else open_help(false);
      return;
    case "fullscreen":
      if (document.fullscreenElement !== null) void document.exitFullscreen();
      else void enter_fullscreen();
      return;
  }
}

async function enter_fullscreen(): Promise<void> {
  try {
    // Some phones do not even have the function.
    await document.documentElement.requestFullscreen();
  } catch {
    hud.note("This browser does not allow full screen.");
  }
}

// As with input, the newest view always arrives.
let view_timer = 0;

function send_view(): void {
  window.clearTimeout(view_timer);
  if (!connection.send_view(view) && connection.state === "joined")
    view_timer = window.setTimeout(send_view, 50);
}

function view_changed(sentence: string): void {
  send_view();
  draw_toggles();
  hud.note(sentence);
}

function draw_toggles(): void {
  const fullscreen = document.fullscreenElement !== null;
  hud.toggles({ boundaries: view.boundaries, colours: view.region_colours, fullscreen });
}

function choose(chosen: number): void {
  session.item = chosen;
  hud.choose(session.item);
}

function open_help(first_time: boolean): void {
  overlay.show_help(first_time);
  input.release_all();
  pointer.release();
  invite();
}

/** Leaves the help and plays; called from a click or a key, so that the pointer may be captured. */
function start(): void {
  remember("localStorage", "seen-help", "1");
  overlay.hide_help();
  (document.activeElement as HTMLElement | null)?.blur();
  if (!document.body.classList.contains("touch")) pointer.capture();
  invite();
}

function invite(): void {
  const touch = document.body.classList.contains("touch");
  overlay.invite(!overlay.open && !touch && pointer.state === "released" && !options.autostart);
}

function welcomed(welcome: Welcome): void {
  const had_token = session.token !== null;
  session.token = welcome.token;
  remember("sessionStorage", "token", session.token);
  session.player = welcome.player;
  session.resumed = welcome.resumed;
  if (!welcome.resumed) look.set(welcome.yaw, 0);
  hud.welcome(welcome);
  hud.choose(session.item);
  document.title = `${welcome.world.name} · Aureole`;
  if (had_token && connection.reconnects > 0) {
    hud.note(session.resumed ? "Welcome back." : "The world went on without you: you start anew.");
  }
  send_view();
  send_input();
}

function connection_changed(state: ConnectionState): void {
  document.body.dataset["connection"] = state;
  if (state === "joined") overlay.connected();
  else {
    display.forget();
    hud.waiting(false);
    hud.rates(null, null);
  }
  // Before the very first welcome the page is still arriving, and says so in its own way.
  if (state === "lost") overlay.lost(session.player !== null);
  if (state === "refused") pointer.release();
  invite();
}

function note_problem(sentence: string): void {
  session.bad_messages++;
  session.last_problem = sentence;
}

function wanted_size(): { width: number; height: number } {
  return (
    options.size ??
    fitting_size(window.innerWidth, window.innerHeight, window.devicePixelRatio || 1)
  );
}

let resize_timer = 0;
window.addEventListener("resize", () => {
  window.clearTimeout(resize_timer);
  resize_timer = window.setTimeout(() => {
    const size = wanted_size();
    if (size.width === view.width && size.height === view.height) return;
    Object.assign(view, size);
    send_view();
  }, resize_settle_ms);
});
document.addEventListener("fullscreenchange", draw_toggles);

let counted = { shown: 0, at_ms: performance.now() };
window.setInterval(() => {
  const now_ms = performance.now();
  if (connection.lost_at_ms !== null) overlay.lost_for((now_ms - connection.lost_at_ms) / 1000);
  const shown = display.frames_shown;
  session.fps = ((shown - counted.shown) * 1000) / (now_ms - counted.at_ms);
  counted = { shown, at_ms: now_ms };
  if (connection.state !== "joined") return;
  hud.rates(session.fps, connection.rtt_ms);
  // A view in which nothing moves may need no new picture; only a first picture that is late is
  // worth a word.
  hud.waiting(
    !first_picture ||
      (session.status !== null &&
        session.status.fps > 0 &&
        now_ms - display.last_arrival_ms > waiting_after_ms),
  );
}, rates_interval_ms);

for (const kind of ["boundaries", "colours", "help", "fullscreen"] as const) {
  element(`toggle-${kind}`).addEventListener("click", () => obey({ kind }));
}
for (const action of ["grab", "blast"] as const) {
  element(`touch-${action}`).addEventListener("click", () => obey({ kind: "action", action }));
}

// What the key R does, for those who have none.
element("again").addEventListener("click", () => {
  obey({ kind: "action", action: "respawn" });
  start();
});

expose_statistics({ display, connection, input, look, pointer, view, session });
void label_keys();
// Where fingers are the rule, their buttons are there before the first touch.
if (window.matchMedia("(pointer: coarse)").matches) document.body.classList.add("touch");
draw_toggles();
hud.choose(session.item);
if (!options.autostart && recall("localStorage", "seen-help") === null) open_help(true);
invite();
connection.connect();
