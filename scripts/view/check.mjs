// Opens a page of posecut-view in headless Chromium, as a reader would, and checks that it does what it promises: no error on the
// console, no request but for the page itself, filters, table, details of edges, both sets of poses, hypotheses, themes, keys.
// Usage: node scripts/view/check.mjs PAGE.html [DIRECTORY_FOR_SCREENSHOTS]
// Needs playwright-core in PLAYWRIGHT (scripts/check-view.sh installs it) and Chromium.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { narrow, themes } from "../report/appearance.mjs";
import { check, faults, file, said, settled, shot } from "../report/page.mjs";
import { card, search } from "./card.mjs";
import { filters } from "./filters.mjs";
import { keyboard } from "./keyboard.mjs";
import { hypotheses, planes, poses, zoom } from "./map.mjs";
import { tap } from "./phone.mjs";
import { speed } from "./speed.mjs";
import { address, panels, table } from "./table.mjs";

const { chromium } = createRequire(join(resolve(process.env.PLAYWRIGHT ?? "."), "x.js"))("playwright-core");
const place = pathToFileURL(resolve(file)).href;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  headless: true,
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"],
});

/** A page in a window of its own; whatever goes wrong there is noted. */
async function opened(options, requests = []) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, colorScheme: "light", reducedMotion: "reduce", ...options });
  const page = await context.newPage();
  page.on("console", (message) => said(`the console says: ${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => said(`a script fails: ${error.message}`));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(place);
  await settled(page);
  return page;
}

let measured = "";
try {
  const requests = [], start = performance.now();
  const page = await opened({}, requests);
  const shown = Math.round(performance.now() - start);
  const data = await page.evaluate(() => JSON.parse(document.getElementById("data").textContent));
  await shot(page, "light", {});
  const frame = await speed(page, data);
  measured = `shown after ${shown} ms${frame === null ? "" : `, ${frame} ms a frame`}`;
  const words = await page.evaluate(() => document.body.innerText);
  if (!data.edges.label) check(!/correct/i.test(words), "the page calls edges correct or incorrect, although nobody labelled them");
  check((await page.getAttribute("#map", "aria-label")).includes(`${data.edges.count}`.slice(-3)), "the map has no description");

  await filters(page, data);
  await table(page, data);
  await card(page, data);
  await search(page, data);
  await poses(page, data);
  await hypotheses(page, data);
  await planes(page, data);
  await zoom(page, data);
  await keyboard(page, data);
  await panels(page, data);
  await address(page, data);
  await themes(page);
  await narrow(page);
  check(requests.every((url) => url.split("#")[0] === place), `the page asked for ${requests.filter((url) => url.split("#")[0] !== place).join(", ")}`);
  await page.context().close();

  await tap(await opened({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 3 }), data);

  // The checks themselves can fail: a page that connects or throws must be seen.
  const planted = await opened({}), count = faults.length;
  await planted.evaluate(() => {
    const image = new Image();
    image.src = "https://example.org/x.png";
    document.body.append(image);
    setTimeout(() => { throw new Error("planted"); }, 0);
  });
  await planted.waitForTimeout(300);
  const seen = faults.splice(count);
  check(seen.some((fault) => fault.includes("Content Security Policy")), "a connection is not refused by the page's policy");
  check(seen.some((fault) => fault.includes("planted")), "an error of a script is not noticed");
} catch (error) {
  faults.push(`the check cannot go on: ${error.message.split("\n")[0]}`);
} finally {
  await browser.close();
}
for (const fault of faults) console.error(`check-view: ${fault}`);
console.log(faults.length ? `${faults.length} faults in ${file}` : `${file}: the page works in Chromium (${measured})`);
process.exitCode = faults.length ? 1 : 0;
