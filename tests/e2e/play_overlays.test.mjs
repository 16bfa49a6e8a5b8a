// What B and C lay over the picture. In a world of its own: avatars of other tests would leave the
// view meanwhile.
import { test } from "node:test";
import { stand_still } from "./support/avatar.mjs";
import {
  picture_difference,
  picture_pixels,
  picture_width,
  quiet_picture,
} from "./support/browser.mjs";
import { play_fixture } from "./support/play_fixture.mjs";
import { eventually } from "./support/world.mjs";

const { playing } = play_fixture();

/** Another width for so long is one that the page has chosen, not a picture or two. */
const other_width_ms = 5000;

/**
 * Waits until the picture differs from `plain` so that `condition` likes it, and returns the
 * `difference`: null if the page shows pictures of another width by then, which cannot be compared.
 * As long as it takes: the key, the picture after it and its way here are late on a busy machine.
 */
async function differs(page, plain, condition, what) {
  const differences = [];
  let as_wide_at = Date.now();
  try {
    return await eventually(async () => {
      const pixels = await picture_pixels(page);
      if ((await picture_width(page)) !== plain.width)
        return Date.now() - as_wide_at > other_width_ms && { difference: null };
      as_wide_at = Date.now();
      const difference = picture_difference(plain.picture, pixels);
      differences.push(difference);
      return condition(difference) && { difference };
    }, what);
  } catch (problem) {
    const told = differences.slice(-5).map((difference) => difference.toFixed(2));
    throw new Error(`${problem.message}; it differed by ${told}, still ${plain.change.toFixed(2)}`);
  }
}

/** Whether it has been seen: false if the page went over to pictures of another width meanwhile. */
async function comes_and_goes(page, { key, what, change_min }) {
  const width = await picture_width(page);
  const plain = { ...(await quiet_picture(page)), width };
  if ((await picture_width(page)) !== width) return false;
  await page.keyboard.press(key);
  const shown = await differs(
    page,
    plain,
    (difference) => difference > change_min + 2 * plain.change,
    `${what} to come`,
  );
  await page.keyboard.press(key);
  if (shown.difference === null) return false;
  // Something far away may have moved meanwhile.
  const gone = await differs(
    page,
    plain,
    (difference) => difference < shown.difference / 2,
    `${what} to go`,
  );
  return gone.difference !== null;
}

test("B and C change the picture and back", async () => {
  await playing(async (page) => {
    await stand_still(page);
    for (const overlay of [
      { key: "KeyC", what: "the regions' colours", change_min: 2 },
      { key: "KeyB", what: "the regions' borders", change_min: 0.4 },
    ]) {
      // A page that is slow asks for smaller pictures, and later for larger ones again.
      let seen = false;
      for (let tries = 0; !seen && tries < 4; tries++) seen = await comes_and_goes(page, overlay);
      if (!seen) throw new Error(`${overlay.what}: pictures never stayed as wide as they were`);
    }
  });
});
