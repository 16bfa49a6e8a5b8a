// What B and C lay over the picture. In a world of its own: avatars of other tests would leave the
// view meanwhile.
import { test } from "node:test";
import { stand_still } from "./support/avatar.mjs";
import {
  picture_difference,
  picture_kind,
  picture_pixels,
  quiet_picture,
} from "./support/browser.mjs";
import { play_fixture } from "./support/play_fixture.mjs";
import { eventually } from "./support/world.mjs";

const { playing } = play_fixture();

/** Another kind of pictures for so long is one that was chosen, not a picture or two. */
const other_kind_ms = 5000;

/**
 * Waits until the picture differs from `plain` so that `condition` likes it, and returns the
 * `difference`: null if the page shows pictures of another kind by then, which cannot be compared.
 * As long as it takes: the key, the picture after it and its way here are late on a busy machine.
 */
async function differs(page, plain, condition, what) {
  const differences = [];
  let alike_at = Date.now();
  try {
    return await eventually(async () => {
      const pixels = await picture_pixels(page);
      if ((await picture_kind(page)) !== plain.kind)
        return Date.now() - alike_at > other_kind_ms && { difference: null };
      alike_at = Date.now();
      const difference = picture_difference(plain.picture, pixels);
      differences.push(difference);
      return condition(difference) && { difference };
    }, what);
  } catch (problem) {
    const told = differences.slice(-5).map((difference) => difference.toFixed(2));
    const still = `still ${plain.change.toFixed(2)}, ${plain.kind}`;
    throw new Error(`${problem.message}; it differed by ${told}, ${still}`);
  }
}

/** Whether it has been seen: false if the page went over to pictures of another kind meanwhile. */
async function comes_and_goes(page, { key, what, change_min }) {
  const kind = await picture_kind(page);
  const plain = { ...(await quiet_picture(page)), kind };
  if ((await picture_kind(page)) !== kind) return false;
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
      // A page that is slow gets smaller and cheaper pictures, and later better ones again.
      let seen = false;
      for (let tries = 0; !seen && tries < 8; tries++) seen = await comes_and_goes(page, overlay);
      if (!seen) throw new Error(`${overlay.what}: pictures never stayed of the kind that they were`);
    }
  });
});
