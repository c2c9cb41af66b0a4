// The details of the edge that is pointed at or selected.

function fact(name, ...value) {
  return [element("dt", {}, name), element("dd", {}, ...value)];
}

function bar(share) {
  return svg("svg", { class: "bar", viewBox: "0 0 100 7", preserveAspectRatio: "none", "aria-hidden": "true" },
    svg("rect", { x: 0, y: 0, width: 100, height: 7, rx: 3 }), svg("rect", { x: 0, y: 0, width: Math.max(1, 100 * share), height: 7, rx: 3 }));
}

function endOf(node) {
  const name = nodeName(node), id = `node ${nodeId(node)}`;
  return name === id ? id : `${name} (${id})`;
}

/** Length and angle of a motion; null if it is unknown. */
function motionText(of, edge) {
  if (!of || Number.isNaN(of.metres[edge])) return null;
  return `${inMetres(of.metres[edge])}, ${inDegrees(of.degrees[edge])}`;
}

/** The residual at the poses of the map, and before. */
function residualFacts(edge) {
  const map = mapShown(), after = motionText(map.residuals(), edge), earlier = before && motionText(before.residuals(), edge);
  const found = after ? fact("residual", element("strong", {}, after)) : [];
  if (earlier) found.push(...fact(data.before.reckoned ? "\u2026 by odometry" : "\u2026 before", earlier));
  return found;
}

function mappedDistance(edge) {
  const from = ends.from[edge], to = ends.to[edge], places = placesShown();
  if (!places || !places.placed(from) || !places.placed(to)) return NaN;
  return Math.hypot(...places.axes.map((axis) => axis[from] - axis[to]));
}

function fieldFacts(edge) {
  const found = [], map = mapShown(), probability = map.column("verify_probability")?.value(edge);
  if (typeof probability === "number") found.push(...fact("probability", probability.toFixed(3), bar(probability)));
  for (const column of map.columns) {
    if (["verify_probability", "verify_verdict", "verify_reason"].includes(column.name)) continue;
    const text = column.text(edge);
    if (text) found.push(...fact(title(column.name), column.name === "verify_hypothesis" ? hypothesisName(text) : text));
  }
  if (label()?.value(edge)) found.push(...fact("label", label().text(edge)));
  return found;
}

function witnessLinks(edge) {
  const map = mapShown(), ids = map.witnesses(edge);
  if (!ids.length) return [];
  const accepted = map.word("verify_verdict", edge) === "accepted";
  const links = ids.map((id) => {
    const witness = edgeOfId().get(id);
    return element("button", { type: "button", disabled: witness === undefined ? "" : null, "data-witness": id, onclick: () => select(witness) }, id);
  });
  return fact(accepted ? "witnesses for it" : "witnesses against it", element("span", { class: "links" }, ...links));
}

/** Selects an edge, and shows it on the map and in the table. */
function select(edge, fly = true) {
  change({ selected: edge, hovered: -1 });
  if (edge >= 0 && fly) showEdge(edge);
}

function drawCard() {
  const edge = edgeInFocus(), card = byId("card");
  if (edge < 0) {
    card.replaceChildren(element("p", { class: "empty" }, edgeCount ? "Point at an edge, or choose a row of the table, to see what happened to it and why." : "This graph has no landmark edges."));
    return;
  }
  const map = mapShown(), style = map.style(map.state[edge]), own = element("span", { class: "chip" }, swatch(style), map.stateOf(edge).name);
  own.style.color = style.colour;
  const moved = motionText(measured(), edge), mapped = mappedDistance(edge);
  const facts = [
    ...fact("from", endOf(ends.from[edge])), ...fact("to", endOf(ends.to[edge])),
    ...fact("measures", moved ? `${moved} apart` : "nothing: it says only that both are the same place"),
    ...(Number.isNaN(mapped) ? [] : fact("on this map", `${inMetres(mapped)} apart`)),
    ...residualFacts(edge), ...fieldFacts(edge), ...witnessLinks(edge),
  ];
  card.replaceChildren(
    element("div", { class: "name" }, element("h2", {}, `Edge ${edgeIds[edge]}`), own),
    element("p", { class: "story" }, story(edge)),
    element("dl", {}, ...facts),
    element("div", { class: "actions" },
      element("button", { type: "button", id: "show-edge", onclick: () => select(edge) }, "Zoom to it"),
      state.selected >= 0 ? element("button", { type: "button", class: "quiet", onclick: () => select(-1) }, "Deselect") : null),
    filter.passes[edge] ? "" : element("p", { class: "empty" }, "The filters hide this edge."));
}

when(["selected", "hovered", "map", "after", "filters", "probability", "pair", "part"], drawCard);
