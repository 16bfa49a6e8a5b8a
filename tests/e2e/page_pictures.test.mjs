// The page loads, shows the newest picture, acknowledges every one, and asks for a view that fits
// its window.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  keep_screenshot,
  picture_difference,
  picture_pixels,
  statistics_of,
  wait_for_page,
  wait_for_pictures,
} from "./support/browser.mjs";
import { eventually, mock_fixture } from "./support/mock_fixture.mjs";

const fixture = mock_fixture();

test("pictures arrive, are decoded and shown, and the numbers around them are filled in", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  await wait_for_page(
    page,
    "status, round trip and frame rate",
    (a) => a.status !== null && a.rtt_ms !== null && a.fps > 0,
  );
  const known = await statistics_of(page);
  assert.equal(known.connected, true);
  assert.match(known.token, /^[0-9a-f]{32}$/);
  assert.ok(known.frames_decoded >= known.frames_shown);
  assert.deepEqual([known.last_picture.width, known.last_picture.height], [1280, 720]);
  assert.ok(known.last_picture.world_time_us > 0);
  await eventually(
    "the HUD to show the status",
    async () => (await page.textContent("#stat-region")) === "south-west",
  );
  assert.equal(await page.textContent("#stat-bodies"), "1\u2009248");
  assert.equal(await page.textContent("#stat-players"), "1");
  assert.equal(await page.title(), "Playground · Aureole");
  assert.equal(gateway.messages("join").length, 1);
  await keep_screenshot(page, "page-playing");
});

test("a burst of pictures is acknowledged to the last one, but only the newest are shown", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  gateway.stalled = true;
  const { rules } = [...gateway.clients][0];
  gateway.flood(120);
  const last = Math.max(...rules.sent);
  await eventually("all acknowledgements", () => rules.acked.size === rules.sent.size);
  await wait_for_page(
    page,
    "the newest picture",
    (a, number) => a.last_picture.number === number,
    last,
  );
  const known = await statistics_of(page);
  assert.ok(known.frames_dropped > 0, "no picture was passed over");
  assert.ok(known.frames_shown < last, "every picture was shown");
});

test("walking changes the picture, standing still does not", async () => {
  await fixture.start();
  const page = await fixture.open_playing();
  const before = await picture_pixels(page);
  await wait_for_pictures(page);
  assert.ok(
    picture_difference(before, await picture_pixels(page)) < 0.01,
    "the picture changed while nothing moved",
  );
  await page.keyboard.down("KeyW");
  await wait_for_page(page, "a metre of walking", (a) => a.status.position[2] < 11);
  await page.keyboard.up("KeyW");
  await wait_for_pictures(page);
  assert.ok(
    picture_difference(before, await picture_pixels(page)) > 1,
    "the picture did not change",
  );
});

test("the view fits the window in steps, at most 1280 × 720, and a resize asks once", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing("?autostart", { width: 1000, height: 500 });
  const { width, height } = gateway.messages("join")[0];
  assert.deepEqual([width, height], [896, 504]);
  const views_before = gateway.messages("view").length;
  for (let i = 0; i < 10; i++) await page.setViewportSize({ width: 1000 + 80 * i, height: 900 });
  await eventually("the larger view", () =>
    gateway.messages("view").some((view) => view.width === 1280 && view.height === 720),
  );
  const views = gateway.messages("view").length - views_before;
  assert.ok(views <= 5, `ten steps of a resize asked for ${views} views`);
});

test("the address can fix the size of the view", async () => {
  const gateway = await fixture.start();
  await fixture.open_playing("?autostart&w=641&h=360");
  const { width, height } = gateway.messages("join")[0];
  assert.deepEqual([width, height], [640, 360]);
});

test("a gateway that stops sending pictures is noticed, and pictures go on when it does", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  gateway.stalled = true;
  await page.waitForSelector("#waiting", { state: "visible" });
  gateway.stalled = false;
  await page.waitForSelector("#waiting", { state: "hidden" });
  await wait_for_pictures(page);
});
