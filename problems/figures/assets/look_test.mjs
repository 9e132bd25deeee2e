// The page of `look` in headless Chromium:  node look_test.mjs REPORT.html

import assert from "node:assert/strict";
import { colours, opened } from "./browser_page.mjs";

const { browser, page, complaints, milliseconds } = await opened(process.argv[2]);
try {
  const drawn = await colours(page);
  assert(drawn > 50, `the canvas shows ${drawn} colours`);
  const picture = async () => {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return (await page.$(".space-stage")).screenshot({ encoding: "base64" });
  };
  const select = (label, value) =>
    page.evaluate(
      (label, value) => {
        const labels = [...document.querySelectorAll(".space-line label")];
        const found = labels.find((own) => own.textContent.startsWith(label)).querySelector("select");
        found.value = value;
        found.dispatchEvent(new Event("change"));
      },
      label,
      String(value),
    );

  // A scene before its solve has no displacements, and a click says which face it is and what acts on it.
  const fields = () => page.evaluate(() => document.querySelector("figure.space").view.fields.map(({ name }) => name));
  assert.deepEqual(await fields(), ["what acts", "gap before loading"]);
  const frame = await (await page.$(".space-stage canvas")).boundingBox();
  await page.mouse.click(frame.x + frame.width / 2, frame.y + frame.height / 2);
  const told = await page.$eval(".space-told", (output) => output.textContent);
  assert.match(told, /node \d+ at \(.*\) mm: what acts (free|may touch|loaded|held)/);

  const first = await picture();
  await page.evaluate(() => document.querySelector("figure.space").view.turn(0.5, 0.2));
  assert(first !== (await picture()), "turning did not change the picture");
  const turned = await picture();
  await select("Colours", 1);
  assert(turned !== (await picture()), "the gaps look like what acts");
  assert.deepEqual(complaints, []);
  console.log(`open after ${Math.round(milliseconds)} ms; ${told}`);
} finally {
  await browser.close();
}
