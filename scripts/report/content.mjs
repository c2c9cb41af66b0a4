// Whether every section of a report page is filled, and the choices of experiment, session and seed change what is shown.
import { check, faults, pixels, settled, shot } from "./page.mjs";

export async function filled(page) {
  const sections = await page.evaluate(() => [...document.querySelectorAll("main > section")].map((section) => {
    const painted = [...section.querySelectorAll("canvas")].every((canvas) => {
      if (canvas.closest("[hidden]")) return true;
      if (!canvas.clientWidth) return false;
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return data.some((value, index) => value !== data[index % 4]);
    });
    const drawings = [...section.querySelectorAll("svg:not(.swatch)")];
    const body = section.innerText.replace(section.querySelector("h2")?.innerText ?? "", "").trim();
    return {
      id: section.id, painted, text: body.length, absent: !!section.querySelector(".absent-section"),
      canvases: section.querySelectorAll("canvas").length, drawings: drawings.length, drawn: drawings.every((drawing) => drawing.querySelector("path, circle, rect")),
      unnamed: [...section.querySelectorAll("canvas, svg:not(.swatch)")].filter((one) => !one.getAttribute("aria-label")).length,
    };
  }));
  const expected = { table: [0, 1], trajectories: [0, 1], graphs: [2, 0], error: [0, 1], consistency: [1, 0], components: [2, 0], maps: [3, 0], regimes: [0, 4], trust: [0, 1], history: [0, 0] };
  for (const [id, [canvases, drawings]] of Object.entries(expected)) {
    const section = sections.find((one) => one.id === id);
    if (!section) {
      faults.push(`there is no section ${id}`);
      continue;
    }
    check(section.text > 40, `section ${id} is empty`);
    if (section.absent) {
      console.log(`section ${id}: says that its data is missing`);
      continue;
    }
    check(section.canvases >= canvases && section.painted, `section ${id}: a map is blank`);
    check(section.drawings >= drawings && section.drawn, `section ${id}: a drawing is missing or empty`);
    check(section.unnamed === 0, `section ${id}: ${section.unnamed} pictures have no description`);
  }
  const unlabelled = await page.evaluate(() => [...document.querySelectorAll("select, input, button")].filter((one) => !one.labels?.length && !one.innerText && !one.getAttribute("aria-label")).map((one) => one.id));
  check(unlabelled.length === 0, `controls without a label: ${unlabelled.join(", ")}`);
  await shot(page, "desktop");
}

export async function choices(page) {
  const options = (id) => page.$$eval(`#${id} option`, (all) => all.map((one) => one.value));
  for (const id of ["experiment", "session", "seed"]) {
    const values = await options(id);
    if (values.length < 2) continue;
    const before = (await page.$("#graph-left-map")) && (await pixels(page, "graph-left-map"));
    await page.selectOption(`#${id}`, values.at(-1));
    await settled(page);
    if (before) check(before !== (await pixels(page, "graph-left-map")), `choosing another ${id} changes no map`);
    check((await page.inputValue(`#${id}`)) === values.at(-1), `the choice of ${id} is not kept`);
  }
  // The RMSE beside a map is that of the data, and one of the dots of the chart of all runs.
  const told = await page.evaluate(() => {
    const data = JSON.parse(document.getElementById("data").textContent), value = (id) => document.getElementById(id)?.value;
    const experiment = data.experiments[Number(value("experiment"))];
    const row = experiment?.spread.find((one) => one.session === value("session") && one.method === value("graph-left"));
    return { text: document.getElementById("graph-left-rmse")?.textContent, rmse: row?.rmse.find(([seed]) => seed === value("seed"))?.[1] };
  });
  if (told.text) {
    const shown = Number(told.text.match(/RMSE ([\d.]+) m/)[1]);
    check(Math.abs(shown - told.rmse) <= (told.rmse < 10 ? 0.0051 : 0.051), `the map says ${told.text} and the result ${told.rmse}`);
  }
}
