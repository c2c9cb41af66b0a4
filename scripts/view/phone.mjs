// Whether a page of posecut-view works on a phone: it fits, and edges can be tapped.
import { check, pixels, settled, shot } from "../report/page.mjs";
import { middle } from "./card.mjs";

export async function tap(page, data) {
  const [needed, there] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(needed <= there, `a phone must scroll sideways: ${needed} pixels on ${there}`);
  if (data.edges.count && (data.maps[0].positions || data.before)) {
    // The page flies to an edge without witnesses; a tap on the middle of the map then finds it, or one beside it.
    const rows = await page.$$("tr[data-row]");
    for (const row of rows.slice(0, 30)) {
      await row.evaluate((one) => one.click());
      await settled(page);
      if (!(await page.$("[data-witness]"))) break;
    }
    await page.evaluate(() => { document.querySelector("#card .actions .quiet").click(); scrollTo(0, 0); });
    await settled(page);
    if (!(await page.$("#card h2"))) {
      await page.touchscreen.tap(...(await middle(page)));
      await settled(page);
      check((await page.$("#card h2")) !== null || data.maps[0].witnesses, "a tap on an edge shows nothing");
    }
  }
  await shot(page, "tapped", {});
  const before = await pixels(page, "base");
  await page.tap("#zoom-in");
  await settled(page);
  check(before !== (await pixels(page, "base")), "the zoom button does nothing on a phone");
  await page.context().close();
}
