// Landmarks: the components that the multicut leaves.

if (byId("components-plane")) {
  const cameras = { plane: new Camera(), map: new Camera() };
  const maps = { plane: new MapView(byId("components-plane"), cameras.plane, "frames"), map: new MapView(byId("components-map"), cameras.map, "m") };
  for (const name of ["plane", "map"]) mapButtons(byId(`components-${name}-buttons`), cameras[name]);
  let chosen = null;
  byId("components-method").addEventListener("change", (event) => {
    chosen = event.target.value;
    redraw();
  });

  /** For each node the number of its landmark; -1 for a viewpoint alone. */
  function labels(method, count) {
    const label = new Int32Array(count).fill(-1);
    method.landmarks.forEach((nodes, landmark) => nodes.forEach((node) => { label[node] = landmark; }));
    return label;
  }

  function disc(context, x, y, radius, style) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    if (style.fill) {
      context.fillStyle = style.fill;
      context.fill();
    } else {
      strokeLine(context, { colour: style.ring, width: 1.4 });
    }
  }

  function cross(context, x, y, radius) {
    context.beginPath();
    context.moveTo(x - radius, y - radius);
    context.lineTo(x + radius, y + radius);
    context.moveTo(x + radius, y - radius);
    context.lineTo(x - radius, y + radius);
    strokeLine(context, { colour: colour("false"), width: 2 });
  }

  /** What lies to the right and upwards. */
  function axes(context, [right, up]) {
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = colour("soft");
    context.textAlign = "left";
    context.fillText(`frame in ${right} \u2192`, 24, byId("components-plane").clientHeight - 10);
    context.save();
    context.translate(16, byId("components-plane").clientHeight - 26);
    context.rotate(-Math.PI / 2);
    context.fillText(`frame in ${up} \u2192`, 0, 0);
    context.restore();
  }

  figure(() => {
    const view = seed(), methods = view?.methods.filter((method) => method.landmarks) ?? [];
    if (!methods.some((method) => method.name === chosen)) chosen = (methods.find((method) => method.name === "pcm+gc") ?? methods[0])?.name;
    offer(byId("components-method"), methods.map((method) => [method.name, method.name]), chosen);
    const method = methods.find((one) => one.name === chosen);
    if (!method) {
      byId("components-summary").textContent = "The multicut has processed no graph of this selection.";
      for (const map of Object.values(maps)) map.draw = () => {};
      for (const map of Object.values(maps)) map.schedule();
      return;
    }
    const count = view.experiences.at(-1)?.end ?? 0, label = labels(method, count), edges = edgesOf(view, method);
    const hue = (landmark) => colour(`hue-${(landmark % 8) + 1}`);
    const viewpoints = method.landmarks.reduce((sum, nodes) => sum + nodes.length, 0);
    const isolated = edges.filter((edge) => !edge.kept && edge.stage === "multicut").length;
    const summary = `${method.landmarks.length} landmarks of ${viewpoints} viewpoints; the multicut rejected ${isolated} of ${edges.length} landmark edges`;
    byId("components-summary").textContent = summary;
    legend(byId("components-legend"), [
      [{ dot: true, colour: colour("hue-1") }, "kept (one colour per landmark)"], [{ ring: true, colour: colour("soft") }, "cut by the multicut"],
      [{ dot: true, colour: colour("reference") }, "rejected by another stage"], [{ cross: true, colour: colour("false") }, "incorrect"],
    ]);

    const plane = around([{ x: edges.map((edge) => edge.frames[0]), y: edges.map((edge) => edge.frames[1]) }]);
    cameras.plane.lookAt({ ...plane, width: plane.width * 1.12, height: plane.height * 1.2 });
    maps.plane.draw = (context, toScreen, scale) => {
      const radius = Math.max(3, Math.min(9, scale * 0.4));
      for (const edge of edges) {
        const [x, y] = toScreen(...edge.frames);
        if (edge.kept) disc(context, x, y, radius, { fill: label[edge.from] < 0 ? colour("unknown") : hue(label[edge.from]) });
        else if (edge.stage === "multicut") disc(context, x, y, radius, { ring: colour("soft") });
        else disc(context, x, y, Math.max(2, radius * 0.7), { fill: colour("reference") });
        if (edge.truth === "f") cross(context, x, y, radius + 2);
      }
      axes(context, axisNames);
    };
    const axisNames = view.experiences.length === 2 ? view.experiences.map((one) => one.name) : ["the first viewpoint", "the second viewpoint"];
    const track = places(method.track);
    if (track) cameras.map.lookAt(around([track]));
    maps.map.draw = (context, toScreen) => {
      if (!track) return;
      for (const { start, end } of view.experiences) trace(context, toScreen, track, start, end, { colour: colour("reference"), width: 1.6 });
      for (const edge of edges.filter((one) => one.kept || one.stage === "multicut")) {
        context.beginPath();
        context.moveTo(...toScreen(track.x[edge.from], track.y[edge.from]));
        context.lineTo(...toScreen(track.x[edge.to], track.y[edge.to]));
        const line = edge.truth === "f" ? { colour: colour("false"), width: 2.5 } : { colour: colour("soft"), width: 1 };
        strokeLine(context, edge.kept ? line : { ...line, width: 1.2, dash: [4, 4] });
      }
      for (let node = 0; node < count; node += 1) {
        if (label[node] >= 0) disc(context, ...toScreen(track.x[node], track.y[node]), 3.4, { fill: hue(label[node]) });
      }
    };
    const readout = byId("components-readout");
    const say = (edge) => {
      readout.textContent = edge ? `${told(edge)}${edge.kept && label[edge.from] >= 0 ? ` Landmark ${label[edge.from] + 1} of ${method.landmarks[label[edge.from]].length} viewpoints.` : ""}` : "Point at an edge to see its details.";
    };
    maps.plane.point = (x, y, tolerance) => say(edges.find((edge) => Math.hypot(edge.frames[0] - x, edge.frames[1] - y) <= tolerance));
    maps.map.point = track && ((x, y, tolerance) => say(edges.find((edge) => (edge.kept || edge.stage === "multicut")
      && distance(x, y, [track.x[edge.from], track.y[edge.from]], [track.x[edge.to], track.y[edge.to]]) <= tolerance)));
    for (const [name, what] of [["plane", "Landmark edges by the frames they join"], ["map", "Landmarks on the map"]]) {
      byId(`components-${name}`).setAttribute("aria-label", `${what}: ${summary}.`);
      maps[name].schedule();
    }
    const row = (cells, kind) => element("tr", {}, ...cells.map((cell) => element(kind, {}, String(cell))));
    byId("components-table").replaceChildren(
      element("thead", {}, row(["landmark", "viewpoints", "edges kept", "of them incorrect"], "th")),
      element("tbody", {}, ...method.landmarks.slice(0, 12).map((nodes, landmark) => {
        const own = edges.filter((edge) => edge.kept && label[edge.from] === landmark);
        return row([landmark + 1, nodes.length, own.length, own.filter((edge) => edge.truth === "f").length], "td");
      })));
  });
}
