// The messages between this page and the gateway, read and checked as protocol/WIRE_FORMAT.md
// describes them.

export const protocol_version = 1;

/** Bits of `input.keys`. */
export const Key = { forward: 1, back: 2, left: 4, right: 8, jump: 16, sprint: 32 } as const;

export type ActionName = "throw" | "grab" | "blast" | "respawn";

export interface Region {
  name: string;
  /** `#rrggbb`. */
  colour: string;
}

export interface Welcome {
  type: "welcome";
  token: string;
  player: string;
  resumed: boolean;
  /** Radians: where a new player looks at first. */
  yaw: number;
  world: { name: string; description: string };
  regions: Region[];
  throwables: string[];
}

/** The answer to `join` while regions are missing; comes again until `welcome` or `error`. */
export interface Waiting {
  type: "waiting";
  /** Names of the regions that are not there yet. */
  missing: string[];
}

export interface Status {
  type: "status";
  fps: number;
  bodies: number;
  awake: number;
  players: number;
  region: string;
  /** Metres, y up; null while no region has the avatar. */
  position: [number, number, number] | null;
  carrying: boolean;
  regions_up: number;
  regions: number;
  world_time_s: number;
  quality: number;
  /** Something to tell the player once; often empty. */
  notice: string;
}

export type ServerMessage =
  Welcome | Waiting | Status | { type: "pong"; t: number } | { type: "error"; message: string };

export interface View {
  width: number;
  height: number;
  region_colours: boolean;
  boundaries: boolean;
}

export type ClientMessage =
  | { type: "join"; version: number; token?: string; name: string; width: number; height: number }
  | { type: "input"; seq: number; keys: number; yaw: number; pitch: number }
  | { type: "action"; seq: number; action: ActionName; yaw: number; pitch: number; item: number }
  | ({ type: "view" } & View)
  | { type: "ack"; frame: number }
  | { type: "ping"; t: number };

export interface Picture {
  number: number;
  world_time_us: number;
  /** `seq` of the newest input that the picture contains. */
  input_seq: number;
  width: number;
  height: number;
  /** Time that the gateway spent on rendering and encoding. */
  render_ms: number;
  jpeg: Uint8Array<ArrayBuffer>;
}

/**
 * What arrived is not what the wire format allows; the message says what was found and what was
 * expected.
 */
export class WireError extends Error {}

const picture_header_bytes = 32;
const picture_bytes_max = 16 * 1024 * 1024;
const text_length_max = 64 * 1024;
const picture_kind = 1;
const jpeg_codec = 1;

/** Reads one binary message. Throws WireError. */
export function parse_picture(data: ArrayBuffer): Picture {
  if (data.byteLength < picture_header_bytes) {
    throw new WireError(`a picture of ${data.byteLength} bytes is shorter than its header`);
  }
  if (data.byteLength > picture_bytes_max) {
    throw new WireError(`a picture of ${data.byteLength} bytes is too large`);
  }
  const view = new DataView(data);
  if (view.getUint8(0) !== picture_kind) {
    throw new WireError(`unknown kind of binary message: ${view.getUint8(0)}`);
  }
  if (view.getUint8(1) !== jpeg_codec) {
    throw new WireError(`unknown picture codec: ${view.getUint8(1)}`);
  }
  const header_bytes = view.getUint16(2, true);
  if (header_bytes < picture_header_bytes || header_bytes >= data.byteLength) {
    throw new WireError(`a header of ${header_bytes} bytes in a picture of ${data.byteLength}`);
  }
  const world_time_us = view.getUint32(8, true) + view.getUint32(12, true) * 2 ** 32;
  const width = view.getUint16(20, true);
  const height = view.getUint16(22, true);
  if (width === 0 || height === 0 || width > 4096 || height > 4096) {
    throw new WireError(`a picture of ${width} × ${height} pixels`);
  }
  return {
    number: view.getUint32(4, true),
    world_time_us,
    input_seq: view.getUint32(16, true),
    width,
    height,
    render_ms: view.getUint32(24, true) / 1000,
    jpeg: new Uint8Array(data, header_bytes),
  };
}

/** Reads one text message; null when its type is unknown to this page. Throws WireError. */
export function parse_server_message(text: string): ServerMessage | null {
  if (text.length > text_length_max) {
    throw new WireError(`a text message of ${text.length} characters is too long`);
  }
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    throw new WireError("a text message is not JSON");
  }
  const fields = object_of(value, "message");
  switch (fields["type"]) {
    case "welcome":
      return parse_welcome(fields);
    case "waiting":
      return parse_waiting(fields);
    case "status":
      return parse_status(fields);
    case "pong":
      return { type: "pong", t: number_of(fields["t"], "pong.t") };
    case "error":
      return { type: "error", message: string_of(fields["message"], "error.message", 400) };
    default:
      return null;
  }
}

function parse_welcome(fields: Record<string, unknown>): Welcome {
  const version = number_of(fields["version"], "welcome.version");
  if (version !== protocol_version) {
    throw new WireError(
      `The server speaks version ${version}, this page version ${protocol_version}. Reload the page.`,
    );
  }
  const token = string_of(fields["token"], "welcome.token", 64);
  if (!is_token(token)) throw new WireError("welcome.token is not 32 hexadecimal digits");
  const world = object_of(fields["world"], "welcome.world");
  return {
    type: "welcome",
    token,
    player: name_of(fields["player"], "welcome.player"),
    resumed: fields["resumed"] === true,
    yaw: number_of(fields["yaw"] ?? 0, "welcome.yaw"),
    world: {
      name: string_of(world["name"], "welcome.world.name", 80),
      description: string_of(world["description"] ?? "", "welcome.world.description", 1000),
    },
    regions: list_of(fields["regions"], "welcome.regions", 1024).map((item, i) => {
      const region = object_of(item, `welcome.regions[${i}]`);
      const colour = region["colour"];
      const known = typeof colour === "string" && /^#[0-9a-f]{6}$/i.test(colour);
      return {
        name: string_of(region["name"], `welcome.regions[${i}].name`, 80),
        colour: known ? colour : "#9aa4b2",
      };
    }),
    throwables: list_of(fields["throwables"], "welcome.throwables", 16).map((item, i) =>
      string_of(item, `welcome.throwables[${i}]`, 40),
    ),
  };
}

function parse_waiting(fields: Record<string, unknown>): Waiting {
  const missing = list_of(fields["missing"], "waiting.missing", 4096);
  return {
    type: "waiting",
    missing: missing.map((item, i) => string_of(item, `waiting.missing[${i}]`, 80)),
  };
}

function parse_status(fields: Record<string, unknown>): Status {
  const number = (key: string) => number_of(fields[key], `status.${key}`);
  const place = fields["position"];
  const position = place === null ? null : list_of(place, "status.position", 3);
  return {
    type: "status",
    fps: number("fps"),
    bodies: number("bodies"),
    awake: number("awake"),
    players: number("players"),
    region: string_of(fields["region"] ?? "", "status.region", 80),
    position: position && [
      number_of(position[0], "status.position[0]"),
      number_of(position[1], "status.position[1]"),
      number_of(position[2], "status.position[2]"),
    ],
    carrying: Boolean(fields["carrying"]),
    regions_up: number("regions_up"),
    regions: number("regions"),
    world_time_s: number("world_time_s"),
    quality: number("quality"),
    notice: string_of(fields["notice"] ?? "", "status.notice", 400),
  };
}

export function is_token(value: string | null): value is string {
  return value !== null && /^[0-9a-f]{32}$/i.test(value);
}

function object_of(value: unknown, what: string): Record<string, unknown> {
  if (typeof value !== "object" || value === null || Array.isArray(value)) {
    throw new WireError(`${what} is not an object`);
  }
  return value as Record<string, unknown>;
}

function list_of(value: unknown, what: string, length_max: number): unknown[] {
  if (!Array.isArray(value) || value.length > length_max) {
    throw new WireError(`${what} is not a list of at most ${length_max}`);
  }
  return value;
}

function number_of(value: unknown, what: string): number {
  if (typeof value !== "number" || !Number.isFinite(value)) {
    throw new WireError(`${what} is not a finite number`);
  }
  return value;
}

function string_of(value: unknown, what: string, length_max: number): string {
  if (typeof value !== "string") throw new WireError(`${what} is not a string`);
  return value.slice(0, length_max);
}

function name_of(value: unknown, what: string): string {
  return typeof value === "number" ? String(value) : string_of(value, what, 80);
}
