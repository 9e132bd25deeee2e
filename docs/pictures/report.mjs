// Screenshots of a report in headless Chromium:  node report.mjs narrow|space REPORT.html PICTURE.png
//
// narrow: beginning and pressures of the page in a dark browser, 400 pixels wide, side by side.
// space: the view in three dimensions as it opens, with a node that was clicked. CHROMIUM names the browser.

import { opened } from "../../problems/figures/assets/browser_page.mjs";

const [kind, report, picture] = process.argv.slice(2);
const [WIDTH, HEIGHT, BETWEEN] = [400, 1290, 10];
/// A node of the contact face of the lug, in sight.
const NODE = 600;

/// Two parts of the page, as images on a page of their own.
async function narrow({ browser, page }) {
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await page.setViewport({ width: WIDTH, height: HEIGHT });
  const above = (figure) => figure.getBoundingClientRect().top + window.scrollY;
  const pressures = await page.$eval("figure.choice", above);
  const images = [];
  for (const y of [0, pressures - 10]) {
    const clip = { x: 0, y, width: WIDTH, height: HEIGHT };
    images.push(`<img src="data:image/png;base64,${await page.screenshot({ clip, encoding: "base64" })}">`);
  }
  const both = await browser.newPage();
  await both.setViewport({ width: 2 * WIDTH + BETWEEN, height: HEIGHT });
  const style = `<style>body { margin: 0; display: flex; gap: ${BETWEEN}px }</style>`;
  await both.setContent(`<!DOCTYPE html>${style}${images.join("")}`);
  await both.screenshot({ path: picture });
}

async function space({ page, figure }) {
  const [x, y] = await page.evaluate((number) => {
    const { view } = document.querySelector("figure.space");
    return view.project({ body: 0, node: view.skins[0].numbers.indexOf(number) });
  }, NODE);
  const { x: left, y: top } = await (await page.$(".space-stage canvas")).boundingBox();
  await page.mouse.click(left + x, top + y);
  await figure.screenshot({ path: picture });
}

const drawn = await opened(report, Infinity);
try {
  await { narrow, space }[kind](drawn);
} finally {
  await drawn.browser.close();
}
