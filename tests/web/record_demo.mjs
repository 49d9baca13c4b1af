// Draws frames of a recording one by one: node record_demo.mjs URL FOLDER FIRST APART COUNT (steps). Called by
// scripts/record_demo.sh.
import { launchBrowser, openPage } from "./browser.mjs";

const [url, folder, ...numbers] = process.argv.slice(2);
const [first, apart, count] = numbers.map(Number);
const browser = await launchBrowser();
const page = await openPage(browser, `${url}?quality=medium`, { width: 960, height: 540 });
await page.waitForFunction(() => window.aurasim?.mode === "replay" && window.aurasim.bodies().length > 0, null, { timeout: 60000 });
await page.evaluate(() => document.querySelector('#transport button[aria-label^="Pause"]')?.click());
await page.waitForSelector('#transport button[aria-label^="Go on"]');
await page.keyboard.press("h"); // the panels: the world is what is to be seen
await page.mouse.move(480, 270);
for (let i = 0; i < 5; ++i) await page.mouse.wheel(0, -60);
for (let i = 0; i < count; ++i) {
  const step = first + i * apart;
  await page.evaluate((at) => {
    const bar = document.querySelector("#transport input.seek");
    bar.value = String(at);
    bar.dispatchEvent(new Event("input"));
  }, step);
  await page.waitForFunction((at) => Math.abs(window.aurasim.lastStamp - at) < 6 && window.aurasim.shownStamp >= window.aurasim.lastStamp - 0.1,
    step, { timeout: 30000, polling: 20 });
  await page.waitForTimeout(i === 0 ? 2000 : 100); // the camera comes to rest; the last changes are drawn
  await page.screenshot({ path: `${folder}/${String(i).padStart(3, "0")}.png` });
}
await browser.close();
