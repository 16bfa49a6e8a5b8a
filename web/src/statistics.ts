// `window.aureole`: what the page knows, read-only, for tests and for curious players.

import { Connection } from "./connection";
import { Display } from "./display";
import { Input } from "./input";
import { Look } from "./look";
import { Pointer } from "./pointer";
import { Status, View } from "./protocol";

/** What the page knows of its player and of the world. */
export interface Session {
  token: string | null;
  player: string | null;
  /** Whether the last welcome went on with an avatar of before. */
  resumed: boolean;
  status: Status | null;
  /** What is thrown next, 1 … 4. */
  item: number;
  /** Pictures shown in the last second. */
  fps: number | null;
  /** Messages of the gateway that were skipped because they break the wire format. */
  bad_messages: number;
  last_problem: string | null;
}

interface Parts {
  display: Display;
  connection: Connection;
  input: Input;
  look: Look;
  pointer: Pointer;
  view: View;
  session: Session;
}

export function expose_statistics(parts: Parts): void {
  const { display, connection, input, look, pointer, view, session } = parts;
  const values: Record<string, () => unknown> = {
    frames_decoded: () => display.frames_decoded,
    frames_shown: () => display.frames_shown,
    frames_dropped: () => display.frames_dropped,
    last_picture: () => display.last_picture && { ...display.last_picture },
    fps: () => session.fps,
    rtt_ms: () => connection.rtt_ms,
    status: () => session.status && { ...session.status },
    connected: () => connection.state === "joined",
    state: () => connection.state,
    reconnects: () => connection.reconnects,
    token: () => session.token,
    player: () => session.player,
    resumed: () => session.resumed,
    item: () => session.item,
    keys: () => input.keys,
    yaw: () => look.yaw,
    pitch: () => look.pitch,
    view: () => ({ ...view }),
    pointer: () => pointer.state,
    bad_messages: () => session.bad_messages,
    last_problem: () => session.last_problem,
  };
  const statistics = {};
  for (const [name, get] of Object.entries(values)) {
    Object.defineProperty(statistics, name, { get, enumerable: true });
  }
  Object.defineProperty(window, "aureole", { value: Object.freeze(statistics) });
}
