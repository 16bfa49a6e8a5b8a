// The connection is lost, refused, silent or hostile: the page says so, goes on by itself where it
// may, and never breaks.
import assert from "node:assert/strict";
import { test } from "node:test";
import { picture_header } from "./mock_gateway.mjs";
import {
  keep_screenshot,
  statistics_of,
  wait_for_page,
  wait_for_pictures,
} from "./support/browser.mjs";
import { eventually, mock_fixture } from "./support/mock_fixture.mjs";

const fixture = mock_fixture();

test("after the gateway is killed and comes back the player goes on with the same avatar", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  await page.keyboard.press("KeyB");
  const before = await statistics_of(page);
  await page.keyboard.down("KeyW");
  await gateway.stop();
  await page.waitForSelector("#notice", { state: "visible" });
  assert.equal(await page.textContent("#notice-title"), "Connection lost");
  await wait_for_page(page, "the loss", (a) => !a.connected && a.rtt_ms === null);
  await eventually("the grace to be counted down", async () =>
    /another 2\d s/.test(await page.textContent("#notice-text")),
  );
  await keep_screenshot(page, "page-connection-lost");
  await gateway.start();
  await wait_for_page(
    page,
    "the connection",
    (a) => a.connected && a.resumed && a.reconnects === 1,
  );
  await wait_for_pictures(page);
  await page.waitForSelector("#notice", { state: "hidden" });
  const known = await statistics_of(page);
  assert.equal(known.token, before.token);
  assert.equal(known.player, before.player);
  // What was switched on and what is still held is told to the new connection.
  const after_join = gateway.received.slice(
    gateway.received.map((message) => message.type).lastIndexOf("join"),
  );
  assert.equal(after_join[0].token, before.token);
  assert.ok(after_join.some((message) => message.type === "view" && message.boundaries));
  assert.ok(after_join.some((message) => message.type === "input" && message.keys === 1));
});

test("a reload of the page keeps the avatar", async () => {
  await fixture.start();
  const page = await fixture.open_playing();
  const before = await statistics_of(page);
  await page.reload();
  await wait_for_page(
    page,
    "the same player",
    (a, token) => a.resumed && a.token === token,
    before.token,
  );
  assert.equal((await statistics_of(page)).player, before.player);
});

test("a player who was forgotten is told that they start anew", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  const before = await statistics_of(page);
  gateway.forget_players();
  gateway.drop_connections();
  await wait_for_page(
    page,
    "a new token",
    (a, token) => a.connected && a.token !== token,
    before.token,
  );
  await eventually("the note", async () => /start anew/.test(await page.textContent("#notes")));
});

test("an error is shown as its sentence, nothing is retried unasked, and the button tries again", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  gateway.refuse("Another page has taken over this <b>player</b>.");
  await page.waitForSelector("#notice", { state: "visible" });
  assert.equal(
    await page.textContent("#notice-text"),
    "Another page has taken over this <b>player</b>.",
  );
  await keep_screenshot(page, "page-error");
  await page.waitForTimeout(1500);
  assert.equal(gateway.messages("join").length, 1, "the page joined again although it was refused");
  await page.click("#retry");
  await wait_for_page(page, "the connection", (a) => a.connected);
  await page.waitForSelector("#notice", { state: "hidden" });
});

test("a join that is refused shows why", async () => {
  const gateway = await fixture.start();
  gateway.refuse_with = "This world is full.";
  const page = await fixture.open();
  await page.waitForSelector("#notice", { state: "visible" });
  assert.equal(await page.textContent("#notice-text"), "This world is full.");
});

test("who joins a world that is not complete is told what is missing, and goes in by itself", async () => {
  const gateway = await fixture.start();
  const text = async () => page.textContent("#notice-text");
  gateway.missing = ["south-west", "r2"];
  const page = await fixture.open("");
  await page.waitForSelector("#notice", { state: "visible" });
  assert.equal(await page.textContent("#notice-title"), "The world is not complete yet");
  assert.equal(
    await text(),
    "Waiting for south-west and r2. You go in as soon as they are there.",
  );
  assert.equal(await page.isVisible("#retry"), false);
  assert.equal(await page.isVisible("#help"), false);
  await keep_screenshot(page, "page-waiting");
  for (const [missing, names] of [
    [["a", "b", "c"], /for a, b and c\. .* they are/],
    [["a", "b", "c", "d", "e"], /for a, b, c and 2 more\. .* they are/],
    [["<b>r2</b>"], /for <b>r2<\/b>\. .* it is/],
  ]) {
    gateway.missing = missing;
    await eventually("what is missing", async () => names.test(await text()));
  }
  assert.equal((await statistics_of(page)).state, "waiting");
  gateway.complete();
  await wait_for_pictures(page);
  await page.waitForSelector("#notice", { state: "hidden" });
  await page.waitForSelector("#help", { state: "visible" });
  assert.equal(await page.evaluate(() => document.activeElement.id), "start");
  assert.equal(gateway.messages("join").length, 1);
});

test("while the world is not complete the page hears of a loss and of silence, and joins again", async () => {
  const gateway = await fixture.start();
  gateway.missing = ["r2"];
  const page = await fixture.open();
  const title = (wanted) =>
    eventually(wanted, async () => (await page.textContent("#notice-title")) === wanted);
  await title("The world is not complete yet");
  await gateway.stop();
  // Nobody has let this page in: it has no avatar to speak of.
  await title("No answer yet");
  assert.equal(
    await page.textContent("#notice-text"),
    "The world does not answer yet. Trying again.",
  );
  assert.equal(await page.isVisible("#retry"), true);
  await page.waitForTimeout(1200);
  assert.doesNotMatch(await page.textContent("#notice-text"), /avatar/);
  await keep_screenshot(page, "page-no-answer");
  await gateway.start();
  await title("The world is not complete yet");
  gateway.mute = true;
  await title("No answer yet");
  gateway.mute = false;
  await title("The world is not complete yet");
  gateway.complete();
  await wait_for_pictures(page);
  await page.waitForSelector("#notice", { state: "hidden" });
});

test("a connection on which nothing is heard counts as lost", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  gateway.mute = true;
  await wait_for_page(page, "the loss", (a) => !a.connected);
  gateway.mute = false;
  await wait_for_page(page, "the connection", (a) => a.connected && a.resumed);
  await wait_for_pictures(page);
});

test("broken pictures and messages are counted and skipped", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  const jpeg = gateway.pictures.jpegs[0];
  const hostile_pictures = [
    Buffer.alloc(0),
    Buffer.from([1]),
    picture_header().subarray(0, 31),
    picture_header(),
    Buffer.concat([picture_header({ kind: 2 }), jpeg]),
    Buffer.concat([picture_header({ codec: 9 }), jpeg]),
    Buffer.concat([picture_header({ header_bytes: 31 }), jpeg]),
    Buffer.concat([picture_header({ header_bytes: 65535 }), jpeg.subarray(0, 100)]),
    Buffer.concat([picture_header({ width: 0 }), jpeg]),
  ];
  const hostile_texts = [
    "",
    "{",
    "null",
    "[]",
    '{"type":"status"}',
    '{"type":"status","fps":"60"}',
    '{"type":"pong"}',
    '{"type":"pong","t":1e999}',
    '{"type":"welcome","version":1,"token":"short"}',
    '{"type":"error","message":7}',
    '{"type":"waiting"}',
    '{"type":"waiting","missing":"r2"}',
    '{"type":"waiting","missing":[2]}',
    `{"type":"waiting","missing":[${"\"\",".repeat(4096)}""]}`,
    `"${"a".repeat(70_000)}"`,
  ];
  for (const bytes of hostile_pictures) gateway.send_binary(bytes);
  for (const text of hostile_texts) gateway.send_text(text);
  const expected = hostile_pictures.length + hostile_texts.length;
  await wait_for_page(page, "all to be counted", (a, count) => a.bad_messages === count, expected);
  gateway.send_text('{"type":"from a newer server","value":1}');
  await wait_for_pictures(page);
  const known = await statistics_of(page);
  assert.equal(known.connected, true);
  assert.equal(known.bad_messages, expected);
});

test("a picture that is no JPEG is acknowledged, so that the gateway's window does not close", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  gateway.stalled = true;
  const { rules } = [...gateway.clients][0];
  await eventually("all acknowledgements", () => rules.acked.size === rules.sent.size);
  const number = 1_000_000;
  rules.sent.add(number);
  gateway.send_binary(
    Buffer.concat([picture_header({ number }), Buffer.from("this is no JPEG at all")]),
  );
  await eventually("its acknowledgement", () => rules.acked.has(number));
  assert.match((await statistics_of(page)).last_problem, /could not be decoded/);
  gateway.stalled = false;
  await wait_for_pictures(page);
});

test("a longer header of a newer server is skipped", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  gateway.stalled = true;
  const number = 2_000_000;
  for (const { rules } of gateway.clients) rules.sent.add(number);
  const longer = Buffer.concat([
    picture_header({ number, header_bytes: 40 }),
    Buffer.alloc(8, 0xff),
    gateway.pictures.jpegs[1],
  ]);
  gateway.send_binary(longer);
  await wait_for_page(page, "the picture", (a, wanted) => a.last_picture.number === wanted, number);
});

test("a browser that forbids storage still plays", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open("?autostart");
  await page.addInitScript(() => {
    for (const name of ["localStorage", "sessionStorage"]) {
      Object.defineProperty(window, name, {
        get: () => {
          throw new DOMException("forbidden", "SecurityError");
        },
      });
    }
  });
  await page.goto(`${gateway.url}/`);
  await page.click("#start");
  await wait_for_pictures(page);
});
