// Whether the maps of laser logs of a report page show every log, its picture and its candidates.
import { check, pixels, settled } from "./page.mjs";

export async function logs(page) {
  if (!(await page.$("#maps-log"))) return;
  const sides = ["before", "all", "after"];
  const values = await page.$$eval("#maps-log option", (all) => all.map((one) => one.value));
  let before = "";
  for (const value of values) {
    await page.selectOption("#maps-log", value);
    // The pictures are decoded in the background.
    await page.waitForTimeout(300);
    await settled(page);
    const { shown, counts, row } = await page.evaluate((sides) => {
      const log = JSON.parse(document.getElementById("data").textContent).maps[Number(document.getElementById("maps-log").value)];
      return {
        shown: sides.filter((side) => !document.getElementById(`maps-${side}`).hidden),
        counts: log.candidates.counts,
        row: [...document.querySelectorAll("#maps tbody tr")].find((one) => one.querySelector("th").textContent === log.name)?.innerText.split("\t"),
      };
    }, sides);
    check(shown.includes("before") && shown.includes("after"), `log ${value}: a map is missing`);
    check(row?.[1] === String(counts.candidates) && row?.[3] === String(counts.rejected), `log ${value}: the table has other counts than the data`);
    const now = await pixels(page, "maps-after-map");
    check(now !== before, `choosing log ${value} changes no map`);
    before = now;
  }
  // Without trajectory and candidates only the picture remains: it must be there, and each layer must have made a difference.
  for (const box of await page.$$("#maps-layers input")) {
    const lit = await pixels(page, "maps-before-map");
    const text = await box.evaluate((one) => one.labels[0].innerText);
    await box.uncheck();
    await settled(page);
    if (!text.endsWith(": 0")) check(lit !== (await pixels(page, "maps-before-map")), `the layer ${text} of laser maps cannot be switched off`);
  }
  const inked = await page.evaluate(() => {
    const canvas = document.getElementById("maps-after-map"), { width, height } = canvas;
    // A copy, because Chromium warns of reading the canvas itself again and again.
    const copy = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(width / 8, height / 8, (3 * width) / 4, (3 * height) / 4);
    return data.some((value, index) => index % 4 === 3 && value > 0);
  });
  check(inked, "the occupancy grid of a laser map is not drawn");
  for (const box of await page.$$("#maps-layers input")) await box.check();
  await settled(page);
  check(before === (await pixels(page, "maps-after-map")), "the layers of laser maps do not come back as they were");
  await page.click("#maps-buttons button:first-child");
  await settled(page);
  check(before !== (await pixels(page, "maps-after-map")), "laser maps cannot be zoomed");
  await page.click("#maps-buttons button:last-child");
  await page.selectOption("#maps-log", values[0]);
  await settled(page);
}
