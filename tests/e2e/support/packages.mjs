// The npm packages of these tests live in web/node_modules; this is the one place that looks there.
import { createRequire } from "node:module";

const require_from_web = createRequire(new URL("../../../web/package.json", import.meta.url));

function need(name) {
  try {
    return require_from_web(name);
  } catch (problem) {
    throw new Error(
      `The npm package ${name} is missing: run "npm ci" in web/ (${problem.message}).`,
    );
  }
}

export const { chromium } = need("playwright-core");
export const { WebSocketServer, WebSocket } = need("ws");
