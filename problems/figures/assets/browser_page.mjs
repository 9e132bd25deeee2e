// A report with a view in three dimensions in headless Chromium. CHROMIUM names the browser.

import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

/// Opens a report with the view in it, and waits until it is drawn: the browser, its page, the figure, what the page
/// complains about, and the milliseconds it took, at most `most`. The browser is closed where that fails.
export async function opened(report, most = 3000) {
  const browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: [
      "--no-sandbox",
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--ignore-gpu-blocklist",
    ],
  });
  try {
    const page = await browser.newPage();
    await page.setViewport({ width: 1100, height: 900 });
    const complaints = [];
    page.on("console", (message) => ["error", "warn"].includes(message.type()) && complaints.push(message.text()));
    page.on("pageerror", (error) => complaints.push(String(error)));
    page.on(
      "request",
      (request) => /^(file|data|blob):/.test(request.url()) || complaints.push(`loads ${request.url()}`),
    );

    const begun = performance.now();
    await page.goto(pathToFileURL(resolve(report)).href);
    const figure = await page.$("figure.space");
    assert(figure, "the report has no view in three dimensions");
    await figure.evaluate((own) => own.scrollIntoView());
    const ready = () =>
      document.querySelector("figure.space").dataset.ready ||
      document.querySelector(".space-view").textContent.includes("cannot");
    await page.waitForFunction(ready, { timeout: 20000 });
    const milliseconds = performance.now() - begun;
    // The view may take the place of higher pictures.
    await figure.evaluate((own) => own.scrollIntoView());
    assert(
      !(await page.$eval(".space-view", (view) => view.textContent)).includes("cannot"),
      await page.$eval(".space-view", (view) => view.textContent),
    );
    assert(milliseconds < most, `open after ${milliseconds} ms`);
    return { browser, page, figure, complaints, milliseconds };
  } catch (error) {
    await browser.close();
    throw error;
  }
}

/// How many colours the canvas shows.
export const colours = (page) =>
  page.evaluate(() => {
    const { view } = document.querySelector("figure.space");
    view.draw();
    const gl = view.renderer.getContext();
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return new Set(new Uint32Array(pixels.buffer)).size;
  });
