// How long a page of posecut-view takes until it is drawn, and for each frame while a reader zooms. Times are printed, not checked.
import { settled } from "../report/page.mjs";

/** The median time of a frame, milliseconds; null where there is no map. */
export async function speed(page, data) {
  if (!data.maps[0].positions && !data.before) return null;
  const times = await page.evaluate(async () => {
    const map = document.getElementById("map"), box = map.getBoundingClientRect(), found = [];
    let last = performance.now();
    for (let step = 0; step < 20; step += 1) {
      map.dispatchEvent(new WheelEvent("wheel", { deltaY: step % 2 ? 100 : -100, clientX: box.left + 300, clientY: box.top + 200, cancelable: true }));
      await new Promise((done) => requestAnimationFrame(done));
      const now = performance.now();
      found.push(now - last);
      last = now;
    }
    return found;
  });
  await page.click("#zoom-all");
  await settled(page);
  return Math.round(times.sort((one, other) => one - other)[10]);
}
