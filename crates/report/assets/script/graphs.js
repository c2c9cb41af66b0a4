// Optimised graphs before and after, with the fate of their landmark edges.

const layers = [
  { name: "reference", text: "reference", style: () => ({ colour: colour("reference"), width: 5 }) },
  { name: "odometry", text: "odometry", style: () => ({ colour: colour("first"), width: 1.6 }) },
  { name: "t+", text: "correct, kept", style: () => ({ colour: colour("correct"), width: 1.8 }) },
  { name: "t-", text: "correct, rejected", style: () => ({ colour: colour("correct"), width: 1.6, dash: [4, 4] }) },
  { name: "?+", text: "truth unknown, kept", style: () => ({ colour: colour("unknown"), width: 1.6 }) },
  { name: "?-", text: "truth unknown, rejected", style: () => ({ colour: colour("unknown"), width: 1.2, dash: [4, 4] }) },
  { name: "f-", text: "incorrect, rejected", style: () => ({ colour: colour("false"), width: 1.2, dash: [5, 4] }) },
  { name: "f+", text: "incorrect, kept", style: () => ({ colour: colour("false"), width: 3.2, dot: true }) },
];

if (byId("graph-left-map")) {
  const shown = new Set(layers.map((layer) => layer.name));
  const camera = new Camera();
  const sides = ["left", "right"].map((side) => ({ side, method: null, map: new MapView(byId(`graph-${side}-map`), camera, "m") }));
  mapButtons(byId("graph-buttons"), camera);

  const fate = (edge) => edge.truth + (edge.kept ? "+" : "-");

  function drawLayers() {
    const unknown = seed()?.edges.truth.includes("?");
    byId("graph-layers").replaceChildren(...layers.filter((layer) => !layer.name.startsWith("?") || unknown).map((layer) => {
      const box = element("input", { type: "checkbox", id: `layer-${layer.name}`, onchange: () => {
        if (box.checked) shown.add(layer.name);
        else shown.delete(layer.name);
        camera.paint();
      } });
      box.checked = shown.has(layer.name);
      const samples = layer.name === "odometry"
        ? (seed()?.experiences ?? []).slice(0, 4).map((experience, index) => swatch({ colour: experienceColour(index), width: 2.5 }))
        : [swatch(layer.style())];
      return element("label", {}, box, ...samples, layer.text);
    }));
  }

  function painter(view, method) {
    const track = places(method.track), reference = places(view.reference);
    return (context, toScreen) => {
      const styles = Object.fromEntries(layers.map((layer) => [layer.name, layer.style()]));
      view.experiences.forEach(({ start, end }) => {
        if (reference && shown.has("reference")) trace(context, toScreen, reference, start, end, styles.reference);
      });
      view.experiences.forEach(({ start, end }, index) => {
        if (track && shown.has("odometry")) trace(context, toScreen, track, start, end, { colour: experienceColour(index), width: 1.4 });
      });
      if (!track) return;
      const edges = edgesOf(view, method);
      for (const layer of layers.slice(2)) {
        if (!shown.has(layer.name)) continue;
        const style = styles[layer.name];
        for (const edge of edges.filter((one) => fate(one) === layer.name)) {
          const ends = [edge.from, edge.to].map((node) => toScreen(track.x[node], track.y[node]));
          strokeEdge(context, ends, style);
        }
      }
    };
  }

  function pointer(view, method) {
    const track = places(method.track);
    return (x, y, tolerance) => {
      let nearest = null, least = tolerance;
      for (const edge of track ? edgesOf(view, method) : []) {
        if (!shown.has(fate(edge))) continue;
        const away = distance(x, y, [track.x[edge.from], track.y[edge.from]], [track.x[edge.to], track.y[edge.to]]);
        if (away <= least) [nearest, least] = [edge, away];
      }
      byId("graph-readout").textContent = nearest ? `${method.name}: ${told(nearest)}` : "Point at an edge to see its details.";
    };
  }

  const usual = { left: ["pcm", "none"], right: ["pcm+gc", "gc"] };
  for (const side of sides) {
    byId(`graph-${side.side}`).addEventListener("change", (event) => {
      side.method = event.target.value;
      redraw();
    });
  }

  figure(() => {
    const view = seed();
    drawLayers();
    const methods = view?.methods.filter((method) => method.track) ?? [];
    camera.lookAt(around([view?.reference, ...methods.map((method) => method.track)].filter(Boolean).map(places)));
    for (const side of sides) {
      if (!methods.some((method) => method.name === side.method)) {
        side.method = usual[side.side].find((name) => methods.some((method) => method.name === name)) ?? methods[0]?.name;
      }
      offer(byId(`graph-${side.side}`), methods.map((method) => [method.name, method.name]), side.method);
      const method = methods.find((one) => one.name === side.method);
      side.map.draw = method ? painter(view, method) : () => {};
      side.map.point = method ? pointer(view, method) : null;
      const count = (name) => (method ? edgesOf(view, method).filter((edge) => fate(edge) === name).length : 0);
      const counted = layers.slice(2).filter((layer) => !layer.name.startsWith("?") || count(layer.name))
        .map((layer) => [layer.name === "f+" && count(layer.name) ? "b" : "span", `${layer.text}: ${count(layer.name)}`]);
      const counts = counted.map(([, text]) => text).join(", ");
      byId(`graph-${side.side}-counts`).replaceChildren(...counted.flatMap(([kind, text], index) => [index ? " \u00b7 " : "", element(kind, {}, text)]));
      byId(`graph-${side.side}-rmse`).textContent = method ? `RMSE ${metres(method.rmse)} m${method.components > 1 ? `, ${method.components} components` : ""}` : "";
      byId(`graph-${side.side}-map`).setAttribute("aria-label", `Map of ${side.method ?? "nothing"}. ${counts}.`);
      side.map.schedule();
    }
  });
}
