// Whether a page of posecut-view tells what happened to an edge: from the table, by its id, and by pointing at it.
import { check, pixels, settled, shot } from "../report/page.mjs";

const words = (column, edge) => column?.words?.words;

/** Checks the details of an edge that is selected, and its witnesses. */
async function told(page, data) {
  const shown = await page.innerText("#card"), name = await page.textContent("#card h2"), row = page.locator("tr[aria-selected=true]");
  check((await row.count()) === 1, `${name}: its row is not marked`);
  const state = (await row.locator("td").nth(1).textContent()).trim();
  check(shown.toLowerCase().includes(state.toLowerCase()), `${name}: its details do not say ${state}`);
  const reasons = words(data.maps[0].columns.find((one) => one.name === "verify_reason"));
  if (reasons) check(reasons.some((reason) => shown.includes(reason)) || !/verify/.test(state), `${name}: its details give no reason`);
  if (data.maps[0].residuals) check(/residual|measures nothing|nothing: it says/.test(shown), `${name}: its details give no residual`);
}

export async function card(page, data) {
  if (!data.edges.count) return;
  const before = await pixels(page, "map");
  for (const row of [0, 1, 2, 3].filter((row) => row < data.edges.count)) {
    await page.click(`tr[data-row="${row}"]`);
    await settled(page);
    await told(page, data);
  }
  if (data.maps[0].positions) check(before !== (await pixels(page, "map")), "a selected edge is not drawn on the map");
  await shot(page, "edge", {});
  // The first edge with witnesses: each leads on.
  const links = page.locator("[data-witness]");
  for (let row = 0; row < 8 && row < data.edges.count && !(await links.count()); row += 1) {
    await page.click(`tr[data-row="${row}"]`);
    await settled(page);
  }
  if (await links.count()) {
    const id = await links.first().getAttribute("data-witness");
    await links.first().click();
    await settled(page);
    check((await page.textContent("#card h2")) === `Edge ${id}`, `the witness ${id} leads to another edge`);
  } else check(!data.maps[0].witnesses || data.edges.count > 8, "no edge names its witnesses");
  await page.keyboard.press("Escape");
  await settled(page);
  check(!(await page.$("#card h2")), "Escape does not deselect");
}

/** The middle of the map, where an edge is that the page flew to. */
export async function middle(page) {
  const box = await (await page.$("#map")).boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

export async function search(page, data) {
  if (!data.edges.count) return;
  await page.fill("#wanted", "999999999999");
  await page.click("#search button");
  check((await page.textContent("#found")).includes("no landmark edge"), "an id that no edge has is not reported");
  const ids = await page.$$eval("tr[data-row] td:first-child", (found) => found.map((one) => one.textContent));
  await page.fill("#wanted", ids.at(-1));
  await page.keyboard.press("Enter");
  await settled(page);
  check((await page.textContent("#card h2")) === `Edge ${ids.at(-1)}`, "an edge is not found by its id");
  check((await page.textContent("#found")) === "", "a message stays after an edge was found");
  if (!data.maps[0].positions && !data.before) return;
  // An edge without witnesses is in the middle of the map, so pointing there points at it.
  for (const id of ids) {
    await page.fill("#wanted", id);
    await page.keyboard.press("Enter");
    await settled(page);
    if (await page.$("[data-witness]")) continue;
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("Escape");
    await page.mouse.move(...(await middle(page)));
    await settled(page);
    check((await page.textContent("#tip")).includes("edge ") && (await page.textContent("#card h2")).startsWith("Edge "), `pointing at edge ${id} shows nothing`);
    await page.mouse.click(...(await middle(page)));
    await settled(page);
    check(/edge=\d+/.test(page.url()), "a click on an edge does not select it");
    break;
  }
  await page.mouse.move(5, 5);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("Escape");
  await page.click("#zoom-all");
  await settled(page);
}
