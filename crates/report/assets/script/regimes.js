// The map of regimes: where the graph cut helps, is neutral, or hurts.

if (byId("regimes-maps")) {
  const map = page.regimes, floor = 0.1;
  const chosen = {
    session: map.sessions[0], kind: map.kinds[0], quantity: "mean",
    scale: map.scales.reduce((best, value, index) => (Math.abs(Math.log(value / 3)) < Math.abs(Math.log(map.scales[best] / 3)) ? index : best), 0),
    rate: map.rates.reduce((best, value, index) => (Math.abs(value - 0.1) < Math.abs(map.rates[best] - 0.1) ? index : best), 0),
  };
  const quantities = [["mean", "RMSE"], ["precision", "precision of edges"], ["recall", "recall of edges"]];
  const choices = { session: map.sessions.map((one) => [one, one]), kind: map.kinds.map((one) => [one, one]), quantity: quantities };
  const largest = Math.max(floor * 10, ...map.maps.flatMap((one) => one.cells.map((cell) => cell?.mean ?? 0)));
  const top = roundUp(largest), shareOf = (value) => Math.log10(Math.max(value, floor) / floor) / Math.log10(top / floor);
  const widest = Math.max(1, ...map.comparisons.flatMap((one) => one.cells.map((cell) => Math.abs(cell?.difference ?? 0))));
  const bend = (value) => Math.log10(1 + Math.abs(value) / floor) / Math.log10(1 + roundUp(widest) / floor);
  for (const name of ["session", "kind", "quantity"]) {
    byId(`regimes-${name}`).addEventListener("change", (event) => {
      chosen[name] = event.target.value;
      redraw();
    });
  }
  for (const name of ["scale", "rate"]) {
    byId(`regimes-at-${name}`).addEventListener("change", (event) => {
      chosen[name] = Number(event.target.value);
      redraw();
    });
  }
  /** What was swept for the kind of false edges chosen: other kinds than the uniform one have fewer points. */
  function swept() {
    const columns = map.scales.length, cells = ofChoice(map.maps).map((one) => one.cells);
    const known = (rate, scale) => cells.some((list) => list[rate * columns + scale]);
    const rates = map.rates.map((_, rate) => rate).filter((rate) => map.scales.some((_, scale) => known(rate, scale)));
    const scales = map.scales.map((_, scale) => scale).filter((scale) => map.rates.some((_, rate) => known(rate, scale)));
    const nearest = (list, place) => list.reduce((best, one) => (Math.abs(one - place) < Math.abs(best - place) ? one : best), list[0] ?? place);
    return { rates, scales, nearest };
  }
  const ofChoice = (list) => list.filter((one) => one.session === chosen.session && one.kind === chosen.kind);
  const signed = (value) => (Math.abs(value) < 0.005 ? "0.00" : `${value < 0 ? "−" : "+"}${metres(Math.abs(value))}`);

  /** A panel of cells: rates upwards, scales to the right. `show(cell)` gives fill, text and description. */
  function panel(title, cells, show) {
    const { rates, scales } = swept();
    const left = 58, bottom = 40, width = 340, cellHeight = 32;
    const cellWidth = Math.min(90, (width - left - 6) / Math.max(1, scales.length));
    const height = cellHeight * rates.length + bottom + 6, right = left + cellWidth * scales.length;
    const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${title}: ${rates.length} rates by ${scales.length} covariance scales.` });
    const above = (row) => 4 + (rates.length - 1 - row) * cellHeight;
    rates.forEach((rate, row) => scales.forEach((scale, column) => {
      const cell = cells[rate * map.scales.length + scale];
      const x = left + column * cellWidth, y = above(row);
      const { fill, dark, text, about, dot } = cell ? show(cell) : { fill: "none", dark: false, text: "–", about: "no data" };
      const ink = dark ? "#ffffff" : cell ? "#14181d" : colour("soft");
      const size = Math.min(12.5, (cellWidth / Math.max(4, text.length)) * 1.55);
      const here = chosen.scale === scale && chosen.rate === rate;
      drawing.append(svg("g", { class: here ? "cell chosen" : "cell", onclick: () => {
        Object.assign(chosen, { scale, rate });
        redraw();
      } },
      svg("rect", { x: x + 1, y: y + 1, width: cellWidth - 2, height: cellHeight - 2, rx: 3, fill }),
      svg("text", { x: x + cellWidth / 2, y: y + cellHeight / 2 + 4, "text-anchor": "middle", style: null, "font-size": size, fill: ink }, text),
      dot ? svg("circle", { cx: x + cellWidth - 7, cy: y + 7, r: 2.6, fill: ink }) : null,
      svg("title", {}, `covariance × ${short(map.scales[scale])}, ${percent(map.rates[rate])} false: ${about}`)));
    }));
    // Style sheets win over attributes: numbers in cells have their own size and colour.
    for (const text of drawing.querySelectorAll(".cell text")) {
      text.style.fill = text.getAttribute("fill");
      text.style.fontSize = `${text.getAttribute("font-size")}px`;
    }
    rates.forEach((rate, row) => drawing.append(svg("text", {
      x: left - 6, y: above(row) + cellHeight / 2 + 4, "text-anchor": "end",
    }, percent(map.rates[rate]))));
    scales.forEach((scale, column) => drawing.append(svg("text", {
      x: left + (column + 0.5) * cellWidth, y: height - bottom + 12, "text-anchor": "middle",
    }, `× ${short(map.scales[scale])}`)));
    drawing.append(svg("text", { x: (left + right) / 2, y: height - 8, "text-anchor": "middle" }, scales.length > 2 ? "claimed odometry covariance / (0.1 m, 0.0167 rad)^2 per step" : "covariance"));
    const middle = 4 + (rates.length * cellHeight) / 2;
    drawing.append(svg("text", { x: 10, y: middle, transform: `rotate(-90 10 ${middle})`, "text-anchor": "middle" }, rates.length > 2 ? "share of false edges" : "false"));
    return element("div", {}, element("h4", {}, title), drawing);
  }

  function ramp(place, stops, labels, text) {
    const count = 60, width = 350;
    const drawing = svg("svg", { viewBox: `0 0 ${width} 38`, role: "img", "aria-label": text });
    for (let index = 0; index < count; index += 1) {
      drawing.append(svg("rect", { x: (index * width) / count, y: 2, width: width / count + 0.5, height: 14, fill: stops(index / (count - 1)) }));
    }
    for (const [share, label] of labels) {
      drawing.append(svg("text", { x: share * width, y: 31, "text-anchor": share < 0.03 ? "start" : share > 0.97 ? "end" : "middle" }, label));
    }
    place.replaceChildren(drawing, element("span", {}, text));
  }

  const interval = (cell) => `${metres(cell.mean)} m [${metres(cell.low)}, ${metres(cell.high)}], ${cell.seeds} runs`;
  const shows = {
    mean: (cell) => ({ fill: along(viridis, shareOf(cell.mean)).css, dark: along(viridis, shareOf(cell.mean)).dark, text: cell.mean < 100 ? metres(cell.mean) : cell.mean.toFixed(0), about: interval(cell) }),
    precision: (cell) => share(cell.precision, "precision"),
    recall: (cell) => share(cell.recall, "recall"),
  };
  function share(value, name) {
    if (value === null) return { fill: "none", dark: false, text: "–", about: `no ${name}` };
    const { css, dark } = along(viridis, 1 - value);
    return { fill: css, dark, text: value.toFixed(value > 0.995 || value < 0.1 ? 3 : 2), about: `${name} ${value.toFixed(4)}` };
  }
  function effect(cell) {
    const { css, dark } = along(cell.difference < 0 ? better : worse, bend(cell.difference));
    return { fill: css, dark, text: Math.abs(cell.difference) < 100 ? signed(cell.difference) : `${cell.difference < 0 ? "−" : "+"}${Math.abs(cell.difference).toFixed(0)}`, dot: cell.verdict !== "neutral",
      about: `${signed(cell.difference)} m [${signed(cell.low)}, ${signed(cell.high)}], adjusted p ${cell.p < 0.001 ? "below 0.001" : cell.p.toFixed(3)}, ${cell.seeds} pairs: ${cell.verdict}` };
  }

  function drawMaps() {
    const named = quantities.find(([value]) => value === chosen.quantity)[1];
    const drawnHere = ofChoice(map.maps).filter((one) => one.cells.some(Boolean));
    byId("regimes-maps").replaceChildren(...drawnHere.map((one) => panel(one.method, one.cells, shows[chosen.quantity])));
    if (!drawnHere.length) byId("regimes-maps").replaceChildren(element("p", {}, "There are no results with these false edges on this session."));
    if (chosen.quantity === "mean") {
      const ticks = [];
      for (let power = floor; power <= top * 1.001; power *= 10) ticks.push([shareOf(power), power === floor ? "≤ 0.1" : short(power)]);
      ramp(byId("regimes-scale"), (at) => along(viridis, at).css, ticks, "mean RMSE, metres");
    } else {
      ramp(byId("regimes-scale"), (at) => along(viridis, 1 - at).css, [[0, "0"], [0.5, "0.5"], [1, "1"]], named);
    }
    byId("regimes-maps-caption").textContent = `${chosen.quantity === "mean" ? "Mean RMSE over seeds, metres, coloured on a logarithmic scale" : `Mean ${named} over seeds`}: share of false edges upwards, the covariance that the odometry claims, relative to that of 0.1 m and 0.0167 rad per keyframe step, to the right. Point at a cell for its 95 % interval and number of runs.`;
    const limit = roundUp(widest);
    ramp(byId("regimes-difference-scale"), (at) => along(at < 0.5 ? better : worse, Math.abs(2 * at - 1)).css,
      [[0, `−${short(limit)}`], [(1 - bend(1)) / 2, "−1"], [0.5, "0"], [(1 + bend(1)) / 2, "+1"], [1, `+${short(limit)}`]], "difference of RMSE, metres");
    const comparisons = ofChoice(map.comparisons).filter((one) => one.cells.some(Boolean));
    byId("regimes-differences").replaceChildren(...comparisons.map((one) => {
      const count = (verdict) => one.cells.filter((cell) => cell?.verdict === verdict).length;
      const drawn = panel(`${one.with} against ${one.without}`, one.cells, effect);
      drawn.append(element("div", { class: "counts" }, `helps in ${count("helps")}, neutral in ${count("neutral")}, hurts in ${count("hurts")} of ${one.cells.filter(Boolean).length} cells`));
      return drawn;
    }));
    if (!comparisons.length) byId("regimes-differences").replaceChildren(element("p", {}, "No method has results here with and without the graph cut."));
  }

  function curves(place, values, cellAt, x, xLabel) {
    const lines = ofChoice(map.maps).filter((one) => one.cells.some(Boolean)).map((one) => ({ one, style: methodStyle(one.method, map.methods), cells: values.map((value, index) => cellAt(one.cells, index)) }));
    const { drawing, x: xScale, y } = chart(place, {
      height: 330, x, y: (start, end) => logarithmic(floor, top, start, end), xLabel, yLabel: "mean RMSE (m)",
      description: `${xLabel}: ${lines.map(({ one, cells }) => `${one.method} ${cells.map((cell) => (cell ? metres(cell.mean) : "no data")).join(", ")}`).join("; ")}.`,
    });
    for (const { style, cells } of lines) {
      const known = cells.map((cell, index) => (cell ? [values[index], cell] : null)).filter(Boolean);
      if (known.length < 2) continue;
      const band = [...known.map(([value, cell]) => [xScale(value), y(cell.high)]), ...known.reverse().map(([value, cell]) => [xScale(value), y(cell.low)])];
      drawing.append(svg("path", { d: `${path(band)}Z`, fill: style.colour, "fill-opacity": 0.16 }));
    }
    for (const { one, style, cells } of lines) {
      drawing.append(svg("path", { d: path(cells.map((cell, index) => cell && [xScale(values[index]), y(cell.mean)])), ...stroke(style) }));
      cells.forEach((cell, index) => cell && drawing.append(svg("circle", { cx: xScale(values[index]), cy: y(cell.mean), r: 3.6, fill: style.colour },
        svg("title", {}, `${one.method}: ${interval(cell)}`))));
    }
    return lines;
  }

  figure(() => {
    for (const [name, list] of Object.entries(choices)) offer(byId(`regimes-${name}`), list, chosen[name]);
    const { rates, scales, nearest } = swept();
    Object.assign(chosen, { scale: nearest(scales, chosen.scale), rate: nearest(rates, chosen.rate) });
    offer(byId("regimes-at-scale"), scales.map((scale) => [scale, `× ${short(map.scales[scale])}`]), chosen.scale);
    offer(byId("regimes-at-rate"), rates.map((rate) => [rate, percent(map.rates[rate])]), chosen.rate);
    drawMaps();
    const columns = map.scales.length, ticked = (scale, values, text) => Object.assign(scale, { ticks: values.map((value) => [value, text(value)]) });
    const [lowest, highest] = [Math.min(...map.scales), Math.max(...map.scales)];
    const lines = curves(byId("regimes-over-rate"), map.rates, (cells, index) => cells[index * columns + chosen.scale],
      (start, end) => ticked(logarithmic(Math.max(1e-4, Math.min(...map.rates)), Math.max(...map.rates), start, end), map.rates, percent), `share of false edges, at covariance × ${short(map.scales[chosen.scale])}`);
    curves(byId("regimes-over-scale"), map.scales, (cells, index) => cells[chosen.rate * columns + index],
      (start, end) => ticked(logarithmic(lowest, highest, start, end), map.scales, (value) => `× ${short(value)}`), `claimed covariance / (0.1 m, 0.0167 rad)^2 per step, at ${percent(map.rates[chosen.rate])} false edges`);
    legend(byId("regimes-legend"), lines.map(({ one, style }) => [{ ...style, dot: true }, one.method]));
  });
}
