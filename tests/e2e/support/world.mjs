// Starts real worlds for the tests: `aureole play`, or its five processes one by one. Every process
// is stopped by its id.
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { createServer } from "node:net";
import { patience_ms } from "./browser.mjs";

const stop_patience_ms = 10_000;
const log_characters_max = 20_000;

function binary() {
  const path = process.env.AUREOLE_BINARY;
  if (!path || !existsSync(path)) {
    throw new Error(
      `AUREOLE_BINARY must name the built aureole executable; it is ${JSON.stringify(path ?? null)}.`,
    );
  }
  return path;
}

/** One child process, its output kept for error messages. */
class Child {
  constructor(args) {
    this.name = `aureole ${args.join(" ")}`;
    this.output = "";
    this.process = spawn(binary(), args, { stdio: ["ignore", "pipe", "pipe"] });
    const keep = (data) => (this.output = (this.output + data).slice(-log_characters_max));
    this.process.stdout.on("data", keep);
    this.process.stderr.on("data", keep);
    this.ended = new Promise((resolve) => {
      this.process.once("error", (problem) => {
        this.output += problem.message;
        resolve({ code: null, signal: null });
      });
      this.process.once("exit", (code, signal) => resolve({ code, signal }));
    });
    this.has_ended = false;
    this.ended.then(() => (this.has_ended = true));
  }

  async output_matching(pattern) {
    const until_ms = performance.now() + patience_ms;
    for (;;) {
      const match = this.output.match(pattern);
      if (match) return match;
      if (this.has_ended) throw new Error(`${this.name} ended early. It wrote:\n${this.output}`);
      if (performance.now() > until_ms)
        throw new Error(`${this.name} never wrote ${pattern}. It wrote:\n${this.output}`);
      await pause(50);
    }
  }

  /** @returns {Promise<{code: number | null, signal: string | null}>} */
  async stop(signal = "SIGTERM") {
    if (!this.has_ended) this.process.kill(signal);
    const late = pause(stop_patience_ms).then(() => "late");
    if ((await Promise.race([this.ended, late])) === "late") {
      this.process.kill("SIGKILL");
      await this.ended;
      throw new Error(
        `${this.name} did not end within ${stop_patience_ms / 1000} s of ${signal}. It wrote:\n${this.output}`,
      );
    }
    return this.ended;
  }
}

/** A whole world on this machine by one command, on a port that is free. */
export async function start_play({ world = "playground" } = {}) {
  const child = new Child(["play", "--world", world, "--port", "0"]);
  try {
    const [, url] = await child.output_matching(/Open (http:\/\/localhost:\d+)/);
    return { url, output: () => child.output, stop: () => child.stop() };
  } catch (problem) {
    await child.stop().catch(() => {});
    throw problem;
  }
}

/**
 * The same world as five processes: four regions, and a gateway that can be killed and started
 * again on its port.
 * THE COMMAND LINES OF `aureole region` AND `aureole gateway` ARE WRITTEN HERE AND NOWHERE ELSE IN
 * THESE TESTS.
 */
export async function start_world_by_hand({ world = "playground", regions = 4 } = {}) {
  const [gateway_port, ...region_ports] = await free_ports(regions + 1);
  const addresses = region_ports.map((port) => `127.0.0.1:${port}`);
  const named = addresses.map((address, index) => `r${index}=${address}`);
  const region_args = (index) => [
    ...["region", "--world", world, "--region", String(index), "--listen", addresses[index]],
    ...named.filter((_, other) => other !== index).flatMap((peer) => ["--peer", peer]),
  ];
  const gateway_args = [
    ...["gateway", "--world", world, "--listen", `127.0.0.1:${gateway_port}`],
    ...named.flatMap((region) => ["--region", region]),
  ];

  const url = `http://localhost:${gateway_port}`;
  const children = [];
  const start = (args) => {
    const child = new Child(args);
    children.push(child);
    return child;
  };
  const started = {
    url,
    gateway: null,
    async start_gateway() {
      started.gateway = start(gateway_args);
      await healthy(url, started.gateway);
    },
    /** As a crash would: no farewell to regions or pages. */
    kill_gateway: () => started.gateway.stop("SIGKILL"),
    async stop() {
      const results = await Promise.allSettled(children.map((child) => child.stop()));
      const failed = results.find((result) => result.status === "rejected");
      if (failed) throw failed.reason;
    },
  };
  try {
    for (let index = 0; index < regions; index++) start(region_args(index));
    await started.start_gateway();
    await eventually_status(
      url,
      "all regions to be up",
      (status) => status.regions.length === regions && status.regions.every((region) => region.up),
    );
    return started;
  } catch (problem) {
    const output = children.map((child) => `--- ${child.name}\n${child.output}`).join("\n");
    await started.stop().catch(() => {});
    throw new Error(`${problem.message}\n${output}`, { cause: problem });
  }
}

/** /api/status of a gateway. */
export async function api_status(url) {
  const response = await fetch(`${url}/api/status`);
  if (!response.ok) throw new Error(`${url}/api/status answered ${response.status}`);
  return response.json();
}

/** Waits until /api/status satisfies a condition; the error holds the last answer. */
export async function eventually_status(url, what, condition, timeout_ms = patience_ms) {
  const until_ms = performance.now() + timeout_ms;
  let last = null;
  for (;;) {
    last = await api_status(url).catch((problem) => ({ unreachable: problem.message }));
    if (last.unreachable === undefined && condition(last)) return last;
    if (performance.now() > until_ms) {
      throw new Error(
        `Waited ${timeout_ms / 1000} s for: ${what}. /api/status says ${JSON.stringify(last)}`,
      );
    }
    await pause(100);
  }
}

/** Handoffs taken in by all regions since their start. */
export function migrations_of(status) {
  return status.regions.reduce((sum, region) => sum + region.migrations_in, 0);
}

async function healthy(url, child) {
  const until_ms = performance.now() + patience_ms;
  for (;;) {
    const answer = await fetch(`${url}/healthz`).catch(() => null);
    if (answer?.ok) return;
    if (child.has_ended) throw new Error(`${child.name} ended early. It wrote:\n${child.output}`);
    if (performance.now() > until_ms)
      throw new Error(`${url}/healthz never answered. ${child.name} wrote:\n${child.output}`);
    await pause(100);
  }
}

/** Ports that were free a moment ago, all different. */
async function free_ports(count) {
  const servers = await Promise.all(
    Array.from(
      { length: count },
      () =>
        new Promise((resolve, reject) => {
          const server = createServer();
          server.once("error", reject);
          server.listen(0, "127.0.0.1", () => resolve(server));
        }),
    ),
  );
  const ports = servers.map((server) => server.address().port);
  await Promise.all(servers.map((server) => new Promise((resolve) => server.close(resolve))));
  return ports;
}

export function pause(milliseconds) {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}

/** All bodies as the gateway knows them. */
export async function replicas(url) {
  const response = await fetch(`${url}/api/replicas`);
  if (!response.ok) throw new Error(`${url}/api/replicas answered ${response.status}`);
  return (await response.json()).bodies;
}

/** Whether a player threw it: the top byte of a body's id says where the name comes from. */
export function is_thrown(body) {
  return BigInt(body.id) >> 56n === 4n;
}

/** Waits until `condition` holds, and returns what it says then. */
export async function eventually(condition, what, timeout_ms = patience_ms) {
  const until_ms = performance.now() + timeout_ms;
  for (;;) {
    const holds = await condition();
    if (holds) return holds;
    if (performance.now() > until_ms) throw new Error(`Waited ${timeout_ms / 1000} s for: ${what}`);
    await pause(200);
  }
}
