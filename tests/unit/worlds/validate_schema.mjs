// Holds world.schema.json to the shipped worlds: they fit it, and copies broken in one place do not.
// Usage: node validate_schema.mjs <root of the source tree>
import { readdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

function fail(sentence) {
  console.error(sentence);
  process.exit(1);
}

const root = process.argv[2] ?? fail("usage: validate_schema.mjs <root of the source tree>");
const folder = join(root, "server/worlds/library");

let Ajv;
try {
  const loaded = createRequire(join(root, "web/package.json"))("ajv");
  Ajv = loaded.default ?? loaded;
} catch (error) {
  fail(`ajv cannot be loaded from web/node_modules (${error.code ?? error.message}): run ./test, which installs it, or "npm ci" in web/`);
}

const schema = JSON.parse(readFileSync(join(folder, "world.schema.json"), "utf8"));
const validate = new Ajv({ allErrors: false, strict: true, strictRequired: false, strictTypes: false }).compile(schema);
const said = () => validate.errors.map((e) => `${e.instancePath || "/"} ${e.message}`).join("; ");

const names = readdirSync(folder).filter((f) => f.endsWith(".json") && f !== "world.schema.json");
if (names.length < 5) fail(`found ${names.length} worlds in ${folder}, expected the five that are shipped`);
for (const name of names) {
  if (!validate(JSON.parse(readFileSync(join(folder, name), "utf8")))) fail(`${name} does not fit the schema: ${said()}`);
}

const page = readFileSync(join(root, "docs/worlds.md"), "utf8");
const example = /```json\n([\s\S]*?)```/.exec(page) ?? fail("docs/worlds.md has no JSON example");
if (!validate(JSON.parse(example[1]))) fail(`the example in docs/worlds.md does not fit the schema: ${said()}`);

// A schema that lets everything pass would have passed the above.
const breakages = {
  "an unknown key": (w) => (w.colour = "#ffffff"),
  "no name": (w) => delete w.name,
  "no regions": (w) => (w.regions = []),
  "a region's side as text": (w) => (w.regions[0].area.max_x = "abc"),
  "negative mass": (w) => (w.definitions.brick.mass_kg = -1),
  "two masses": (w) => (w.definitions.brick.mass_kg = 1),
  "a box without size": (w) => delete w.definitions.brick.shape.size,
  "an unknown shape": (w) => (w.definitions.brick.shape = { type: "torus", radius: 1 }),
  "two constructs": (w) => (w.bodies[0].wall = { length: 1, rows: 1 }),
  "a short position": (w) => w.bodies[0].position.pop(),
  "a bad colour": (w) => (w.avatar.colour = "#12345g"),
  "three throwables": (w) => w.throwables.pop(),
  "no spawn point": (w) => (w.spawn_points = []),
  "an unknown mode": (w) => (w.mode = "fast"),
};
const playground = readFileSync(join(folder, "playground.json"), "utf8");
for (const [what, break_it] of Object.entries(breakages)) {
  const world = JSON.parse(playground);
  break_it(world);
  if (validate(world)) fail(`the schema accepts a playground with ${what}, expected it to refuse`);
}
console.log(`${names.length} worlds and the example fit the schema; ${Object.keys(breakages).length} broken worlds do not`);
