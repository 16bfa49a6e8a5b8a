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

test("B and C change the picture and back", async () => {
  await playing(async (page) => {
    await stand_still(page);
    for (const [key, what, change_min] of [
      ["KeyC", "the regions' colours to come and go", 2],
      ["KeyB", "the regions' borders to come and go", 0.4],
    ]) {
      const { picture: plain, change: noise } = await quiet_picture(page);
      const width = await picture_width(page);
      const differences = [];
      let width_now = width;
      // As long as it takes: the key, the picture after it and its way here are late on a busy
      // machine.
      const differs = async (condition) => {
        try {
          await eventually(async () => {
            differences.push(picture_difference(plain, await picture_pixels(page)));
            // A smaller one is not the same, whatever lies over it.
            width_now = await picture_width(page);
            return width_now === width && condition(differences.at(-1));
          }, what);
        } catch (problem) {
          const told = differences.slice(-5).map((difference) => difference.toFixed(2));
          throw new Error(`${problem.message}; it differed by ${told}, still ${noise.toFixed(2)}; ${width_now} of ${width} pixels wide`);
        }
        return differences.at(-1);
      };
      await page.keyboard.press(key);
      const shown = await differs((difference) => difference > change_min + 2 * noise);
      await page.keyboard.press(key);
      // Something far away may have moved meanwhile.
      await differs((difference) => difference < shown / 2);
    }
  });
});
