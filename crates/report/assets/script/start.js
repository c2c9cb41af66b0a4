// The page begins.

applyTheme();
for (const [name, value] of [["experiment", Number], ["session", String], ["seed", String]]) {
  byId(name).addEventListener("change", (event) => choose({ [name]: value(event.target.value) }));
}
byId("choice").addEventListener("submit", (event) => event.preventDefault());
byId("theme").addEventListener("click", () => {
  wanted = { automatic: "light", light: "dark", dark: "automatic" }[wanted];
  byId("theme").textContent = `Colours: ${wanted}`;
  applyTheme();
  redraw();
});
prefersDark.addEventListener("change", () => {
  applyTheme();
  redraw();
});

// On paper: light colours, and nothing folded away.
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open])")];
  for (const details of folded) details.open = true;
  applyTheme("light");
  redraw();
  // The next frame would come too late.
  for (const map of allMaps) map.paint();
});
addEventListener("afterprint", () => {
  for (const details of folded) details.open = false;
  applyTheme();
  redraw();
});

let width = 0;
new ResizeObserver(() => {
  if (byId("content").clientWidth === width) return;
  width = byId("content").clientWidth;
  redraw();
}).observe(byId("content"));

settle();
