// The page begins.

function recolour() {
  palette.clear();
  drawFacets();
  drawPaths();
  drawCard();
  fillRows(true);
  repaint();
}

byId("theme").addEventListener("click", () => {
  wanted = { automatic: "light", light: "dark", dark: "automatic" }[wanted];
  byId("theme").textContent = `Colours: ${wanted}`;
  applyTheme();
  recolour();
});
prefersDark.addEventListener("change", () => {
  applyTheme();
  recolour();
});

addEventListener("hashchange", restore);
restore();

/** The size of the map; the first time, and after a change of plane, it shows everything. */
new ResizeObserver(() => {
  const box = byId("canvases").getBoundingClientRect();
  if (!box.width || !box.height) return;
  Object.assign(camera, { width: box.width, height: box.height });
  frameOnce();
  repaint();
}).observe(byId("canvases"));

new ResizeObserver(() => fillRows(true)).observe(byId("body"));

function frameOnce() {
  if (camera.framed || camera.width < 2) return;
  camera.framed = true;
  showAll(false);
  if (state.selected >= 0) showEdge(state.selected);
}
when(["plane"], frameOnce);
