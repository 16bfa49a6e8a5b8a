// What B and C lay over the picture. In a world of its own: avatars of other tests would leave the
// view meanwhile.
import { test } from "node:test";
import { stand_still } from "./support/avatar.mjs";
import { picture_difference, picture_pixels, quiet_picture } from "./support/browser.mjs";
import { play_fixture } from "./support/play_fixture.mjs";
import { eventually } from "./support/world.mjs";

const { playing } = play_fixture();

test("B and C change the picture and back", async () => {
  await playing(async (page) => {
    await stand_still(page);
    for (const [key, what, change_min] of [
      ["KeyC", "the regions' colours", 2],
      ["KeyB", "the regions' borders", 0.4],
    ]) {
      const { picture: plain, change: noise } = await quiet_picture(page);
      // As long as it takes: the key, the picture after it and its way here are late on a busy
      // machine.
      const changed_to = (condition, wanted) =>
        eventually(
          async () => condition(picture_difference(plain, await picture_pixels(page))),
          `${what} to ${wanted}; standing still, the picture changes by ${noise.toFixed(2)}`,
        );
      await page.keyboard.press(key);
      await changed_to((difference) => difference > change_min + 2 * noise, "be shown");
      await page.keyboard.press(key);
      await changed_to((difference) => difference < change_min / 2 + noise, "be gone again");
    }
  });
});
