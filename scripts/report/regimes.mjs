// Whether the maps of regimes of a report page have numbers and curves for every choice.
import { check, shot } from "./page.mjs";

export async function regimes(page) {
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
