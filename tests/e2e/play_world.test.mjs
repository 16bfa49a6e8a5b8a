// The whole thing: `aureole play` with a real browser. Pictures come, W walks, a thrown ball
// crosses a boundary.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  look_at,
  position_of,
  distance,
  stand_still,
  throw_once,
  walk_until,
  yaw_towards,
} from "./support/avatar.mjs";
import {
  keep_screenshot,
  picture_difference,
  picture_pixels,
  quiet_picture,
  statistics_of,
  wait_for_pictures,
} from "./support/browser.mjs";
import { play_fixture } from "./support/play_fixture.mjs";
import {
  api_status,
  eventually,
  eventually_status,
  is_thrown,
  migrations_of,
  pause,
  replicas,
} from "./support/world.mjs";

const { playing, url } = play_fixture();

test("the page loads, pictures arrive and are decoded, and the numbers agree with /api/status", async () => {
  await playing(async (page) => {
    await wait_for_pictures(page, 30);
    const known = await statistics_of(page);
    assert.equal(known.connected, true);
    assert.ok(known.frames_decoded >= 30);
    assert.deepEqual(
      [known.last_picture.width, known.last_picture.height],
      [known.view.width, known.view.height],
    );
    const status = await api_status(url());
    assert.equal(status.regions.length, 4);
    assert.ok(
      status.regions.every((region) => region.up),
      "a region is down",
    );
    assert.ok(
      status.regions.some((region) => region.name === known.status.region),
      `unknown region ${known.status.region}`,
    );
    assert.ok(status.bodies > 100, `the playground has only ${status.bodies} bodies`);
    assert.ok(status.players >= 1);
    const pixels = await picture_pixels(page);
    const mean = pixels.reduce((sum, value) => sum + value, 0) / pixels.length;
    const spread = Math.sqrt(
      pixels.reduce((sum, value) => sum + (value - mean) ** 2, 0) / pixels.length,
    );
    assert.ok(spread > 8, `the picture is one flat colour (deviation ${spread.toFixed(1)} of 255)`);
    await keep_screenshot(page, "play-playground");
  });
});

test("world time runs, and the pictures show it running", async () => {
  await playing(async (page) => {
    const before = await statistics_of(page);
    await pause(2000);
    const now = await statistics_of(page);
    assert.ok(now.status.world_time_s > before.status.world_time_s);
    assert.ok(
      now.last_picture.number > before.last_picture.number,
      "no new picture came in two seconds",
    );
    assert.ok(now.last_picture.world_time_us > before.last_picture.world_time_us);
  });
});

test("W moves the avatar and changes the picture; standing still does neither", async () => {
  await playing(async (page) => {
    const start = await stand_still(page);
    const { picture, change: idle } = await quiet_picture(page);
    assert.ok(distance(start, await position_of(page)) < 0.1, "the avatar moved by itself");

    await walk_until(page, (position) => distance(position, start) > 1.5);
    await stand_still(page);
    await wait_for_pictures(page);
    assert.ok(distance(start, await position_of(page)) > 1);
    const walked = picture_difference(picture, await picture_pixels(page));
    // Something far away may still roll while the avatar stands, so the walk is measured against
    // that.
    assert.ok(
      walked > 1 && walked > 3 * idle,
      `walking changed the picture by ${walked.toFixed(2)}, standing still by ${idle.toFixed(2)}`,
    );
  });
});

test("a thrown ball crosses the boundary that the avatar faces", async () => {
  await playing(async (page) => {
    // The playground is cut at x = 0 (and z = 0). Stand about 4 m before x = 0, away from z = 0,
    // and look straight across.
    const start = await stand_still(page);
    const side = start[0] < 0 ? -1 : 1;
    const away = start[2] < 0 ? -1 : 1;
    const stand = [side * 4, start[1], away * Math.max(6, Math.abs(start[2]))];
    if (distance(start, stand) > 1.5) {
      await look_at(page, yaw_towards(start, stand));
      await walk_until(
        page,
        (position) => Math.abs(position[0]) < 5 || distance(position, stand) < 1.5,
      );
    }
    const here = await stand_still(page);
    assert.ok(here[0] * side > 0.5, `the avatar walked past the boundary, to ${here}`);
    await look_at(page, yaw_towards(here, [-side * 20, here[1], here[2]]), 0.1);

    // What the world began with may still be on its way home: until nobody goes any more.
    let before = await api_status(url());
    for (let looks = 0; looks < 20; looks++) {
      await pause(3000);
      const after = await api_status(url());
      const quiet = migrations_of(after) === migrations_of(before);
      before = after;
      if (quiet) break;
    }
    const balls = 6;
    await page.keyboard.press("Digit1");
    for (let i = 0; i < balls; i++) {
      await throw_once(page);
      await pause(250);
    }
    // Not all bodies: avatars of earlier tests may leave the world meanwhile.
    await eventually(
      async () => (await replicas(url())).filter(is_thrown).length >= balls,
      `${balls} balls to be in the world`,
    );
    await eventually_status(
      url(),
      "balls to be handed over",
      (status) => migrations_of(status) >= migrations_of(before) + 3,
    );
    // On the other side, and simulated by a server of that side. Where the region of the avatar is
    // called north-west, those across are called north-east and south-east.
    const across = side < 0 ? "east" : "west";
    const crossed = await eventually(
      async () => {
        const balls_across = (await replicas(url())).filter(
          (body) => is_thrown(body) && body.position[0] * side < -0.6,
        );
        return balls_across.length > 0 && balls_across.every((body) => body.owner.endsWith(across));
      },
      "a thrown ball to lie beyond the boundary, with its new owner",
    );
    assert.ok(crossed);
    await keep_screenshot(page, "play-thrown");
  });
});
