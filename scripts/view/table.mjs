// Whether the table of a page of posecut-view sorts, scrolls and leads to the map, and the other tables are filled.
import { check, settled, shot } from "../report/page.mjs";

/** The texts of a column in the rows of the page. */
function cells(page, name) {
  return page.evaluate((name) => {
    const column = [...document.querySelectorAll("table.grid th button")].findIndex((one) => one.dataset.column === name);
    return [...document.querySelectorAll("tr[data-row]")].map((row) => row.children[column].textContent);
  }, name);
}

export async function table(page, data) {
  if (!data.edges.count) return;
  check((await page.$$("tr[data-row]")).length <= 120, "the page has more rows than can be in sight");
  const names = await page.$$eval("table.grid th button", (found) => found.map((one) => one.dataset.column));
  for (const name of names) {
    const head = page.locator("table.grid th").filter({ has: page.locator(`[data-column="${name}"]`) }), button = head.locator("button");
    for (const direction of ["ascending", "descending"]) {
      await button.click();
      await settled(page);
      check((await head.getAttribute("aria-sort")) === direction, `${name} does not sort ${direction}`);
      const texts = (await cells(page, name)).filter((text) => text !== "");
      const values = texts.map((text) => (text.trim() !== "" && !Number.isNaN(Number(text)) ? Number(text) : null));
      const sign = direction === "ascending" ? 1 : -1;
      if (values.length && !values.includes(null)) check(values.every((value, index) => !index || sign * (value - values[index - 1]) >= 0), `${name}: rows are not ${direction}`);
    }
    await button.click();
    await settled(page);
    check((await head.getAttribute("aria-sort")) === null, `${name} stays sorted`);
  }
  await page.$eval("#body", (body) => body.scrollTo(0, body.scrollHeight));
  await settled(page);
  const last = await page.$$eval("tr[data-row]", (rows) => Number(rows.at(-1).dataset.row));
  check(last === data.edges.count - 1, `the last row is ${last} of ${data.edges.count - 1}`);
  await page.$eval("#body", (body) => body.scrollTo(0, 0));
  await settled(page);
}

export async function panels(page, data) {
  const expected = {
    findings: [...data.doubts.map((one) => one.doubt), ...data.remarks.flatMap((one) => [one.title, one.text, one.remedy])],
    calibration: data.verification?.calibration ? data.verification.calibration.chains.slice(0, 3).map((chain) => chain.name) : ["--verify-stats"],
    history: data.stages.flatMap((stage) => [stage.name, stage.arguments]),
  };
  for (const [name, texts] of Object.entries(expected)) {
    await page.click(`#tab-${name}`);
    await settled(page);
    const shown = await page.textContent("#body");
    for (const text of texts) check(shown.includes(text), `the tab ${name} lacks ${JSON.stringify(text)}`);
    check(shown.length > 20, `the tab ${name} is empty`);
    await shot(page, name, {});
  }
  await page.click("#tab-edges");
  await settled(page);
}

/** The address leads back to what was shown. */
export async function address(page, data) {
  if (!data.edges.count) return;
  await page.click("tr[data-row='0']");
  await page.locator("[data-facet=state]").first().click();
  await settled(page);
  const [link, name] = [page.url(), await page.textContent("#card h2")];
  check(/#.*edge=\d+/.test(link), `the address does not name the edge: ${link}`);
  await page.goto("about:blank");
  await page.goto(link);
  await settled(page);
  check((await page.textContent("#card h2")) === name, "the address does not lead to the edge");
  check((await page.locator("[data-facet=state]").first().getAttribute("aria-pressed")) === "true", "the address does not keep the filters");
  await page.click("#clear");
  await page.keyboard.press("Escape");
  await settled(page);
}
