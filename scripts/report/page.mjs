// What the checks of a report page share: the faults found, waiting, pictures.
import { basename, join } from "node:path";

export const [file, folder] = process.argv.slice(2);
// Each page has a folder of its own: several are checked at once.
export const shots = folder && join(folder, basename(file, ".html"));
export const faults = [];
export const check = (holds, sentence) => {
  if (!holds) faults.push(sentence);
};
// The same message a hundred times is one fault.
export const said = (sentence) => check(faults.includes(sentence), sentence);

/** Two frames: everything that was asked to be drawn is drawn. */
export async function settled(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 30)))));
}

export async function shot(page, name, options = { fullPage: true }) {
  if (shots) await page.screenshot({ path: join(shots, `${name}.png`), ...options });
}

/** The pixels of a canvas, as text to compare. */
export function pixels(page, id) {
  return page.evaluate((id) => document.getElementById(id).toDataURL(), id);
}
