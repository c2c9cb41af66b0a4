// Opens a page of posecut-report in headless Chromium, as a reader would, and holds it to what it promises: no error
// on the console, no request but for the page itself, every section filled, layers, zoom, choices, themes and print work.
// Usage: node scripts/check-report.mjs PAGE.html [DIRECTORY_FOR_SCREENSHOTS]
// Needs playwright-core in NODE_PATH's place (scripts/check-report.sh installs it) and Chromium.
import { createRequire } from "node:module";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { chromium } = createRequire(join(resolve(process.env.PLAYWRIGHT ?? "."), "x.js"))("playwright-core");
const [file, shots] = process.argv.slice(2);
const address = pathToFileURL(resolve(file)).href;
const profile = mkdtempSync(join(tmpdir(), "posecut-browser-"));
const faults = [];
const check = (holds, sentence) => {
  if (!holds) faults.push(sentence);
};
// The same message a hundred times is one fault.
const said = (sentence) => check(faults.includes(sentence), sentence);

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

/** Two frames: everything that was asked to be drawn is drawn. */
async function settled(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 30)))));
}

async function shot(page, name, options = { fullPage: true }) {
  if (shots) await page.screenshot({ path: join(shots, `${name}.png`), ...options });
}

/** The pixels of a canvas, as text to compare. */
function pixels(page, id) {
  return page.evaluate((id) => document.getElementById(id).toDataURL(), id);
}

async function filled(page) {
  const sections = await page.evaluate(() => [...document.querySelectorAll("main > section")].map((section) => {
    const painted = [...section.querySelectorAll("canvas")].every((canvas) => {
      if (!canvas.clientWidth) return false;
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return data.some((value, index) => value !== data[index % 4]);
    });
    const drawings = [...section.querySelectorAll("svg:not(.swatch)")];
    const body = section.innerText.replace(section.querySelector("h2")?.innerText ?? "", "").trim();
    return {
      id: section.id, painted, text: body.length, absent: !!section.querySelector(".absent-section"),
      canvases: section.querySelectorAll("canvas").length, drawings: drawings.length, drawn: drawings.every((drawing) => drawing.querySelector("path, circle, rect")),
      unnamed: [...section.querySelectorAll("canvas, svg:not(.swatch)")].filter((one) => !one.getAttribute("aria-label")).length,
    };
  }));
  const expected = { table: [0, 1], trajectories: [0, 1], graphs: [2, 0], error: [0, 1], consistency: [1, 0], components: [2, 0], regimes: [0, 4], trust: [0, 1], history: [0, 0] };
  for (const [id, [canvases, drawings]] of Object.entries(expected)) {
    const section = sections.find((one) => one.id === id);
    if (!section) {
      faults.push(`there is no section ${id}`);
      continue;
    }
    check(section.text > 40, `section ${id} is empty`);
    if (section.absent) {
      console.log(`section ${id}: says that its data is missing`);
      continue;
    }
    check(section.canvases >= canvases && section.painted, `section ${id}: a map is blank`);
    check(section.drawings >= drawings && section.drawn, `section ${id}: a drawing is missing or empty`);
    check(section.unnamed === 0, `section ${id}: ${section.unnamed} pictures have no description`);
  }
  const unlabelled = await page.evaluate(() => [...document.querySelectorAll("select, input, button")].filter((one) => !one.labels?.length && !one.innerText && !one.getAttribute("aria-label")).map((one) => one.id));
  check(unlabelled.length === 0, `controls without a label: ${unlabelled.join(", ")}`);
  await shot(page, "desktop");
}

async function choices(page) {
  const options = (id) => page.$$eval(`#${id} option`, (all) => all.map((one) => one.value));
  for (const id of ["experiment", "session", "seed"]) {
    const values = await options(id);
    if (values.length < 2) continue;
    const before = (await page.$("#graph-left-map")) && (await pixels(page, "graph-left-map"));
    await page.selectOption(`#${id}`, values.at(-1));
    await settled(page);
    if (before) check(before !== (await pixels(page, "graph-left-map")), `choosing another ${id} changes no map`);
    check((await page.inputValue(`#${id}`)) === values.at(-1), `the choice of ${id} is not kept`);
  }
  // The RMSE beside a map is that of the data, and one of the dots of the chart of all runs.
  const told = await page.evaluate(() => {
    const data = JSON.parse(document.getElementById("data").textContent), value = (id) => document.getElementById(id)?.value;
    const experiment = data.experiments[Number(value("experiment"))];
    const row = experiment?.spread.find((one) => one.session === value("session") && one.method === value("graph-left"));
    return { text: document.getElementById("graph-left-rmse")?.textContent, rmse: row?.rmse.find(([seed]) => seed === value("seed"))?.[1] };
  });
  if (told.text) {
    const shown = Number(told.text.match(/RMSE ([\d.]+) m/)[1]);
    check(Math.abs(shown - told.rmse) <= (told.rmse < 10 ? 0.0051 : 0.051), `the map says ${told.text} and the result ${told.rmse}`);
  }
}

async function layersAndZoom(page) {
  if (!(await page.$("#graph-left-map"))) return;
  // "before" without any rejection, so that all kinds of edges are there on one side or the other.
  const both = async () => (await pixels(page, "graph-left-map")) + (await pixels(page, "graph-right-map"));
  for (const layer of ["reference", "odometry", "t+", "t-", "f-", "f+"]) {
    const count = await page.evaluate((layer) => {
      const texts = { "t+": "correct, kept", "t-": "correct, rejected", "f-": "incorrect, rejected", "f+": "incorrect, kept" };
      if (!texts[layer]) return 1;
      return ["left", "right"].reduce((sum, side) => sum + Number(document.getElementById(`graph-${side}-counts`).textContent.match(`(?:^|[^n])${texts[layer]}: (\\d+)`)?.[1] ?? 0), 0);
    }, layer);
    const before = await both();
    await page.uncheck(`[id="layer-${layer}"]`);
    await settled(page);
    const without = await both();
    await page.check(`[id="layer-${layer}"]`);
    await settled(page);
    if (count > 0) check(before !== without, `layer ${layer} cannot be switched off`);
    check(before === (await both()), `layer ${layer} does not come back as it was`);
  }
  const start = await both();
  await page.click("#graph-buttons button:first-child");
  await settled(page);
  const zoomed = await both();
  if (shots) await (await page.$("#graphs")).screenshot({ path: join(shots, "zoomed.png") });
  check(zoomed !== start, "the zoom button does nothing");
  const box = await (await page.$("#graph-left-map")).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 3, box.y + box.height / 3, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  const moved = await both();
  check(moved !== zoomed, "dragging moves nothing");
  const top = await page.evaluate(() => scrollY);
  await page.focus("#graph-left-map");
  await page.mouse.wheel(0, -300);
  await settled(page);
  check(moved !== (await both()), "the wheel does not zoom a map that has the focus");
  check(top === (await page.evaluate(() => scrollY)), "the page scrolls while a map zooms");
  await page.click("#graph-buttons button:last-child");
  await settled(page);
  check(start === (await both()), "the whole is not shown again");
}

async function keyboard(page) {
  if (await page.$("#graph-left-map")) {
    await page.focus("#graph-left-map");
    for (const key of ["+", "ArrowLeft", "0"]) {
      const before = await pixels(page, "graph-left-map");
      await page.keyboard.press(key);
      await settled(page);
      check(before !== (await pixels(page, "graph-left-map")), `the key ${key} does nothing on a map`);
    }
  }
  if (await page.$("#consistency-map:not([hidden])")) {
    await page.focus("#consistency-map");
    await page.keyboard.press("ArrowRight");
    const text = await page.textContent("#consistency-readout");
    check(/^edge \d+ /.test(text), "the arrow keys read nothing from the matrix");
    for (const order of ["session", "truth", "clique"]) {
      const before = await pixels(page, "consistency-map");
      await page.selectOption("#consistency-order", order);
      await settled(page);
      if (order !== "clique") check(before !== "" && !!(await pixels(page, "consistency-map")), "the matrix cannot be put in another order");
    }
  }
  // From the top of the page Tab reaches every control in turn.
  await page.evaluate(() => { document.activeElement.blur(); scrollTo(0, 0); });
  const reached = new Set();
  for (let press = 0; press < 60; press += 1) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.tagName));
  }
  for (const id of ["theme", "experiment", "session", "seed"]) check(reached.has(id), `the Tab key does not reach ${id}`);
}

async function regimes(page) {
  if (!(await page.$("#regimes-maps svg"))) return;
  const before = await page.innerHTML("#regimes-over-rate");
  await page.click("#regimes-maps > div:first-child .cell:last-of-type");
  check(before !== (await page.innerHTML("#regimes-over-rate")), "pressing a cell changes no curve");
  for (const quantity of ["precision", "recall", "mean"]) {
    await page.selectOption("#regimes-quantity", quantity);
    check((await page.$$("#regimes-maps .cell")).length > 0, `there is no map of ${quantity}`);
  }
  // Every kind of false edges on every session: numbers in cells, and points in both charts, or the words that there are none.
  const values = (id) => page.$$eval(`#${id} option`, (all) => all.map((one) => one.value));
  const [session, kind] = [await page.inputValue("#regimes-session"), await page.inputValue("#regimes-kind")];
  check(kind === "uniform" || !(await values("regimes-kind")).includes("uniform"), "the map does not begin with uniform false edges");
  for (const one of await values("regimes-session")) {
    await page.selectOption("#regimes-session", one);
    for (const other of await values("regimes-kind")) {
      await page.selectOption("#regimes-kind", other);
      const { numbers, points, words } = await page.evaluate(() => ({
        numbers: [...document.querySelectorAll("#regimes-maps .cell text")].filter((text) => text.textContent !== "–").length,
        points: ["rate", "scale"].map((name) => document.querySelectorAll(`#regimes-over-${name} circle`).length),
        words: document.getElementById("regimes-maps").textContent,
      }));
      const none = /no results/.test(words);
      check(none ? numbers === 0 : numbers > 0 && points.every((count) => count > 0), `${other} false edges on ${one}: an empty map or chart`);
    }
    if (one === session) await shot(page, "kind", {});
  }
  await page.selectOption("#regimes-session", session);
  await page.selectOption("#regimes-kind", kind);
}

async function themes(page) {
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await ground();
  await page.emulateMedia({ colorScheme: "dark" });
  await settled(page);
  check(light !== (await ground()), "the page does not follow a dark scheme");
  await shot(page, "dark");
  await page.click("#theme");
  await settled(page);
  check(light === (await ground()), "the button does not force the light scheme");
  await page.click("#theme");
  await page.click("#theme");
  await page.emulateMedia({ colorScheme: "light" });
  await settled(page);
}

async function narrow(page) {
  await page.setViewportSize({ width: 390, height: 844 });
  await settled(page);
  const [needed, there] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(needed <= there, `a phone must scroll sideways: ${needed} pixels on ${there}`);
  await shot(page, "phone");
  await page.setViewportSize({ width: 1280, height: 900 });
  await settled(page);
}

async function print(page) {
  await page.emulateMedia({ colorScheme: "dark" });
  await settled(page);
  const pdf = await page.pdf({ format: "A4", printBackground: true, ...(shots ? { path: join(shots, "print.pdf") } : {}) });
  check(pdf.length > 20000, "the printed page is empty");
  await page.emulateMedia({ colorScheme: "light" });
  await settled(page);
}
