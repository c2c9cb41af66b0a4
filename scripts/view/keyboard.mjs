// Whether a page of posecut-view works without a pointer.
import { check, pixels, settled } from "../report/page.mjs";

async function mapKeys(page) {
  await page.focus("#map");
  const start = await pixels(page, "base");
  for (const key of ["+", "-", "ArrowLeft", "ArrowUp"]) {
    await page.keyboard.press(key);
    await settled(page);
    check(start !== (await pixels(page, "base")), `the key ${key} does nothing on the map`);
    await page.keyboard.press("0");
    await settled(page);
    check(start === (await pixels(page, "base")), `after the key ${key}, the key 0 does not show the whole`);
  }
}

async function tableKeys(page, data) {
  // Only rows in sight are in the page.
  await page.$eval("#body", (body) => body.scrollTo(0, 0));
  await settled(page);
  await page.focus("tr[data-row='0']");
  await page.keyboard.press("ArrowDown");
  const focused = () => page.evaluate(() => document.activeElement.dataset.row);
  if (data.edges.count > 1) check((await focused()) === "1", "the arrow keys do not move in the table");
  await page.keyboard.press("End");
  check((await focused()) === String(data.edges.count - 1), "the key End does not lead to the last row");
  await page.keyboard.press("Enter");
  await settled(page);
  check((await page.$("#card h2")) !== null, "the key Enter does not select a row");
  check((await focused()) === String(data.edges.count - 1), "a selected row loses the focus");
  await page.keyboard.press("n");
  await settled(page);
  check((await page.textContent("tr[aria-selected=true] td")) !== "" && (await page.$eval("tr[aria-selected=true]", (row) => row.dataset.row)) === "0", "the key n does not lead around to the first row");
  await page.keyboard.press("Escape");
  await page.keyboard.press("/");
  check((await page.evaluate(() => document.activeElement.id)) === "wanted", "the key / does not lead to the search");
  await page.evaluate(() => document.activeElement.blur());
}

export async function keyboard(page, data) {
  if (data.maps[0].positions || data.before) await mapKeys(page);
  if (data.edges.count) await tableKeys(page, data);
  await page.keyboard.press("?");
  check(await page.isVisible("#keys"), "the key ? does not show the keys");
  await page.keyboard.press("Escape");
  check(!(await page.isVisible("#keys")), "Escape does not close the list of keys");
  // From the top of the page, Tab reaches every control in turn.
  await page.evaluate(() => { document.activeElement.blur(); scrollTo(0, 0); });
  const reached = new Set();
  for (let press = 0; press < 90; press += 1) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.dataset.row || document.activeElement.tagName));
  }
  const wanted = ["theme", "help", "map", "zoom-in", "splitter", "tab-edges", ...(data.edges.count ? ["wanted", "0"] : [])];
  for (const id of wanted) check(reached.has(id), `the Tab key does not reach ${id}`);
  const unlabelled = await page.evaluate(() => [...document.querySelectorAll("select, input, button")].filter((one) => !one.labels?.length && !one.textContent.trim() && !one.getAttribute("aria-label")).map((one) => one.id));
  check(unlabelled.length === 0, `controls without a label: ${unlabelled.join(", ")}`);
}
