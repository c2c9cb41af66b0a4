// The controls above the map, the summary, and what the map needs said about it.

byId("controls").addEventListener("submit", (event) => event.preventDefault());

when(["map", "after"], () => {
  const both = Boolean(before) && mapShown().hasPoses, shown = showsBefore();
  byId("poses").hidden = byId("ghost-label").hidden = !both;
  if (!both) return;
  byId("before").textContent = data.before.reckoned ? "Dead reckoning" : "Before";
  byId("after").textContent = mapShown().optimised ? "Optimised" : data.before.reckoned ? "Poses of the graph" : "After";
  byId("before").setAttribute("aria-pressed", String(shown));
  byId("after").setAttribute("aria-pressed", String(!shown));
});
byId("before").addEventListener("click", () => change({ after: false }));
byId("after").addEventListener("click", () => change({ after: true }));

when(["ghost"], () => { byId("ghost").checked = state.ghost; });
byId("ghost").addEventListener("change", (event) => change({ ghost: event.target.checked }));

byId("controls").hidden = !before && data.maps.length < 2 && data.planes.length < 2 && mapShown().parts.count < 2;
byId("map-label").hidden = data.maps.length < 2;
when(["map"], () => offer(byId("map-choice"), data.maps.map((map, index) => [index, map.name]), state.map));
byId("map-choice").addEventListener("change", (event) => change({ map: Number(event.target.value), part: -1 }));

byId("plane-label").hidden = data.planes.length < 2;
when(["plane"], () => offer(byId("plane"), data.planes.map((plane, index) => [index, plane.name]), state.plane));
byId("plane").addEventListener("change", (event) => change({ plane: Number(event.target.value) }));

when(["map", "part"], () => {
  const { count, sizes } = mapShown().parts;
  byId("part-label").hidden = count < 2;
  const name = (size, index) => (count > sizes.length && index === sizes.length - 1 ? `all smaller ones: ${counted(size, "node")}` : `${index + 1}: ${counted(size, "node")}`);
  offer(byId("part"), [[-1, `all ${number(count)}`], ...sizes.map((size, index) => [index, name(size, index)])], state.part);
});
byId("part").addEventListener("change", (event) => change({ part: Number(event.target.value) }));

for (const [name, act] of [["zoom-in", () => camera.zoomAt(1.6)], ["zoom-out", () => camera.zoomAt(1 / 1.6)], ["zoom-all", () => showAll()]]) {
  byId(name).addEventListener("click", act);
}

/** What the map shows, and what it does not say. */
function caption() {
  const map = mapShown(), parts = [], count = map.parts.count;
  if (!nodeCount) return ["This graph has no nodes."];
  if (!placesShown()) return ["The nodes have no poses, and there is no odometry to compute any from: there is no map."];
  if (!map.hasPoses) {
    parts.push("The nodes have no poses. The map shows dead reckoning.");
    if (data.before.chains > 1) parts.push(element("b", {}, `Each of the ${number(data.before.chains)} chains of odometry begins at the origin: their positions relative to each other mean nothing.`));
  }
  else if (showsBefore()) parts.push(data.before.reckoned ? "Dead reckoning: each chain of odometry begins at the pose of its first node." : "The poses before.");
  else parts.push(map.optimised ? "Optimised poses." : "Poses of the graph; its history names no optimiser.");
  if (count > 1 && map.hasPoses) parts.push(element("b", {}, `${number(count)} components that no edge in use joins: their positions relative to each other mean nothing.`));
  if (rejectedMode() === "near" && grouped.rejected) parts.push(`${counted(grouped.rejected, "rejected edge")}: drawn near ${matchMedia("(hover: none)").matches ? "where you tap" : "the pointer"}.`);
  return parts.flatMap((part) => [part, " "]);
}

when(["map", "after", "rejected", "filters", "probability", "pair", "part"], () => byId("caption").replaceChildren(...caption()));

when(["map"], () => {
  const map = mapShown(), counts = map.states.map(() => 0);
  for (const index of map.state) counts[index] += 1;
  const states = map.states.map((one, index) => [one, counts[index]]).filter(([one]) => one.kind !== "absent").slice(0, 6);
  const notable = data.doubts.length + data.remarks.filter((one) => one.severity !== "note").length;
  byId("summary").replaceChildren(
    `${counted(nodeCount, "node")}, `, element("b", {}, counted(edgeCount, "landmark edge")), edgeCount ? ": " : "",
    states.map(([one, count]) => `${number(count)} ${one.name}`).join(", "),
    notable ? element("button", { type: "button", id: "notable", onclick: () => change({ tab: "findings" }) }, counted(notable, "warning")) : "");
  over.setAttribute("aria-label", `Map of ${counted(nodeCount, "node")} and ${counted(edgeCount, "landmark edge")}: ${states.map(([one, count]) => `${count} ${one.name}`).join(", ")}`);
});

byId("search").hidden = !edgeCount;
byId("search").addEventListener("submit", (event) => {
  event.preventDefault();
  const wanted = byId("wanted").value.trim(), edge = edgeOfId().get(wanted);
  byId("found").textContent = edge !== undefined ? "" : wanted ? `There is no landmark edge ${wanted}.` : "";
  if (edge !== undefined) select(edge);
});

// The line between map and tables.
function setPanel(share) {
  const height = Math.round(Math.max(15, Math.min(80, share)));
  byId("layout").style.setProperty("--panel", `${height}%`);
  byId("splitter").setAttribute("aria-valuenow", height);
}
byId("splitter").setAttribute("aria-valuenow", 36);
byId("splitter").addEventListener("pointerdown", (event) => event.target.setPointerCapture(event.pointerId));
byId("splitter").addEventListener("pointermove", (event) => {
  const box = byId("layout").getBoundingClientRect();
  if (event.target.hasPointerCapture(event.pointerId)) setPanel((100 * (box.bottom - event.clientY)) / box.height);
});
byId("splitter").addEventListener("keydown", (event) => {
  const step = { ArrowUp: 5, ArrowDown: -5 }[event.key];
  if (!step) return;
  event.preventDefault();
  setPanel(Number(byId("splitter").getAttribute("aria-valuenow")) + step);
});
