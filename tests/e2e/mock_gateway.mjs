// A gateway without a world behind it: speaks protocol/WIRE_FORMAT.md, serves the built page, and
// misbehaves when told to.
//
// By hand, to work on the page:  sh web/build && node tests/e2e/mock_gateway.mjs [PORT]
import { randomBytes } from "node:crypto";
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { ClientRules } from "./support/client_rules.mjs";
import { WebSocketServer } from "./support/packages.mjs";

const content_types = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
  ".map": "application/json",
};
const regions = [
  { name: "north-west", colour: "#e0a33e" },
  { name: "north-east", colour: "#4f9fd0" },
  { name: "south-west", colour: "#6fb06a" },
  { name: "south-east", colour: "#c8617a" },
];
const window_pictures = 3;
const walk_speed = 4;

export function web_folder() {
  return process.env.AUREOLE_WEB_DIST ?? fileURLToPath(new URL("../../web/dist", import.meta.url));
}

/** The header of a picture; fields may be overridden to make hostile ones. */
export function picture_header({
  kind = 1,
  codec = 1,
  header_bytes = 32,
  number = 1,
  time_us = 0n,
  seq = 0,
  width = 1280,
  height = 720,
  cost_us = 9000,
} = {}) {
  const header = Buffer.alloc(32);
  header.writeUInt8(kind, 0);
  header.writeUInt8(codec, 1);
  header.writeUInt16LE(header_bytes, 2);
  header.writeUInt32LE(number, 4);
  header.writeBigUInt64LE(time_us, 8);
  header.writeUInt32LE(seq, 16);
  header.writeUInt16LE(width, 20);
  header.writeUInt16LE(height, 22);
  header.writeUInt32LE(cost_us, 24);
  return header;
}

export class MockGateway {
  constructor(pictures, { fps = 30 } = {}) {
    this.pictures = pictures;
    this.fps = fps;
    this.port = 0;
    /** Messages of all connections in the order in which they came. */
    this.received = [];
    /** Rules of the wire format that a page broke. */
    this.violations = [];
    this.players = new Map();
    this.clients = new Set();
    /** No pictures, everything else. */
    this.stalled = false;
    /** Connections stand, but nothing is said on them any more. */
    this.mute = false;
    /** A sentence: every join is answered with it. */
    this.refuse_with = null;
    /** Names of regions: every join is answered with them, until `complete`. */
    this.missing = null;
    this.throwables = ["Ball", "Crate", "Barrel", "Rock"];
    this.status_extra = {};
  }

  get url() {
    return `http://localhost:${this.port}`;
  }

  async start() {
    if (!existsSync(join(web_folder(), "index.html"))) {
      throw new Error(`The player page is not built in ${web_folder()}: run "sh web/build".`);
    }
    this.server = createServer((request, response) => this.serve(request, response));
    this.sockets = new WebSocketServer({ server: this.server, path: "/ws" });
    this.sockets.on("connection", (socket) => this.connect(socket));
    await new Promise((resolve, reject) => {
      this.server.once("error", reject);
      this.server.listen(this.port, "localhost", resolve);
    });
    this.port = this.server.address().port;
    this.timers = [
      setInterval(() => this.draw_all(), 1000 / this.fps),
      setInterval(() => this.report_all(), 250),
    ];
    return this;
  }

  /**
   * As `kill -9` would end it; `start` brings it back on the same port, and it remembers its
   * players.
   */
  async stop() {
    this.timers.forEach(clearInterval);
    for (const client of this.clients) client.socket.terminate();
    this.sockets.close();
    this.server.closeAllConnections?.();
    await new Promise((resolve) => this.server.close(resolve));
  }

  /** All regions are there: lets in who waits. */
  complete() {
    this.missing = null;
    for (const client of this.clients) if (client.waits_with) this.join(client, client.waits_with);
  }

  forget_players() {
    this.players.clear();
  }

  drop_connections() {
    for (const client of this.clients) client.socket.terminate();
  }

  send_text(text) {
    for (const client of this.clients) client.socket.send(text);
  }

  send_binary(bytes) {
    for (const client of this.clients) client.socket.send(bytes);
  }

  /** One sentence to every page, and the end of its connection. */
  refuse(message) {
    for (const client of this.clients) {
      client.socket.send(JSON.stringify({ type: "error", message }));
      client.socket.close();
    }
  }

  messages(type) {
    return this.received.filter((message) => message.type === type);
  }

  serve(request, response) {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    const file = join(web_folder(), path === "/" ? "index.html" : path);
    if (!file.startsWith(web_folder()) || !existsSync(file)) {
      response.writeHead(404).end("not here");
      return;
    }
    response.writeHead(200, {
      "content-type": content_types[extname(file)] ?? "application/octet-stream",
    });
    response.end(readFileSync(file));
  }

  connect(socket) {
    const client = { socket, rules: new ClientRules(), player: null, number: 0, seq: 0, keys: 0 };
    /** Its join, while regions are missing. */
    client.waits_with = null;
    this.clients.add(client);
    socket.on("close", () => this.clients.delete(client));
    socket.on("error", () => socket.terminate());
    socket.on("message", (data) => {
      const text = data.toString();
      const broken = client.rules.check(text, performance.now());
      if (broken !== null) this.violations.push(broken);
      const message = JSON.parse(text);
      this.received.push(message);
      this.answer(client, message);
    });
  }

  answer(client, message) {
    if (this.mute) return;
    if (message.seq !== undefined) client.seq = message.seq;
    if (message.type === "join") this.join(client, message);
    else if (message.type === "input") client.keys = message.keys;
    else if (message.type === "ping")
      client.socket.send(JSON.stringify({ type: "pong", t: message.t }));
    else if (message.type === "action" && message.action === "grab")
      client.player.carrying = !client.player.carrying;
  }

  join(client, message) {
    const { token } = message;
    if (this.refuse_with !== null) {
      client.socket.send(JSON.stringify({ type: "error", message: this.refuse_with }));
      client.socket.close();
      return;
    }
    if (this.missing !== null) {
      client.waits_with = message;
      this.send_waiting(client);
      return;
    }
    client.waits_with = null;
    const resumed = this.players.has(token);
    const own_token = resumed ? token : randomBytes(16).toString("hex");
    if (!resumed) {
      this.players.set(own_token, {
        name: String(this.players.size + 1),
        position: [-6, 1, 12],
        carrying: false,
      });
    }
    client.player = this.players.get(own_token);
    client.socket.send(
      JSON.stringify({
        type: "welcome",
        version: 1,
        token: own_token,
        player: client.player.name,
        resumed,
        world: {
          name: "Playground",
          description: "Stacks, dominoes and a ball pit, simulated by four servers as one world.",
        },
        regions,
        throwables: this.throwables,
        tick_ms: 16,
      }),
    );
  }

  send_waiting(client) {
    client.socket.send(JSON.stringify({ type: "waiting", missing: this.missing }));
  }

  draw_all() {
    for (const client of this.clients) {
      if (client.player === null) continue;
      if (client.keys & 1) client.player.position[2] -= walk_speed / this.fps;
      if (client.keys & 2) client.player.position[2] += walk_speed / this.fps;
      const open = [...client.rules.sent].filter(
        (number) => !client.rules.acked.has(number),
      ).length;
      if (this.stalled || this.mute || open >= window_pictures) continue;
      this.send_picture(client);
    }
  }

  /** The picture of where the player stands: one for every half metre. */
  send_picture(client) {
    const { jpegs, width, height } = this.pictures;
    const step = Math.floor((12 - client.player.position[2]) * 2);
    const jpeg = jpegs[((step % jpegs.length) + jpegs.length) % jpegs.length];
    const time_us = BigInt(Math.round(performance.now() * 1000));
    client.rules.sent.add(++client.number);
    client.socket.send(
      Buffer.concat([
        picture_header({ number: client.number, time_us, seq: client.seq, width, height }),
        jpeg,
      ]),
    );
  }

  /** Many pictures at once, without regard for the window. */
  flood(count) {
    for (const client of this.clients) for (let i = 0; i < count; i++) this.send_picture(client);
  }

  report_all() {
    if (this.mute) return;
    for (const client of this.clients) {
      if (client.waits_with && this.missing !== null) this.send_waiting(client);
      if (client.player === null) continue;
      const [x, y, z] = client.player.position;
      const region = regions[(x > 0 ? 1 : 0) + (z > 0 ? 2 : 0)].name;
      client.socket.send(
        JSON.stringify({
          type: "status",
          fps: this.fps,
          bodies: 1248,
          awake: 73,
          players: this.clients.size,
          region,
          position: [x, y, z],
          carrying: client.player.carrying,
          regions_up: 4,
          regions: 4,
          world_time_s: performance.now() / 1000,
          quality: 75,
          ...this.status_extra,
        }),
      );
    }
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { launch_browser } = await import("./support/browser.mjs");
  const { draw_pictures } = await import("./support/pictures.mjs");
  const browser = await launch_browser();
  const pictures = await draw_pictures(browser, { count: 24 });
  await browser.close();
  const gateway = new MockGateway(pictures, { fps: 60 });
  gateway.port = Number(process.argv[2] ?? 8081);
  await gateway.start();
  console.log(`Open ${gateway.url}`);
}
