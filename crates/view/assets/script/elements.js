// Making elements. Text is always set as text, never as markup.

function byId(id) {
  return document.getElementById(id);
}

function fillIn(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

function element(name, attributes = {}, ...children) {
  return fillIn(document.createElement(name), attributes, children);
}

function svg(name, attributes = {}, ...children) {
  return fillIn(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

/** Offers choices; keeps the chosen one if it is still there. */
function offer(select, choices, chosen) {
  select.replaceChildren(...choices.map(([value, text]) => {
    const option = element("option", { value }, text);
    option.selected = String(value) === String(chosen);
    return option;
  }));
}

/** A short piece of line as it is drawn in a map or chart. */
function swatch(style) {
  const sample = svg("svg", { class: "swatch", viewBox: "0 0 34 14", "aria-hidden": "true" });
  if (style.fill) {
    sample.append(svg("rect", { x: 9, y: 0, width: 16, height: 14, rx: 3, fill: style.fill, stroke: style.outline }));
    return sample;
  }
  if (style.ring) {
    sample.append(svg("circle", { cx: 17, cy: 7, r: 4.5, fill: "none", stroke: style.colour, "stroke-width": 1.6 }));
    return sample;
  }
  if (style.bar) {
    sample.append(svg("rect", { x: 15.5, y: 0, width: 3, height: 14, fill: style.colour }));
    return sample;
  }
  if (style.cross) {
    sample.append(svg("path", { d: "M12 2L22 12M22 2L12 12", stroke: style.colour, "stroke-width": 2 }));
    return sample;
  }
  if (!style.dot || style.width) {
    sample.append(svg("line", {
      x1: 2, y1: 7, x2: 32, y2: 7, stroke: style.colour, "stroke-width": style.width ?? 2,
      "stroke-dasharray": style.dash ? style.dash.join(" ") : null,
    }));
  }
  if (style.dot) {
    for (const x of style.width ? [5, 29] : [17]) sample.append(svg("circle", { cx: x, cy: 7, r: 4, fill: style.colour }));
  }
  return sample;
}
