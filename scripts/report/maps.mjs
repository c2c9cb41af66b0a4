// Whether layers, zoom and keys of the maps of a report page work.
import { join } from "node:path";
import { check, pixels, settled, shots } from "./page.mjs";

export async function layersAndZoom(page) {
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

export async function keyboard(page) {
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
