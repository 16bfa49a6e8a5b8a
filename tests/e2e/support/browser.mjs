// A real Chromium for the tests, and pages in it that remember what they complained about.
import { existsSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "./packages.mjs";

const candidates = [
  process.env.AUREOLE_CHROMIUM,
  "/usr/bin/chromium",
  "/usr/bin/chromium-browser",
  "/usr/bin/google-chrome",
];

/** Everything here waits for two slow, busy cores before it gives up. */
export const patience_ms = Number(process.env.AUREOLE_TEST_PATIENCE_MS ?? 60_000);

export async function launch_browser() {
  const executablePath = candidates.find((path) => path && existsSync(path));
  if (!executablePath) {
    throw new Error(
      "Chromium is missing: apt-get install chromium, or name one in AUREOLE_CHROMIUM.",
    );
  }
  return chromium.launch({
    executablePath,
    headless: true,
    timeout: patience_ms,
    args: [
      "--no-sandbox",
      "--disable-gpu",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
  });
}

/**
 * Opens an address in a fresh context (own storage). `complaints` fills with console errors and
 * uncaught exceptions.
 * @returns {Promise<{page: import("playwright-core").Page, complaints: string[]}>}
 */
export async function open_page(
  browser,
  url,
  { width = 1280, height = 720, ...context_options } = {},
) {
  const context = await browser.newContext({ viewport: { width, height }, ...context_options });
  const page = await context.newPage();
  page.setDefaultTimeout(patience_ms);
  page.setDefaultNavigationTimeout(patience_ms);
  const complaints = [];
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(`uncaught: ${error.message}`));
  await page.goto(url);
  return { page, complaints };
}

/**
 * Chromium itself reports every refused connection; while a gateway is down on purpose that is no
 * fault of the page.
 */
export function without_refused_connections(complaints) {
  return complaints.filter(
    (text) => !/WebSocket connection to .* failed|ERR_CONNECTION_REFUSED/.test(text),
  );
}

/** `window.aureole` as plain data. */
export function statistics_of(page) {
  return page.evaluate(() => {
    const copy = {};
    for (const key of Object.keys(window.aureole)) copy[key] = window.aureole[key];
    return JSON.parse(JSON.stringify(copy));
  });
}

/**
 * Waits until a predicate over `window.aureole` holds; the error says what the page knew when
 * patience ran out.
 */
export async function wait_for_page(page, what, predicate, argument = null, timeout = patience_ms) {
  const question = `window.aureole !== undefined && (${predicate})(window.aureole, ${JSON.stringify(argument)})`;
  const until_ms = performance.now() + timeout;
  // Asked from here: the page's own security policy forbids code that is made from strings inside
  // it.
  while (!(await page.evaluate(question))) {
    if (performance.now() > until_ms) {
      const known = JSON.stringify(await statistics_of(page));
      throw new Error(`Waited ${timeout / 1000} s for: ${what}. The page knows ${known}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

export function wait_for_pictures(page, count = 5) {
  return page
    .evaluate(() => window.aureole.frames_shown)
    .then((shown) =>
      wait_for_page(page, `${count} more pictures`, (a, n) => a.frames_shown >= n, shown + count),
    );
}

/**
 * Clicks into the world until the pointer is captured (or the page has found that it cannot be).
 */
export async function capture_pointer(page) {
  await page.mouse.move(640, 330);
  for (let attempt = 0; attempt < 5; attempt++) {
    await page.mouse.click(640, 330);
    try {
      await wait_for_page(page, "the pointer", (a) => a.pointer !== "released", null, 3000);
      return;
    } catch {
      // Browsers refuse for a moment after the pointer was freed.
    }
  }
  throw new Error("The pointer was never captured.");
}

/**
 * The picture on the canvas, shrunk to 160 × 90, as RGB bytes: small enough to compare, large
 * enough to see a step.
 */
export async function picture_pixels(page) {
  return page.evaluate(() => {
    const small = document.createElement("canvas");
    small.width = 160;
    small.height = 90;
    const context = small.getContext("2d", { willReadFrequently: true });
    context.imageSmoothingQuality = "high";
    context.drawImage(document.getElementById("picture"), 0, 0, 160, 90);
    const rgba = context.getImageData(0, 0, 160, 90).data;
    return Array.from(rgba.filter((_, i) => i % 4 !== 3));
  });
}

/**
 * How wide and how good the gateway makes pictures now, such as "1280 at 75": less where it or the
 * line is busy. Pictures of two kinds cannot be compared.
 */
export function picture_kind(page) {
  return page.evaluate(() => {
    const quality = window.aureole.status?.quality;
    return `${document.getElementById("picture").width} at ${Math.round(quality ?? 0)}`;
  });
}

/** Mean absolute difference of two pictures, 0 … 255. */
export function picture_difference(a, b) {
  if (a.length !== b.length) throw new Error("pictures of different sizes");
  return a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;
}

/**
 * A picture in which little moves, and by how much those after it still differ: others' avatars
 * come to rest or are taken away, and what was thrown rolls on. A busy gateway may send no picture
 * for a second: one that has not been replaced says nothing.
 */
export async function quiet_picture(page) {
  for (let attempt = 0; ; attempt++) {
    await wait_for_pictures(page);
    const picture = await picture_pixels(page);
    await new Promise((resolve) => setTimeout(resolve, 1500));
    await wait_for_pictures(page);
    const change = picture_difference(picture, await picture_pixels(page));
    if (change < 0.2 || attempt === 12) return { picture, change };
  }
}

/** Keeps a screenshot as an artefact, if AUREOLE_ARTEFACTS names a folder. */
export async function keep_screenshot(page, name) {
  const folder = process.env.AUREOLE_ARTEFACTS;
  if (!folder) return;
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: join(folder, `${name}.png`), timeout: patience_ms });
}
