// Opens a page of posecut-report in headless Chromium, as a reader would, and holds it to what it promises: no error
// on the console, no request but for the page itself, every section filled, layers, zoom, choices, themes and print work.
// Usage: node scripts/report/check.mjs PAGE.html [DIRECTORY_FOR_SCREENSHOTS]
// Needs playwright-core in NODE_PATH's place (scripts/check-report.sh installs it) and Chromium.
import { createRequire } from "node:module";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { narrow, print, themes } from "./appearance.mjs";
import { choices, filled } from "./content.mjs";
import { logs } from "./logs.mjs";
import { keyboard, layersAndZoom } from "./maps.mjs";
import { check, faults, file, said, settled } from "./page.mjs";
import { regimes } from "./regimes.mjs";

const { chromium } = createRequire(join(resolve(process.env.PLAYWRIGHT ?? "."), "x.js"))("playwright-core");
const address = pathToFileURL(resolve(file)).href;
const profile = mkdtempSync(join(tmpdir(), "posecut-browser-"));

const context = await chromium.launchPersistentContext(profile, {
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  headless: true,
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"],
  viewport: { width: 1280, height: 900 },
  colorScheme: "light",
});
try {
  const page = context.pages()[0] ?? (await context.newPage());
  const requests = [];
  page.on("console", (message) => said(`the console says: ${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => said(`a script fails: ${error.message}`));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(address);
  await settled(page);

  await filled(page);
  await choices(page);
  await layersAndZoom(page);
  await keyboard(page);
  await logs(page);
  await regimes(page);
  await themes(page);
  await narrow(page);
  await print(page);
  check(requests.every((url) => url === address), `the page asked for ${requests.filter((url) => url !== address).join(", ")}`);

  // The checks themselves can fail: a page that connects or throws must be seen.
  const before = faults.length;
  await page.evaluate(() => {
    const image = new Image();
    image.src = "https://example.org/x.png";
    document.body.append(image);
    setTimeout(() => { throw new Error("planted"); }, 0);
  });
  await page.waitForTimeout(300);
  const seen = faults.splice(before);
  check(seen.some((fault) => fault.includes("Content Security Policy")), "a connection is not refused by the page's policy");
  check(seen.some((fault) => fault.includes("planted")), "an error of a script is not noticed");
} catch (error) {
  faults.push(`the check cannot go on: ${error.message.split("\n")[0]}`);
} finally {
  await context.close();
  rmSync(profile, { recursive: true, force: true });
}
for (const fault of faults) console.error(`check-report: ${fault}`);
console.log(faults.length ? `${faults.length} faults in ${file}` : `${file}: the page works in Chromium`);
process.exitCode = faults.length ? 1 : 0;
