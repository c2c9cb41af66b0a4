// Whether the legend and the other filters of a page of posecut-view act on the map and on the table alike, with their counts.
import { check, pixels, settled } from "../report/page.mjs";

const digits = (text) => Number(text.replace(/[^\d]/g, ""));

/** How many edges are shown: by the heading, and by the rows that the table would have. */
export async function shownCounts(page) {
  return page.evaluate(() => {
    const rows = document.querySelector("table.grid")?.getAttribute("aria-rowcount");
    const shown = document.getElementById("shown").textContent.split(" of ")[0].replace(/[^\d]/g, "");
    return [Number(shown || 0), Number(rows) - 1];
  });
}

async function agree(page, expected, what) {
  const [heading, rows] = await shownCounts(page);
  check(heading === expected && rows === expected, `${what}: ${expected} edges expected, the heading says ${heading}, the table has ${rows}`);
}

export async function filters(page, data) {
  if (!data.edges.count) {
    check((await page.textContent("#shown")) === "none in this graph", "the page does not say that there are no edges");
    return;
  }
  await agree(page, data.edges.count, "without filters");
  const all = await pixels(page, "base");
  const buttons = await page.$$eval("[data-facet]", (found) => found.map((one) => [one.dataset.facet, one.dataset.key, one.querySelector("b").textContent]));
  const states = buttons.filter(([facet]) => facet === "state");
  check(states.length === data.maps[0].states.length, "the legend does not have all states");
  check(states.reduce((sum, [, , count]) => sum + digits(count), 0) === data.edges.count, "the counts of the legend do not add up");
  for (const [facet, key, count] of buttons) {
    const button = page.locator(`[data-facet="${facet}"]`).and(page.locator(`[data-key=${JSON.stringify(key)}]`));
    await button.click();
    await settled(page);
    check((await button.getAttribute("aria-pressed")) === "true", `${facet} ${key} cannot be chosen`);
    await agree(page, digits(count), `${facet} ${key}`);
    if (facet === "state" && digits(count) < data.edges.count && data.maps[0].positions) check(all !== (await pixels(page, "base")), `${facet} ${key} changes nothing on the map`);
    await button.click();
    await settled(page);
    await agree(page, data.edges.count, `${facet} ${key} taken back`);
  }
  await probability(page, data, all);
}

async function probability(page, data, all) {
  const column = data.maps[0].columns.find((one) => one.name === "verify_probability");
  check((await page.isVisible("#probability")) === Boolean(column), "the filter by probability is there without probabilities, or the reverse");
  if (!column) return;
  await page.$eval("#high", (input) => {
    input.value = 0.5;
    input.dispatchEvent(new Event("input"));
  });
  await settled(page);
  await agree(page, column.numbers.filter((value) => value !== null && value <= 0.5).length, "probability up to 0.5");
  await page.click("#clear");
  await settled(page);
  await agree(page, data.edges.count, "Show all");
  check(all === (await pixels(page, "base")), "the map does not come back as it was");
  if (await page.isVisible("#rejected")) {
    await page.selectOption("#rejected", "none");
    await settled(page);
    check(all !== (await pixels(page, "base")), "rejected edges cannot be hidden");
    await page.selectOption("#rejected", "automatic");
    await settled(page);
  }
}
