// The error of every pose along a session.

if (byId("error-chart")) {
  byId("error-log").addEventListener("change", redraw);
  figure(() => {
    const place = byId("error-chart"), view = seed(), floor = page.error_step;
    const lines = (view?.methods ?? []).filter((method) => method.error)
      .map((method) => ({ method, errors: series(method.error, page.error_step), style: methodStyle(method.name, experiment().methods) }));
    if (!lines.length) {
      place.replaceChildren(element("p", {}, "There is no error over time for this selection."));
      byId("error-legend").replaceChildren();
      return;
    }
    const count = lines[0].errors.length;
    const minutes = session().minutes && series(session().minutes, 0.01).length === count ? series(session().minutes, 0.01) : null;
    const at = (index) => (minutes ? minutes[index] : index);
    let largest = floor * 10;
    for (const line of lines) for (const error of line.errors) largest = Math.max(largest, error);
    const log = byId("error-log").checked;
    const { drawing, inner, x, y } = chart(place, {
      height: 360,
      x: (start, end) => linear(at(0), at(count - 1), start, end),
      y: (start, end) => (log ? logarithmic(floor, roundUp(largest), start, end) : linear(0, largest * 1.04, start, end)),
      xLabel: minutes ? "minutes since the start" : "index of the pose", yLabel: "error (m)",
      description: `Error over time of ${state.session}, seed ${state.seed}: ${lines.map((line) => `${line.method.name} RMSE ${metres(line.method.rmse)} m`).join(", ")}.`,
    });
    for (const { start, name } of view.experiences.slice(1)) {
      drawing.append(svg("line", { x1: x(at(start)), x2: x(at(start)), y1: inner.top, y2: inner.bottom, stroke: colour("ink"), "stroke-width": 1.2, "stroke-dasharray": "4 3" },
        svg("title", {}, `${name} begins`)));
    }
    for (const { errors, style } of lines) {
      drawing.append(svg("path", { d: path(Array.from(errors, (error, index) => [x(at(index)), y(error)])), ...stroke(style) }));
    }
    legend(byId("error-legend"), lines.map(({ method, style }) => [style, `${method.name} ${metres(method.rmse)} m`]));
    const cursor = svg("line", { class: "axis", y1: inner.top, y2: inner.bottom, visibility: "hidden" });
    drawing.append(cursor);
    drawing.addEventListener("pointermove", (event) => {
      const box = drawing.getBoundingClientRect();
      const wanted = x.invert(((event.clientX - box.left) / box.width) * drawing.viewBox.baseVal.width);
      let [low, high] = [0, count - 1];
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (at(middle) > wanted) high = middle;
        else low = middle;
      }
      const index = Math.abs(at(high) - wanted) < Math.abs(at(low) - wanted) ? high : low;
      for (const name of ["x1", "x2"]) cursor.setAttribute(name, x(at(index)));
      cursor.setAttribute("visibility", "visible");
      const time = minutes ? `${at(index).toFixed(1)} min` : `pose ${index}`;
      byId("error-readout").textContent = `${time}: ${lines.map(({ method, errors }) => `${method.name} ${metres(errors[index])} m`).join(", ")}`;
    });
  });
}
