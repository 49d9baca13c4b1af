// Takes pictures of the page over the mock overseer, to be looked at: node shots.mjs [FOLDER]
import { mkdir } from "node:fs/promises";
import { openPage, launchBrowser } from "./browser.mjs";
import { MockOverseer } from "./mock_overseer.mjs";

const folder = process.argv[2] ?? "screenshots";
await mkdir(folder, { recursive: true });
const browser = await launchBrowser();

async function withMock(options, take, query = "") {
  const mock = new MockOverseer(options);
  const page = await openPage(browser, (await mock.start()) + query);
  try {
    await page.waitForFunction((n) => window.aurasim.bodies().length >= n, options.bodies ?? 300);
    await page.waitForTimeout(3500);
    await take(page, mock);
  } finally {
    await page.close();
    await mock.stop();
  }
}
const shoot = (page, name) => page.screenshot({ path: `${folder}/${name}.png` });

await withMock({}, (page) => shoot(page, "best"), "?quality=best");
if (process.argv[3] === "best") process.exit(0);
await withMock({}, async (page) => {
  await shoot(page, "normal");
  for (const key of ["u", "l", "k", "v"]) await page.keyboard.press(key);
  const { id } = await page.evaluate(() => window.aurasim.bodies()[5]);
  const at = await page.evaluate((n) => window.aurasim.pixelOf(n), id);
  await page.mouse.click(at.x, at.y);
  await page.waitForTimeout(1500);
  await shoot(page, "overlays");
  await page.keyboard.press("?");
  await page.waitForTimeout(400);
  await shoot(page, "help");
  await page.keyboard.press("Escape");
  await page.keyboard.press("4");
  await page.mouse.move(760, 560);
  await page.waitForTimeout(700);
  await shoot(page, "place");
  await page.keyboard.press("1");
  await page.keyboard.press("r");
  await page.waitForTimeout(700);
  await shoot(page, "regions");
  await page.keyboard.press("Escape");
  await page.setViewportSize({ width: 420, height: 820 });
  await page.waitForTimeout(900);
  await shoot(page, "narrow");
});
await withMock({ replay: true }, (page) => shoot(page, "replay"));
await withMock({ bodies: 10000 }, async (page) => {
  await page.waitForTimeout(8000);
  console.log("10,000 bodies:", await page.evaluate(() => ({ fps: window.aurasim.fps, quality: window.aurasim.quality, device: window.aurasim.device })));
  await shoot(page, "ten_thousand");
});
await browser.close();
