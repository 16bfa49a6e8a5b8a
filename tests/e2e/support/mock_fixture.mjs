// One browser and one mock gateway for the tests of a file, and the checks that hold after every
// one of them.
import assert from "node:assert/strict";
import { after, afterEach, before } from "node:test";
import { MockGateway } from "../mock_gateway.mjs";
import {
  launch_browser,
  open_page,
  wait_for_pictures,
  without_refused_connections,
} from "./browser.mjs";
import { draw_pictures } from "./pictures.mjs";

/** Registers the set-up; the fields are there once the first test runs. */
export function mock_fixture() {
  const fixture = { browser: null, gateway: null, opened: [] };
  let pictures = null;

  before(async () => {
    fixture.browser = await launch_browser();
    pictures = await draw_pictures(fixture.browser);
  });
  after(async () => {
    await fixture.browser?.close();
  });

  /** A gateway of its own for each test. */
  fixture.start = async () => {
    fixture.gateway = await new MockGateway(pictures).start();
    return fixture.gateway;
  };
  /** Opens the page; its complaints are checked when the test ends. */
  fixture.open = async (query = "?autostart", options = {}) => {
    const opened = await open_page(fixture.browser, `${fixture.gateway.url}/${query}`, options);
    fixture.opened.push(opened);
    return opened.page;
  };
  fixture.open_playing = async (query, options) => {
    const page = await fixture.open(query, options);
    await wait_for_pictures(page);
    return page;
  };

  afterEach(async () => {
    const complaints = fixture.opened.flatMap((opened) =>
      without_refused_connections(opened.complaints),
    );
    for (const { page } of fixture.opened) await page.context().close();
    fixture.opened = [];
    const violations = fixture.gateway?.violations ?? [];
    await fixture.gateway?.stop();
    fixture.gateway = null;
    assert.deepEqual(complaints, [], "the page wrote errors or warnings to the console");
    assert.deepEqual(violations, [], "the page broke the wire format");
  });
  return fixture;
}

/** Waits until a condition on this side holds, such as a message that the gateway received. */
export async function eventually(what, condition, timeout_ms = 30_000) {
  const until_ms = performance.now() + timeout_ms;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (performance.now() > until_ms) throw new Error(`Waited ${timeout_ms / 1000} s for: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 25));
  }
}
