// Keys: for the map when it has the focus, and for the whole page.

const help = [
  ["b", "switch between both sets of poses"], ["g", "draw the other set as a ghost"], ["n, p", "next, previous edge of the table"],
  ["Escape", "deselect"], ["/", "find an edge by its id"], ["?", "these keys"],
  ["arrows", "move the map, when it has the focus"], ["+, −, 0", "zoom in, out, show everything"],
  ["up, down, Enter", "in the table: other rows, and zoom to the edge"],
];

byId("keys").append(element("h2", {}, "Keys"),
  element("dl", {}, ...help.flatMap(([key, text]) => [element("dt", {}, key), element("dd", {}, text)])),
  element("p", {}, "Drag the map to move it, turn the wheel or pinch to zoom, point at an edge or tap it to read about it. Of a group of filters, none chosen means all."),
  element("div", { class: "actions" }, element("button", { type: "button", onclick: () => byId("keys").close() }, "Close")));

function showHelp() {
  byId("keys").showModal();
  byId("help").setAttribute("aria-expanded", "true");
}
byId("help").addEventListener("click", showHelp);
byId("keys").addEventListener("close", () => byId("help").setAttribute("aria-expanded", "false"));

over.addEventListener("keydown", (event) => {
  const step = 60, actions = {
    "+": () => camera.zoomAt(1.5), "=": () => camera.zoomAt(1.5), "-": () => camera.zoomAt(1 / 1.5), 0: () => showAll(),
    ArrowLeft: () => camera.pan(step, 0), ArrowRight: () => camera.pan(-step, 0), ArrowUp: () => camera.pan(0, step), ArrowDown: () => camera.pan(0, -step),
  };
  if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  actions[event.key]();
});

/** The next edge of the table, in the order of the table. */
function walk(step) {
  if (!table.order.length) return;
  const at = table.order.indexOf(state.selected), next = at < 0 ? (step > 0 ? 0 : table.order.length - 1) : at + step;
  select(table.order[(next + table.order.length) % table.order.length]);
}

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("keys").open) return;
  if (event.target.matches?.("input:not([type=checkbox]), select")) return;
  const actions = {
    b: () => { if (!byId("poses").hidden) change({ after: !state.after }); }, g: () => change({ ghost: !state.ghost }),
    n: () => walk(1), p: () => walk(-1), "?": showHelp,
    "/": () => byId("wanted").focus(), Escape: () => select(-1),
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
});
