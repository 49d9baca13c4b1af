// A browser without a screen and without a graphics card, for tests of the page.
import { chromium } from "playwright-core";

const CHROMIUM = process.env.AURASIM_CHROMIUM ?? "/usr/bin/chromium";

// Without a graphics card what is put together from layers is put together faster by the processor (measured: twice the
// frames a second).
export const launchBrowser = () => chromium.launch({ executablePath: CHROMIUM, headless: true, ignoreDefaultArgs: ["--hide-scrollbars"],
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing"] });

/** Drags from here to there, again if the page was too busy to notice, until the selector is visible. */
export async function dragUntil(page, from, to, selector) {
  for (let tries = 0; tries < 10; ++tries) {
    await page.mouse.move(...from);
    await page.waitForTimeout(100 * tries);
    await page.mouse.down();
    await page.waitForTimeout(100 * tries);
    await page.mouse.move(...to, { steps: 4 });
    await page.mouse.up();
    try {
      return await page.waitForSelector(selector, { timeout: 2000 });
    } catch (error) {
      if (tries === 9) throw error;
    }
  }
}

/** A page that has failed loudly if anything in it threw. */
export async function openPage(browser, url, size = { width: 1440, height: 860 }) {
  const page = await browser.newPage({ viewport: size });
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(String(error)));
  page.on("console", (message) => {
    // A server that is away is part of the tests; what the browser says about it is not an error of the page.
    if (message.type() === "error" && !/ERR_CONNECTION|Failed to load resource|WebSocket/.test(message.text())) page.errors.push(message.text());
  });
  await page.goto(url);
  return page;
}
