// Moves a player's avatar about as a person would, with keys and mouse, guided by what the page is
// told.
import { capture_pointer, patience_ms, statistics_of, wait_for_page } from "./browser.mjs";
import { pause } from "./world.mjs";

/** Pixels of mouse movement for one radian (web/src/look.ts). */
const pixels_per_radian = 1 / 0.0022;

export async function position_of(page) {
  // Null while the avatar is being made, or changes its server.
  await wait_for_page(page, "an avatar with a position", (a) => Boolean(a.status?.position));
  return (await statistics_of(page)).status.position;
}

export function distance(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** Waits until the avatar stands still, such as after it was put into the world. */
export async function stand_still(page) {
  let before = await position_of(page);
  for (let i = 0; i < 80; i++) {
    await pause(500);
    const now = await position_of(page);
    if (distance(before, now) < 0.01) return now;
    before = now;
  }
  throw new Error(`The avatar never came to rest; it is at ${before}.`);
}

/** The yaw that looks from one point to another: 0 looks along −z and grows to the left. */
export function yaw_towards(from, to) {
  return Math.atan2(from[0] - to[0], from[2] - to[2]);
}

/**
 * Turns the view by moving the captured mouse, in steps small enough for any browser; corrects
 * itself.
 */
export async function look_at(page, yaw, pitch = 0) {
  await capture_pointer_once(page);
  const middle = { x: 640, y: 360 };
  let at = { ...middle };
  await page.mouse.move(at.x, at.y);
  for (let attempt = 0; attempt < 60; attempt++) {
    const known = await statistics_of(page);
    const turn = Math.atan2(Math.sin(yaw - known.yaw), Math.cos(yaw - known.yaw));
    const rise = pitch - known.pitch;
    if (Math.abs(turn) < 0.02 && Math.abs(rise) < 0.02) return;
    const step = (radians) =>
      Math.max(-250, Math.min(250, Math.round(-radians * pixels_per_radian)));
    const next = { x: at.x + step(turn), y: at.y + step(rise) };
    if (next.x < 20 || next.x > 1260 || next.y < 20 || next.y > 700) {
      // At the window's edge: put the mouse back. That turns the view too, and the next round makes
      // up for it.
      next.x = middle.x;
      next.y = middle.y;
    }
    at = next;
    await page.mouse.move(at.x, at.y);
    await pause(30);
  }
  throw new Error(`The view never reached yaw ${yaw}, pitch ${pitch}.`);
}

async function capture_pointer_once(page) {
  const { pointer } = await statistics_of(page);
  if (pointer !== "locked") await capture_pointer(page);
}

/** Walks until a condition on the position holds. Jumps when something is in the way. */
export async function walk_until(
  page,
  condition,
  { sprint = false, timeout_ms = patience_ms } = {},
) {
  const until_ms = performance.now() + timeout_ms;
  if (sprint) await page.keyboard.down("ShiftLeft");
  await page.keyboard.down("KeyW");
  try {
    let before = await position_of(page);
    for (;;) {
      await pause(300);
      const now = await position_of(page);
      if (condition(now)) return now;
      if (performance.now() > until_ms)
        throw new Error(`The avatar walked for ${timeout_ms / 1000} s and is at ${now}.`);
      if (distance(before, now) < 0.1) await page.keyboard.press("Space", { delay: 200 });
      before = now;
    }
  } finally {
    await page.keyboard.up("KeyW");
    if (sprint) await page.keyboard.up("ShiftLeft");
  }
}

/** Throws what is chosen, straight where the view looks. */
export async function throw_once(page) {
  await capture_pointer_once(page);
  await page.mouse.down();
  await page.mouse.up();
}

/** Waits until the gateway has told the page where its avatar is. */
export function wait_for_status(page) {
  return wait_for_page(page, "the first status", (a) => a.status !== null);
}
