// A world by `aureole play` and a browser for the tests of one file, and players in it.
import assert from "node:assert/strict";
import { after, before } from "node:test";
import { wait_for_status } from "./avatar.mjs";
import { launch_browser, open_page, statistics_of, wait_for_pictures } from "./browser.mjs";
import { start_play } from "./world.mjs";

export function play_fixture() {
  let browser = null;
  let world = null;
  before(async () => {
    world = await start_play();
    browser = await launch_browser();
  });
  after(async () => {
    await browser?.close();
    await world?.stop();
  });

  return {
    url: () => world.url,

    /**
     * Opens the page, waits until it plays, runs the test, and checks that the page complained
     * about nothing. The avatar stays in the world for another 30 s.
     */
    async playing(run) {
      const { page, complaints } = await open_page(browser, `${world.url}/?autostart`);
      try {
        await wait_for_pictures(page);
        await wait_for_status(page);
        await run(page);
        const known = await statistics_of(page);
        assert.deepEqual(complaints, [], "the page wrote errors or warnings to the console");
        assert.equal(known.bad_messages, 0, `the page skipped a message: ${known.last_problem}`);
      } finally {
        await page.context().close();
      }
    },
  };
}
