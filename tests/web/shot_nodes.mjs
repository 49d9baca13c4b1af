// Pictures of the page with 4 and 9 nodes at 1280 and 760 pixels, as docs/viewer.md shows them: node shot_nodes.mjs [FOLDER]
import { mkdir } from "node:fs/promises";
import { openPage, launchBrowser } from "./browser.mjs";
import { MockOverseer } from "./mock_overseer.mjs";

const folder = process.argv[2] ?? "screenshots";
await mkdir(folder, { recursive: true });
const browser = await launchBrowser();
for (const nodes of [4, 9]) {
  const mock = new MockOverseer({ nodes, bodies: 300 });
  const url = await mock.start();
  for (const [width, height] of [[1280, 800], [760, 900]]) {
    const page = await openPage(browser, `${url}?quality=plain`, { width, height });
    await page.waitForFunction((n) => window.aurasim?.bodies().length >= n, 300, { polling: 200, timeout: 120000 });
    await page.waitForSelector(".node", { state: "attached", timeout: 120000 });
    await page.waitForTimeout(4000);
    await page.screenshot({ path: `${folder}/nodes_${nodes}_${width}.jpg`, type: "jpeg", quality: 82, timeout: 120000 });
    if (width < 860) {
      await page.keyboard.press("h"); // the panels are hidden on a small screen
      await page.waitForTimeout(1500);
      await page.screenshot({ path: `${folder}/nodes_${nodes}_${width}_panels.jpg`, type: "jpeg", quality: 82, timeout: 120000 });
    }
    await page.close();
  }
  await mock.stop();
}
await browser.close();
