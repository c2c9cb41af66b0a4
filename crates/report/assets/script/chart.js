// Charts with two axes.

/** An empty chart as wide as its place; returns its parts. */
function chart(place, { height, left = 56, right = 16, top = 12, bottom = 44, x, y, xLabel, yLabel, description }) {
  const width = Math.max(280, place.clientWidth);
  const inner = { left, right: width - right, top, bottom: height - bottom };
  const xScale = x(inner.left, inner.right), yScale = y ? y(inner.bottom, inner.top) : null;
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": description });
  for (const [value, text] of xScale.ticks) {
    drawing.append(
      svg("line", { class: "grid", x1: xScale(value), x2: xScale(value), y1: inner.top, y2: inner.bottom }),
      svg("text", { x: xScale(value), y: inner.bottom + 16, "text-anchor": "middle" }, text));
  }
  for (const [value, text] of yScale?.ticks ?? []) {
    drawing.append(
      svg("line", { class: "grid", x1: inner.left, x2: inner.right, y1: yScale(value), y2: yScale(value) }),
      svg("text", { x: inner.left - 7, y: yScale(value) + 4, "text-anchor": "end" }, text));
  }
  drawing.append(
    svg("line", { class: "axis", x1: inner.left, x2: inner.right, y1: inner.bottom, y2: inner.bottom }),
    svg("text", { x: (inner.left + inner.right) / 2, y: height - 8, "text-anchor": "middle" }, xLabel));
  if (yLabel) {
    const middle = (inner.top + inner.bottom) / 2;
    drawing.append(svg("text", { x: 14, y: middle, "text-anchor": "middle", transform: `rotate(-90 14 ${middle})` }, yLabel));
  }
  place.replaceChildren(drawing);
  return { drawing, inner, width, height, x: xScale, y: yScale };
}

/** The path through points; a gap where one is missing. */
function path(points) {
  let text = "", pen = "M";
  for (const point of points) {
    if (!point) {
      pen = "M";
      continue;
    }
    text += `${pen}${point[0].toFixed(1)} ${point[1].toFixed(1)}`;
    pen = "L";
  }
  return text;
}

function stroke(style) {
  return {
    fill: "none", stroke: style.colour, "stroke-width": style.width, "stroke-linejoin": "round",
    "stroke-dasharray": style.dash ? style.dash.join(" ") : null,
  };
}

function legend(place, entries) {
  place.replaceChildren(...entries.map(([style, text]) => element("span", {}, swatch(style), text)));
}
