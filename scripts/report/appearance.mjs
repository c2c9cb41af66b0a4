// Whether a report page follows the colour scheme, fits a phone, and prints.
import { join } from "node:path";
import { check, settled, shot, shots } from "./page.mjs";

export async function themes(page) {
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

export async function narrow(page) {
  await page.setViewportSize({ width: 390, height: 844 });
  await settled(page);
  const [needed, there] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(needed <= there, `a phone must scroll sideways: ${needed} pixels on ${there}`);
  await shot(page, "phone");
  await page.setViewportSize({ width: 1280, height: 900 });
  await settled(page);
}

export async function print(page) {
  await page.emulateMedia({ colorScheme: "dark" });
  await settled(page);
  const pdf = await page.pdf({ format: "A4", printBackground: true, ...(shots ? { path: join(shots, "print.pdf") } : {}) });
  check(pdf.length > 20000, "the printed page is empty");
  await page.emulateMedia({ colorScheme: "light" });
  await settled(page);
}
