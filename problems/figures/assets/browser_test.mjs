// The view in three dimensions in headless Chromium:  node browser_test.mjs REPORT.html PRESSURES.csv [FOLDER]
//
// REPORT.html is the report of an optimization, PRESSURES.csv its pressure_optimal.csv (with several load cases that of
// the first one). Screenshots are written into FOLDER, if it is given. CHROMIUM names the browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { colours, opened } from "./browser_page.mjs";

const [report, table, folder] = process.argv.slice(2);

/// The lines of a table, by the names of its columns.
function rows(path) {
  const [head, ...lines] = readFileSync(path, "utf8")
    .trim()
    .split("\n")
    .map((line) => line.split(","));
  return lines.map((cells) => Object.fromEntries(head.map((name, column) => [name, cells[column]])));
}

const { browser, page, figure, complaints, milliseconds } = await opened(report);
try {
  const told = () => page.$eval(".space-told", (output) => output.textContent);

  const canvas = await page.$(".space-stage canvas");
  const shot = async (name) => {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const picture = await (await page.$(".space-stage")).screenshot({ encoding: "base64" });
    if (folder && name) await (await page.$("figure.space")).screenshot({ path: join(folder, `${name}.png`) });
    return picture;
  };

  // The canvas shows more than its ground, and turning changes the picture.
  const drawn = await colours(page);
  await shot("view");
  assert(drawn > 50, `the canvas shows ${drawn} colours: ${complaints}`);
  const before = await shot("view");
  const frame = await canvas.boundingBox();
  const middle = [frame.x + frame.width / 2, frame.y + frame.height / 2];
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0] + 60, middle[1] + 40, { steps: 5 });
  await page.mouse.up();
  const turned = await shot("turned");
  assert(before !== turned, "dragging did not turn the bodies");
  await canvas.focus();
  await page.keyboard.press("ArrowLeft");
  assert(turned !== (await shot()), "the arrow key did not turn the bodies");
  // Without the frame around what has the keyboard.
  await canvas.evaluate((own) => own.blur());
  await page.evaluate(() => document.querySelector("figure.space").view.fit());
  assert(before === (await shot()), "the whole view is not the first one");

  // All pressures and statuses of the table are in the page, up to half a level.
  const shapes = await page.$$eval(".space-line select", ([shape]) => shape.options.length);
  const select = (index, value) =>
    page.evaluate(
      (index, value) => {
        const found = document.querySelectorAll(".space-line select")[index];
        found.value = value;
        found.dispatchEvent(new Event("change"));
      },
      index,
      String(value),
    );
  await select(0, shapes - 1);
  const nodes = await page.evaluate(() => {
    const { view } = document.querySelector("figure.space");
    return view.skins.flatMap((skin, body) =>
      [...skin.numbers.keys()].map((node) => ({ own: { body, node }, ...view.facts({ body, node }) })),
    );
  });
  const expected = rows(table).filter((row) => (row.contact ?? "1") === "1");
  const [pressure, status] = [0, 2];
  const found = expected.map((row) => {
    const place = [1, 2, 3].map((axis) => Number(row[`x${axis}_mm`]));
    const near = (node) =>
      !Number.isNaN(node.values[pressure].value ?? NaN) &&
      node.values[pressure].value !== null &&
      node.place.every(({ value, step }, axis) => Math.abs(value - place[axis]) <= 0.5001 * step + 1e-9);
    const [node, ...rest] = nodes.filter(near);
    assert(node && rest.length === 0, `${rest.length + 1} nodes at ${place}`);
    const { value, step } = node.values[pressure];
    assert(
      Math.abs(value - Number(row.pressure_MPa)) <= 0.5001 * step,
      `node ${node.number}: ${value} instead of ${row.pressure_MPa}`,
    );
    const { classes, value: number } = node.values[status];
    if (classes.length === 3) assert.equal(classes[number], row.status.toLowerCase());
    return { node, pressure: Number(row.pressure_MPa), step };
  });

  // A click at the place where a node is drawn says its number and its pressure.
  const highest = found.toSorted((a, b) => b.pressure - a.pressure).slice(0, 5);
  for (const { node, pressure, step } of highest) {
    const [x, y] = await page.evaluate((own) => document.querySelector("figure.space").view.project(own), node.own);
    const { x: left, y: top } = await canvas.boundingBox();
    await page.mouse.click(left + x, top + y);
    const words = await told();
    const [, number, value] = words.match(/node (\d+) at .*contact pressure ([-\d.e+]+) MPa/) ?? assert.fail(words);
    assert.equal(Number(number), node.number, words);
    // The last digit that is shown is the first one above the step.
    const unit = 10 ** -Math.floor(-Math.log10(step));
    assert(Math.abs(Number(value) - pressure) <= 0.5001 * (step + unit), `${words}: expected ${pressure}`);
  }
  const picked = await shot("picked");

  // Fields, displacements, shapes, the largest value and a node by its number.
  await select(2, 1);
  const stresses = await shot("stress");
  assert(picked !== stresses, "another field looks the same");
  await select(2, 2);
  assert(stresses !== (await shot("status")), "the status looks like the stress");
  await page.evaluate(() =>
    [...document.querySelectorAll(".space-line button")].find((button) => button.textContent === "× 0").click(),
  );
  await select(2, 0);
  assert(picked !== (await shot("undeformed")), "without displacements it looks the same");
  await page.evaluate(() =>
    [...document.querySelectorAll(".space-line button")]
      .find((button) => button.textContent === "Largest value")
      .click(),
  );
  assert((await told()).includes(`node ${highest[0].node.number} at`), await told());
  await page.$eval(".space-view form input", (input) => (input.value = "0"));
  await page.$eval(".space-view form", (form) => form.requestSubmit());
  assert.match(await told(), /, node 0 at \(/);
  await select(2, 3);
  if (shapes > 1) {
    const last = await shot("displacement");
    await select(0, 0);
    assert(last !== (await shot("start")), "the start looks like the optimum");
  }

  const cases = await page.$$eval(".space-line select", ([, own]) => own.options.length);
  if (cases > 1) {
    const first = await shot();
    await select(1, cases - 1);
    assert(first !== (await shot("case")), "the load cases look alike");
  }

  // Paper has the pictures only, as has a page without scripts.
  await page.emulateMediaType("print");
  assert.equal(await figure.evaluate((own) => getComputedStyle(own).display), "none");
  await page.emulateMediaType("screen");
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await shot("dark");
  await page.setViewport({ width: 400, height: 800 });
  await shot("narrow");
  await page.setJavaScriptEnabled(false);
  await page.reload();
  const still = await page.evaluate(() => [
    getComputedStyle(document.querySelector("figure.space")).display,
    document.body.innerText,
  ]);
  assert(still[0] === "none" && still[1].includes("needs scripts"));

  assert.deepEqual(complaints, []);
  console.log(`open after ${Math.round(milliseconds)} ms; ${expected.length} contact nodes agree with ${table}`);
} finally {
  await browser.close();
}
