// Calibration of probabilities: share of correct edges over their probability, one panel a family.

if (byId("trust-reliability")) {
  const found = page.reliability, size = 300, left = 44, right = 14, top = 10, bottom = 42;
  const methods = found.groups[0].curves.map((curve) => curve.method);
  const styleOf = (method) => methodStyle(method, methods);
  const x = (value) => left + (size - left - right) * value, y = (value) => size - bottom - (size - top - bottom) * value;
  const share = (value) => (value > 0 && value < 1 ? Math.min(0.999, Math.max(0.001, value)) : value).toFixed(3);

  function panel(group) {
    const said = group.curves.map((curve) => `${curve.method} has a calibration error of ${curve.error.toFixed(4)} over ${curve.edges} edges`);
    const drawing = svg("svg", { viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": `Reliability diagram of ${group.name}: ${said.join(", ")}.` });
    for (const tick of [0, 0.2, 0.4, 0.6, 0.8, 1]) {
      drawing.append(
        svg("line", { class: "grid", x1: x(tick), x2: x(tick), y1: y(1), y2: y(0) }),
        svg("line", { class: "grid", x1: x(0), x2: x(1), y1: y(tick), y2: y(tick) }),
        svg("text", { x: x(tick), y: y(0) + 15, "text-anchor": "middle" }, short(tick)),
        svg("text", { x: left - 6, y: y(tick) + 4, "text-anchor": "end" }, short(tick)));
    }
    const middle = (y(0) + y(1)) / 2;
    drawing.append(
      svg("text", { x: x(0.5), y: size - 8, "text-anchor": "middle" }, "mean probability"),
      svg("text", { x: 12, y: middle, "text-anchor": "middle", transform: `rotate(-90 12 ${middle})` }, "share correct"),
      svg("line", { x1: x(0), x2: x(1), y1: y(0), y2: y(1), stroke: colour("ink"), "stroke-width": 1, "stroke-dasharray": "1.5 3.5" }));
    for (const curve of group.curves) {
      const style = styleOf(curve.method);
      drawing.append(svg("path", { d: path(curve.points.map((point) => [x(point.probability), y(point.correct)])), ...stroke(style) }));
      for (const point of curve.points) {
        const at = x(point.probability);
        if (point.interval) drawing.append(svg("line", { x1: at, x2: at, y1: y(point.interval[0]), y2: y(point.interval[1]), stroke: style.colour, "stroke-width": 1 }));
        drawing.append(svg("circle", { cx: at, cy: y(point.correct), r: 1.5 + 1.5 * Math.log10(point.edges), fill: style.colour },
          svg("title", {}, `${curve.method}: ${point.edges} edges of mean probability ${share(point.probability)}, ${share(point.correct)} correct`)));
      }
    }
    const errors = group.curves.map((curve) => `${curve.method} ${curve.error.toFixed(4)}`).join(", ");
    return element("div", {}, element("h4", {}, `${group.name}: ${errors}`), drawing);
  }

  figure(() => {
    legend(byId("trust-reliability-legend"), [
      ...methods.map((method) => [styleOf(method), method]),
      [{ colour: colour("ink"), width: 1, dash: [1.5, 3.5] }, "perfect calibration"],
    ]);
    byId("trust-reliability").replaceChildren(...found.groups.map(panel));
  });
}
