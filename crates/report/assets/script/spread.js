// RMSE of every run.

figure(() => {
  const place = byId("spread"), rows = experiment()?.spread.filter((row) => row.rmse.length) ?? [];
  byId("spread-figure").hidden = rows.length === 0;
  if (!rows.length) return;
  byId("spread-title").textContent = `Every run of ${experiment().name}`;
  const methods = experiment().methods, lane = 17, gap = 14, floor = 0.01;
  const names = [...new Set(rows.map((row) => row.session))];
  const height = names.reduce((sum, name) => sum + gap + lane * rows.filter((row) => row.session === name).length, 0) + 74;
  const largest = Math.max(floor * 10, ...rows.flatMap((row) => [...row.rmse.map(([, value]) => value), row.published ?? 0]));
  const { drawing, inner, x } = chart(place, {
    height, left: 118, top: 30, x: (start, end) => logarithmic(floor, roundUp(largest), start, end),
    xLabel: "RMSE (m)", description: `RMSE of every run of ${experiment().name}: the same values as in the table.`,
  });
  let y = inner.top;
  for (const name of names) {
    drawing.append(svg("text", { class: "strong", x: 4, y: y + 4 }, name));
    y += gap;
    for (const row of rows.filter((one) => one.session === name)) {
      const style = methodStyle(row.method, methods);
      const mean = row.rmse.reduce((sum, [, value]) => sum + value, 0) / row.rmse.length;
      drawing.append(
        svg("text", { x: inner.left - 10, y: y + 4, "text-anchor": "end" }, row.method),
        svg("line", { class: "grid", x1: inner.left, x2: inner.right, y1: y, y2: y, "stroke-dasharray": "1 3" }));
      for (const [seed, value] of row.rmse) {
        drawing.append(svg("circle", { cx: x(value), cy: y, r: 4.5, fill: style.colour, "fill-opacity": 0.55 },
          svg("title", {}, `${row.method}, ${name}, seed ${seed}: ${metres(value)} m`)));
      }
      drawing.append(svg("rect", { x: x(mean) - 1.5, y: y - 8, width: 3, height: 16, fill: style.colour },
        svg("title", {}, `${row.method}, ${name}: mean ${metres(mean)} m`)));
      if (row.published !== null) {
        const at = x(row.published);
        drawing.append(svg("path", { d: `M${at} ${y - 7}L${at + 6} ${y}L${at} ${y + 7}L${at - 6} ${y}Z`, fill: "none", stroke: colour("ink"), "stroke-width": 1.5 },
          svg("title", {}, `${row.method}, ${name}, published: ${metres(row.published)} m`)));
      }
      y += lane;
    }
  }
});
