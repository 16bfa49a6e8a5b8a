// The gateway crashes and is started again: the page says so, comes back, and the player goes on
// where they stood.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  distance,
  look_at,
  position_of,
  stand_still,
  wait_for_status,
  walk_until,
} from "./support/avatar.mjs";
import {
  keep_screenshot,
  launch_browser,
  open_page,
  statistics_of,
  wait_for_page,
  wait_for_pictures,
  without_refused_connections,
} from "./support/browser.mjs";
import { api_status, start_world_by_hand } from "./support/world.mjs";

let browser = null;
let world = null;
before(async () => {
  world = await start_world_by_hand();
  browser = await launch_browser();
});
after(async () => {
  await browser?.close();
  await world?.stop();
});

test("after the gateway is killed and started again the same player stands where they stood", async () => {
  const { page, complaints } = await open_page(browser, `${world.url}/?autostart`);
  await wait_for_pictures(page);
  await wait_for_status(page);
  const start = await stand_still(page);
  await look_at(page, 0.6);
  await walk_until(page, (position) => distance(position, start) > 3);
  const place = await stand_still(page);
  const before = await statistics_of(page);
  assert.ok(distance(place, start) > 2, "the avatar is still where every new player starts");

  await world.kill_gateway();
  await wait_for_page(page, "the loss of the connection", (a) => !a.connected);
  await page.waitForSelector("#notice", { state: "visible" });
  const lost = await statistics_of(page);
  await keep_screenshot(page, "play-connection-lost");

  await world.start_gateway();
  await wait_for_page(page, "the connection to come back", (a) => a.connected && a.reconnects >= 1);
  await wait_for_pictures(page);
  await page.waitForSelector("#notice", { state: "hidden" });
  await wait_for_page(
    page,
    "a status of the new gateway",
    (a, old) => a.status.world_time_s > old,
    lost.status.world_time_s,
  );

  const now = await statistics_of(page);
  assert.equal(now.resumed, true, "the player had to start anew");
  assert.equal(now.token, before.token);
  assert.equal(now.player, before.player);
  assert.ok(
    distance(await stand_still(page), place) < 0.5,
    `the avatar stood at ${place} and is at ${await position_of(page)}`,
  );
  assert.equal(
    (await api_status(world.url)).players,
    1,
    "the avatar of before is there a second time",
  );

  // It is not only a picture: the avatar still obeys.
  await walk_until(page, (position) => distance(position, place) > 1);
  assert.deepEqual(without_refused_connections(complaints), []);
});
