// The WebSocket to the gateway: joins, measures the round trip, and comes back by itself after the
// connection is lost.

import {
  ActionName,
  ClientMessage,
  Picture,
  ServerMessage,
  Status,
  View,
  Welcome,
  WireError,
  parse_picture,
  parse_server_message,
  protocol_version,
} from "./protocol";

/**
 * `waiting`: the gateway lets the player in once the world is complete. `refused`: it said why; only
 * the player can decide to try again.
 */
export type ConnectionState = "connecting" | "waiting" | "joined" | "lost" | "refused";

export interface ConnectionHandlers {
  on_state(state: ConnectionState): void;
  on_welcome(welcome: Welcome): void;
  /** Every time that the gateway names what is missing. */
  on_waiting(missing: string[]): void;
  on_status(status: Status): void;
  on_picture(picture: Picture): void;
  on_refused(sentence: string): void;
  /** A message that breaks the wire format was skipped. */
  on_problem(sentence: string): void;
}

const back_off_first_ms = 300;
const back_off_max_ms = 3000;
const beat_ms = 1000;
// Beats rather than milliseconds: after this page itself was held up for long, one late beat must
// not look like silence.
const silent_beats_max = 6;
const backlog_bytes_max = 64 * 1024;

export class Connection {
  rtt_ms: number | null = null;
  reconnects = 0;
  /** When the connection was lost (performance.now), null while it stands. */
  lost_at_ms: number | null = null;

  private state_: ConnectionState = "connecting";
  private socket_: WebSocket | null = null;
  private seq_ = 0;
  private attempt_ = 0;
  private retry_timer_ = 0;
  private silent_beats_ = 0;

  constructor(
    private readonly url_: string,
    private readonly join_: () => { name: string; token: string | null; view: View },
    private readonly handlers_: ConnectionHandlers,
  ) {
    window.setInterval(() => this.beat(), beat_ms);
    window.addEventListener("online", () => this.hurry());
    document.addEventListener("visibilitychange", () => this.hurry());
  }

  get state(): ConnectionState {
    return this.state_;
  }

  connect(): void {
    window.clearTimeout(this.retry_timer_);
    this.drop_socket();
    this.seq_ = 0;
    this.silent_beats_ = 0;
    if (this.state_ !== "lost") this.set_state("connecting");
    let socket: WebSocket;
    try {
      socket = new WebSocket(this.url_);
    } catch {
      this.lose();
      return;
    }
    this.socket_ = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.send_join();
    socket.onclose = () => this.lose();
    socket.onmessage = (event: MessageEvent<unknown>) => this.receive(event.data);
  }

  send_input(keys: number, yaw: number, pitch: number): boolean {
    if (!this.can_send()) return false;
    return this.send({
      type: "input",
      seq: ++this.seq_,
      keys,
      yaw: short(yaw),
      pitch: short(pitch),
    });
  }

  send_action(action: ActionName, yaw: number, pitch: number, item: number): boolean {
    if (!this.can_send()) return false;
    const angles = { yaw: short(yaw), pitch: short(pitch) };
    return this.send({ type: "action", seq: ++this.seq_, action, ...angles, item });
  }

  /** False: it was not sent. */
  send_view(view: View): boolean {
    return this.can_send() && this.send({ type: "view", ...view });
  }

  send_ack(frame: number): void {
    if (this.state_ === "joined") this.send({ type: "ack", frame });
  }

  private can_send(): boolean {
    return this.state_ === "joined" && (this.socket_?.bufferedAmount ?? 0) < backlog_bytes_max;
  }

  private send(message: ClientMessage): boolean {
    if (this.socket_?.readyState !== WebSocket.OPEN) return false;
    this.socket_.send(JSON.stringify(message));
    return true;
  }

  private send_join(): void {
    const { name, token, view } = this.join_();
    const size = { width: view.width, height: view.height };
    const known = token === null ? {} : { token };
    this.send({ type: "join", version: protocol_version, name, ...known, ...size });
  }

  private receive(data: unknown): void {
    this.silent_beats_ = 0;
    try {
      if (data instanceof ArrayBuffer) {
        const picture = parse_picture(data);
        if (this.state_ === "joined") this.handlers_.on_picture(picture);
      } else if (typeof data === "string") {
        const message = parse_server_message(data);
        if (message !== null) this.take(message);
      }
    } catch (problem) {
      if (!(problem instanceof WireError)) throw problem;
      // Without a welcome that can be read there is no way to play; any other message is skipped.
      if (this.state_ !== "joined" && typeof data === "string") this.refuse(problem.message);
      else this.handlers_.on_problem(problem.message);
    }
  }

  private take(message: ServerMessage): void {
    switch (message.type) {
      case "welcome":
        this.answered("joined");
        this.handlers_.on_welcome(message);
        this.send({ type: "ping", t: performance.now() });
        return;
      case "waiting":
        // Who is in the world does not wait for it any more.
        if (this.state_ === "joined") return;
        this.answered("waiting");
        this.handlers_.on_waiting(message.missing);
        return;
      case "status":
        if (this.state_ === "joined") this.handlers_.on_status(message);
        return;
      case "pong": {
        const elapsed = performance.now() - message.t;
        if (elapsed >= 0 && elapsed < 60_000) this.rtt_ms = elapsed;
        return;
      }
      case "error":
        this.refuse(message.message);
        return;
    }
  }

  /** The gateway took the join: the connection stands. */
  private answered(state: "joined" | "waiting"): void {
    if (this.lost_at_ms !== null) this.reconnects++;
    this.lost_at_ms = null;
    this.attempt_ = 0;
    this.set_state(state);
  }

  private beat(): void {
    if (this.socket_ === null) return;
    if (++this.silent_beats_ > silent_beats_max) this.lose();
    else if (this.state_ === "joined") this.send({ type: "ping", t: performance.now() });
  }

  /** The network or the page is back: do not wait for the back-off to end. */
  private hurry(): void {
    if (this.state_ === "lost" && this.socket_ === null && !document.hidden) this.connect();
  }

  private lose(): void {
    this.drop_socket();
    if (this.state_ === "refused") return;
    this.lost_at_ms ??= performance.now();
    this.rtt_ms = null;
    this.set_state("lost");
    const wait_ms = Math.min(back_off_max_ms, back_off_first_ms * 2 ** this.attempt_++);
    // A little chance keeps a crowd of pages from knocking all at once on a gateway that has just
    // started.
    this.retry_timer_ = window.setTimeout(
      () => this.connect(),
      wait_ms * (0.85 + 0.15 * Math.random()),
    );
  }

  private refuse(sentence: string): void {
    this.drop_socket();
    this.attempt_ = 0;
    this.rtt_ms = null;
    this.lost_at_ms ??= performance.now();
    this.set_state("refused");
    this.handlers_.on_refused(sentence);
  }

  private set_state(state: ConnectionState): void {
    if (this.state_ === state) return;
    this.state_ = state;
    this.handlers_.on_state(state);
  }

  private drop_socket(): void {
    const socket = this.socket_;
    if (socket === null) return;
    this.socket_ = null;
    socket.onopen = socket.onclose = socket.onmessage = null;
    socket.close();
  }
}

/** Angles with a ten-thousandth of a degree to spare, in few characters. */
function short(radians: number): number {
  return Math.round(radians * 1e6) / 1e6;
}
