// Whether the map of a page of posecut-view changes between both sets of poses, hypotheses and planes, moves and zooms.
import { check, pixels, settled, shot } from "../report/page.mjs";

export async function poses(page, data) {
  const both = data.before && data.maps[0].positions;
  check((await page.isVisible("#poses")) === Boolean(both), "both sets of poses are offered without being there, or the reverse");
  if (!both) return;
  const after = await pixels(page, "base"), caption = await page.textContent("#caption");
  await page.click("#before");
  await settled(page);
  check(after !== (await pixels(page, "base")), "the map before is the map after");
  check((await page.textContent("#caption")) !== caption, "the caption does not say which poses are shown");
  await shot(page, "before", {});
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("b");
  await settled(page);
  check(after === (await pixels(page, "base")), "the key b does not switch the poses back");
  await page.keyboard.press("g");
  await settled(page);
  check(after !== (await pixels(page, "base")) && (await page.isChecked("#ghost")), "the key g draws no ghost");
  await page.keyboard.press("g");
  await settled(page);
}

export async function hypotheses(page, data) {
  check((await page.isVisible("#map-choice")) === data.maps.length > 1, "maps are offered although there is one, or the reverse");
  if (data.maps.length < 2) return;
  const [first, summary, legend] = [await pixels(page, "base"), await page.textContent("#summary"), await page.textContent("#facets")];
  await page.selectOption("#map-choice", "1");
  await settled(page);
  check(first !== (await pixels(page, "base")), "another hypothesis has the same map");
  check(summary !== (await page.textContent("#summary")) && legend !== (await page.textContent("#facets")), "another hypothesis has the same counts");
  await shot(page, "hypothesis", {});
  await page.selectOption("#map-choice", "0");
  await settled(page);
  check(first === (await pixels(page, "base")), "the main map does not come back as it was");
}

export async function planes(page, data) {
  check((await page.isVisible("#plane")) === data.planes.length > 1, "planes are offered in the plane, or not in space");
  const seen = new Set();
  for (let plane = 0; plane < data.planes.length && data.planes.length > 1; plane += 1) {
    await page.selectOption("#plane", String(plane));
    await settled(page);
    seen.add(await pixels(page, "base"));
  }
  check(data.planes.length < 2 || seen.size === data.planes.length, "two planes have the same map");
  if (data.planes.length > 1) await page.selectOption("#plane", String(data.plane));
  await settled(page);
  const { count, sizes } = data.maps[0].parts;
  check((await page.isVisible("#part")) === count > 1, "components are offered although there is one, or the reverse");
  if (count < 2) return;
  check(/components that no edge in use joins/.test(await page.textContent("#caption")), "the page does not say that components are apart");
  const all = await pixels(page, "base");
  await page.selectOption("#part", String(sizes.length - 1));
  await settled(page);
  check(all !== (await pixels(page, "base")), "choosing a component changes nothing");
  await page.selectOption("#part", "-1");
  await settled(page);
}

export async function zoom(page, data) {
  if (!data.maps[0].positions && !data.before) return;
  const start = await pixels(page, "base"), box = await (await page.$("#map")).boundingBox();
  const changed = async (what) => {
    const now = await pixels(page, "base");
    check(now !== start, `${what} does nothing`);
    await page.click("#zoom-all");
    await settled(page);
    check(start === (await pixels(page, "base")), `after ${what}, the whole is not shown again`);
  };
  await page.click("#zoom-in");
  await settled(page);
  await changed("the zoom button");
  await page.mouse.move(box.x + box.width / 3, box.y + box.height / 3);
  await page.mouse.wheel(0, -300);
  await settled(page);
  await changed("the wheel");
  // The pointer is still on the button that shows the whole.
  await page.mouse.move(box.x + box.width / 3, box.y + box.height / 3);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2, { steps: 5 });
  await page.mouse.up();
  await settled(page);
  await changed("dragging");
  await page.mouse.move(5, 5);
  await settled(page);
}
