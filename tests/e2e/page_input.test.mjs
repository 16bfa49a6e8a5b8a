// What the player does reaches the gateway as the wire format says: keys by their place, angles,
// actions, toggles.
import assert from "node:assert/strict";
import { test } from "node:test";
import { capture_pointer, statistics_of, wait_for_page } from "./support/browser.mjs";
import { eventually, mock_fixture } from "./support/mock_fixture.mjs";

const fixture = mock_fixture();

function last_input(gateway) {
  return gateway.messages("input").at(-1);
}

test("movement keys become bits while they are held, whatever letters are printed on them", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  for (const [code, bit] of [
    ["KeyW", 1],
    ["KeyS", 2],
    ["KeyA", 4],
    ["KeyD", 8],
    ["Space", 16],
    ["ShiftLeft", 32],
  ]) {
    await page.keyboard.down(code);
    await eventually(`${code} down`, () => last_input(gateway)?.keys === bit);
    await page.keyboard.up(code);
    await eventually(`${code} up`, () => last_input(gateway).keys === 0);
  }
  // A French keyboard: the key at the place of W says "z".
  await page.evaluate(() =>
    window.dispatchEvent(new KeyboardEvent("keydown", { code: "KeyW", key: "z" })),
  );
  await eventually("the place of W", () => last_input(gateway).keys === 1);
});

test("two keys for one direction: lifting one of them keeps it held", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  await page.keyboard.down("KeyW");
  await page.keyboard.down("ArrowUp");
  await page.keyboard.down("KeyD");
  await eventually("forward and right", () => last_input(gateway)?.keys === 9);
  await page.keyboard.up("KeyW");
  await page.keyboard.up("KeyD");
  await eventually("forward alone", () => last_input(gateway).keys === 1);
});

test("keys are released when the window loses the focus", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  await page.keyboard.down("KeyW");
  await eventually("W down", () => last_input(gateway)?.keys === 1);
  await page.evaluate(() => window.dispatchEvent(new Event("blur")));
  await eventually("W released", () => last_input(gateway).keys === 0);
});

test("shortcuts of the browser are left alone", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  const prevented = await page.evaluate(() => {
    const event = new KeyboardEvent("keydown", { code: "KeyR", ctrlKey: true, cancelable: true });
    window.dispatchEvent(event);
    return event.defaultPrevented;
  });
  assert.equal(prevented, false);
  await page.keyboard.press("KeyQ");
  await eventually("the blast", () => gateway.messages("action").length > 0);
  assert.deepEqual(
    gateway.messages("action").map((message) => message.action),
    ["blast"],
  );
});

test("the mouse turns the view: right makes yaw smaller, up makes pitch larger, within the limits", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  await capture_pointer(page);
  const before = await statistics_of(page);
  await page.mouse.move(740, 330, { steps: 5 });
  await wait_for_page(page, "a turn to the right", (a, yaw) => a.yaw < yaw - 0.05, before.yaw);
  await page.mouse.move(740, 230, { steps: 5 });
  await wait_for_page(page, "a look upwards", (a, pitch) => a.pitch > pitch + 0.05, before.pitch);
  const known = await statistics_of(page);
  await eventually(
    "the angles",
    () =>
      Math.abs(last_input(gateway).yaw - known.yaw) < 1e-5 &&
      Math.abs(last_input(gateway).pitch - known.pitch) < 1e-5,
  );
  for (let i = 0; i < 12; i++) {
    await page.mouse.move(740, 10, { steps: 4 });
    await page.mouse.move(740, 700, { steps: 4 });
  }
  await page.mouse.move(740, 710, { steps: 2 });
  assert.ok(Math.abs((await statistics_of(page)).pitch) <= 1.55);
});

test("many movements of the mouse are at most 60 inputs a second, and the last one arrives", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  await capture_pointer(page);
  const before = gateway.messages("input").length;
  await page.evaluate(async () => {
    for (let i = 0; i < 600; i++) {
      document.dispatchEvent(new MouseEvent("mousemove", { movementX: 1, movementY: 0 }));
      if (i % 10 === 0) await new Promise((resolve) => setTimeout(resolve, 5));
    }
  });
  const known = await statistics_of(page);
  await eventually("the last angle", () => Math.abs(last_input(gateway).yaw - known.yaw) < 1e-5);
  const sent = gateway.messages("input").length - before;
  assert.ok(sent > 5 && sent < 300, `600 movements became ${sent} inputs`);
});

test("a click throws what was chosen by number or by wheel; E, Q and R act", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  await capture_pointer(page);
  assert.equal(
    gateway.messages("action").length,
    0,
    "the click that captures the pointer threw something",
  );
  await page.keyboard.press("Digit3");
  await page.mouse.click(640, 330);
  await eventually("the throw", () => gateway.messages("action").at(-1)?.item === 3);
  await page.mouse.wheel(0, 100);
  await wait_for_page(page, "item 4", (a) => a.item === 4);
  await page.mouse.wheel(0, 100);
  await wait_for_page(page, "item 1", (a) => a.item === 1);
  await page.mouse.click(640, 330);
  for (const code of ["KeyE", "KeyQ", "KeyR"]) await page.keyboard.press(code);
  await eventually("five actions", () => gateway.messages("action").length === 5);
  const actions = gateway.messages("action").map(({ action, item }) => `${action} ${item}`);
  assert.deepEqual(actions, ["throw 3", "throw 1", "grab 1", "blast 1", "respawn 1"]);
  await page.waitForSelector("#carrying", { state: "visible" });
});

test("B and C ask for boundaries and region colours, and again for none", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing();
  const view = () => gateway.messages("view").at(-1);
  await page.keyboard.press("KeyB");
  await eventually("boundaries", () => view().boundaries && !view().region_colours);
  assert.equal(await page.getAttribute("#toggle-boundaries", "aria-pressed"), "true");
  await page.keyboard.press("KeyC");
  await eventually("colours", () => view().boundaries && view().region_colours);
  await page.keyboard.press("KeyB");
  await page.keyboard.press("KeyC");
  await eventually("neither", () => !view().boundaries && !view().region_colours);
});

test("the help greets a first visit, blocks the game, and is remembered", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing("");
  await page.waitForSelector("#help", { state: "visible" });
  await page.keyboard.press("KeyQ");
  await page.click("#start");
  await page.waitForSelector("#help", { state: "hidden" });
  await page.keyboard.press("KeyE");
  await eventually("the grab", () => gateway.messages("action").length > 0);
  assert.deepEqual(
    gateway.messages("action").map((message) => message.action),
    ["grab"],
  );
  await page.keyboard.press("KeyH");
  await page.waitForSelector("#help", { state: "visible" });
  await page.keyboard.press("KeyH");
  await page.waitForSelector("#help", { state: "hidden" });
  await page.reload();
  await wait_for_page(page, "pictures", (a) => a.frames_shown > 2);
  await page.waitForSelector("#resume", { state: "visible" });
  assert.equal(await page.isVisible("#help"), false);
});

test("fingers: a tap on the right throws, dragging there turns, the left half is a stick", async () => {
  const gateway = await fixture.start();
  const page = await fixture.open_playing("?autostart", {
    width: 900,
    height: 500,
    hasTouch: true,
  });
  await page.touchscreen.tap(700, 200);
  await eventually("the throw", () => gateway.messages("action").at(-1)?.action === "throw");
  const devtools = await page.context().newCDPSession(page);
  const touch = (type, ...points) =>
    devtools.send("Input.dispatchTouchEvent", {
      type,
      touchPoints: points.map(([x, y], id) => ({ x, y, id })),
    });
  const { yaw } = await statistics_of(page);
  await touch("touchStart", [700, 200]);
  await touch("touchMove", [760, 200]);
  await wait_for_page(page, "a turn to the right", (a, before) => a.yaw < before - 0.1, yaw);
  await touch("touchEnd");
  await touch("touchStart", [150, 300]);
  await touch("touchMove", [150, 260]);
  await eventually("walking", () => last_input(gateway).keys === 1);
  await touch("touchMove", [150, 180]);
  await eventually("running", () => last_input(gateway).keys === 33);
  await touch("touchEnd");
  await eventually("standing", () => last_input(gateway).keys === 0);
  assert.equal(gateway.messages("action").length, 1, "dragging threw something");
});
