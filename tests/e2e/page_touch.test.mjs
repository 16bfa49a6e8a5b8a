// Phones and low windows: whatever a finger may want is in sight, and nothing lies over it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { keep_screenshot, wait_for_page } from "./support/browser.mjs";
import { eventually, mock_fixture } from "./support/mock_fixture.mjs";

const fixture = mock_fixture();

const fingers = { hasTouch: true, isMobile: true };
const windows = [
  { width: 390, height: 844 },
  { width: 844, height: 390 },
  { width: 667, height: 375 },
  { width: 640, height: 360 },
  { width: 1024, height: 768 },
];
const toggles = ["#toggle-boundaries", "#toggle-colours", "#toggle-fullscreen", "#toggle-help"];
const touch_buttons = ["#touch-grab", "#touch-blast", "#touch-jump"];
const slots = [1, 2, 3, 4].map((item) => `#throwables [data-item="${item}"]`);

/** Selectors whose middle or corners something else covers, or that reach out of the window. */
function out_of_reach(page, selectors) {
  return page.evaluate((all) => {
    const inset = 6;
    return all.filter((selector) => {
      const wanted = document.querySelector(selector);
      const { left, right, top, bottom } = wanted.getBoundingClientRect();
      // The corners of a round button are not its own.
      const round = /50%|999px/.test(getComputedStyle(wanted).borderRadius);
      const points = [[(left + right) / 2, (top + bottom) / 2]];
      for (const x of [left + inset, right - inset])
        for (const y of [top + inset, bottom - inset]) if (!round) points.push([x, y]);
      return !points.every(([x, y]) => wanted.contains(document.elementFromPoint(x, y)));
    });
  }, selectors);
}

/** Pairs of panels that lie over each other. */
function overlaps(page, selectors) {
  return page.evaluate((all) => {
    const found = [];
    const boxes = all.map((selector) => document.querySelector(selector).getBoundingClientRect());
    for (let i = 0; i < all.length; i++) {
      for (let j = 0; j < i; j++) {
        const [a, b] = [boxes[i], boxes[j]];
        const beside = a.right <= b.left || b.right <= a.left;
        if (!beside && a.top < b.bottom && b.top < a.bottom) found.push(`${all[j]} ${all[i]}`);
      }
    }
    return found;
  }, selectors);
}

test("fingers reach every button in every window, before and after the first touch", async () => {
  await fixture.start();
  for (const { width, height } of windows) {
    const page = await fixture.open_playing("?autostart", { width, height, ...fingers });
    const what = `${width} × ${height}`;
    const buttons = [...toggles, ...touch_buttons, ...slots];
    assert.deepEqual(await out_of_reach(page, buttons), [], `${what}: before a touch`);
    await page.touchscreen.tap(width * 0.55, height * 0.5);
    assert.deepEqual(await out_of_reach(page, buttons), [], `${what}: after a touch`);
    const panels = [".stats", ".toggles", ".touch-buttons", "#throwables"];
    assert.deepEqual(await overlaps(page, panels), [], what);
    await keep_screenshot(page, `page-touch-${width}x${height}`);
    await page.context().close();
  }
});

test("fingers choose, grab, show boundaries and open the help", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing("?autostart", { ...windows[0], ...fingers });
  await page.tap(slots[3]);
  await wait_for_page(page, "item 4", (a) => a.item === 4);
  await page.tap("#touch-grab");
  await eventually("the grab", () => gateway.messages("action").at(-1)?.action === "grab");
  await page.waitForSelector("#carrying", { state: "visible" });
  assert.equal(await page.textContent("#touch-grab"), "Let go");
  assert.deepEqual(await overlaps(page, ["#carrying", ".touch-buttons"]), []);
  await page.tap("#toggle-boundaries");
  await eventually("boundaries", () => gateway.messages("view").at(-1).boundaries);
  await page.tap("#toggle-help");
  await page.waitForSelector("#help", { state: "visible" });
  await page.tap("#start");
  await page.waitForSelector("#help", { state: "hidden" });
});

test("fingers start again from the help, once they have begun", async () => {
  const gateway = await fixture.start();
  for (const { width, height } of windows) {
    const page = await fixture.open_playing("", { width, height, ...fingers });
    await page.waitForSelector("#help", { state: "visible" });
    assert.equal(await page.isVisible("#again"), false);
    await page.tap("#start");
    await page.tap("#toggle-help");
    await page.waitForSelector("#again", { state: "visible" });
    const what = `${width} × ${height}`;
    assert.deepEqual(await out_of_reach(page, ["#start", "#again"]), [], what);
    const before = gateway.messages("action").length;
    await keep_screenshot(page, `page-help-again-${width}x${height}`);
    await page.tap("#again");
    await eventually("the new start", () => gateway.messages("action").length === before + 1);
    assert.equal(gateway.messages("action").at(-1).action, "respawn");
    await page.waitForSelector("#help", { state: "hidden" });
    await page.context().close();
  }
  const with_mouse = await fixture.open_playing("", {});
  await with_mouse.click("#start");
  await with_mouse.keyboard.press("KeyH");
  await with_mouse.waitForSelector("#help", { state: "visible" });
  assert.equal(await with_mouse.isVisible("#again"), false);
});

test("names of two words are not cut on a phone", async () => {
  const gateway = await fixture.start();
  gateway.throwables = ["rubber ball", "heavy ball", "wooden crate", "hammer"];
  for (const { width, height } of windows) {
    const page = await fixture.open_playing("?autostart", { width, height, ...fingers });
    const cut = await page.evaluate(() =>
      [...document.querySelectorAll("#throwables span")]
        .filter(
          ({ scrollWidth, clientWidth, scrollHeight, clientHeight }) =>
            scrollWidth > clientWidth + 1 || scrollHeight > clientHeight + 1,
        )
        .map((name) => name.textContent),
    );
    assert.deepEqual(cut, [], `${width} × ${height}`);
    await page.context().close();
  }
});

test("the help speaks of fingers to fingers, and of keys to a mouse", async () => {
  await fixture.start();
  const with_fingers = await fixture.open_playing("", { ...windows[0], ...fingers });
  const told = await with_fingers.innerText("#help");
  for (const word of ["Left side", "Right side", "Tap", "Grab", "Blast", "Jump", "Boundaries"])
    assert.ok(told.includes(word), `no word of ${word} in: ${told}`);
  assert.match(told, /Help\s*brings this back/);
  assert.doesNotMatch(told, /Space|Shift|Esc|Wheel|Click|\b[BCEFHQRW]\b/);
  await keep_screenshot(with_fingers, "page-help-touch");
  const with_mouse = await fixture.open_playing("", {});
  const told_to_mouse = await with_mouse.innerText("#help");
  for (const word of ["Space", "Shift", "Esc", "Wheel"]) assert.ok(told_to_mouse.includes(word));
  assert.doesNotMatch(told_to_mouse, /Left side|Tap there/);
});

test("the button that starts is in sight in a low window", async () => {
  await fixture.start();
  for (const options of [{}, fingers]) {
    for (const [width, height] of [
      [640, 360],
      [667, 375],
      [320, 480],
    ]) {
      const page = await fixture.open_playing("", { width, height, ...options });
      await page.waitForSelector("#help", { state: "visible" });
      assert.deepEqual(await out_of_reach(page, ["#start"]), [], `${width} × ${height}`);
      await page.click("#start");
      await page.waitForSelector("#help", { state: "hidden" });
      await page.context().close();
    }
  }
});
