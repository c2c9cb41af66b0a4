// The table of edges. Only the rows in sight are in the page.

const rowHeight = 28;
const table = { order: new Int32Array(0), columns: [], first: -1, body: null, rows: new Map() };

/** The columns of the present map: name, title, value to sort by, text. */
function columnsOf(map) {
  const wordsOf = (name, heading, text, sort = text) => ({ name, heading, text, sort, words: true });
  const found = [
    { name: "id", heading: "edge", text: (edge) => String(edgeIds[edge]), sort: (edge) => edgeIds[edge] },
    wordsOf("state", "state", (edge) => map.stateOf(edge).name, (edge) => map.state[edge]),
  ];
  const known = ["verify_reason", "verify_probability", "verify_hypothesis"];
  const field = (column) => ({ name: column.name, heading: title(column.name), text: (edge) => column.text(edge), sort: (edge) => column.value(edge), words: !column.numeric });
  found.push(...known.map((name) => map.column(name)).filter(Boolean).map(field));
  const size = (name, heading, unit, text) => found.push({
    name, heading, text: (edge) => { const all = residualsShown(); return all && !Number.isNaN(all[unit][edge]) ? text(all[unit][edge]) : ""; },
    sort: (edge) => residualsShown()?.[unit][edge] ?? NaN,
  });
  if (map.hasPoses || before) {
    size("metres", "residual, m", "metres", (value) => (value < 1e5 ? metres(value) : brief(value)));
    size("degrees", "residual, °", "degrees", (value) => value.toFixed(1));
  }
  found.push(wordsOf("from", "from", (edge) => nodeName(ends.from[edge]), (edge) => ends.from[edge]), wordsOf("to", "to", (edge) => nodeName(ends.to[edge]), (edge) => ends.to[edge]));
  if (label()) found.push(field(label()));
  found.push(...map.columns.filter((column) => ![...known, "verify_verdict"].includes(column.name)).map(field));
  return found;
}

/** Compares values of a column; missing ones come last in either direction. */
function compared(one, other, descending) {
  const missing = (value) => value === null || value === "" || Number.isNaN(value);
  if (missing(one) || missing(other)) return missing(one) - missing(other);
  const less = one < other ? -1 : one > other ? 1 : 0;
  return descending ? -less : less;
}

function sortRows() {
  const column = table.columns.find((one) => one.name === state.sort), order = Int32Array.from(filter.shown);
  if (column) {
    const values = Array.from({ length: edgeCount });
    for (const edge of order) values[edge] = column.sort(edge);
    order.sort((one, other) => compared(values[one], values[other], state.descending) || one - other);
  }
  table.order = order;
}

function headOf(column) {
  const sorted = state.sort === column.name;
  const press = () => change(sorted && state.descending ? { sort: null, descending: false } : { sort: column.name, descending: sorted });
  return element("th", { scope: "col", class: column.words ? "words" : null, "aria-sort": sorted ? (state.descending ? "descending" : "ascending") : null },
    element("button", { type: "button", "data-column": column.name, onclick: press }, column.heading + (sorted ? (state.descending ? " ↓" : " ↑") : "")));
}

function rowOf(edge, index) {
  const map = mapShown();
  const cells = table.columns.map((column) => {
    const text = column.text(edge), sample = column.name === "state" ? swatch(map.style(map.state[edge])) : null;
    return element("td", { class: column.words ? "words" : null, title: text.length > 28 ? text : null }, sample, text);
  });
  return element("tr", { tabindex: index === tabStop() ? 0 : -1, "data-row": index, "aria-rowindex": index + 2, "aria-selected": String(edge === state.selected) }, ...cells);
}

/** The row that the Tab key reaches: the selected one, or the first in sight. */
function tabStop() {
  const selected = state.selected < 0 ? -1 : table.order.indexOf(state.selected);
  return selected >= table.first && selected < table.first + table.rows.size ? selected : Math.max(0, table.first);
}

/** Puts the rows in sight into the page. */
function fillRows(force = false) {
  const place = byId("body");
  if (state.tab !== "edges" || !table.body) return;
  const count = Math.ceil(place.clientHeight / rowHeight) + 12, first = Math.max(0, Math.min(table.order.length - count, Math.floor(place.scrollTop / rowHeight) - 6));
  if (!force && first === table.first) return;
  const focused = table.body.contains(document.activeElement) ? document.activeElement.dataset.row : null;
  const shown = table.order.subarray(first, first + count);
  Object.assign(table, { first, rows: new Map(Array.from(shown, (edge, index) => [first + index, edge])) });
  const space = (rows) => {
    const cell = element("td", { colspan: table.columns.length });
    cell.style.height = `${rows * rowHeight}px`;
    return element("tr", { class: "space", "aria-hidden": "true" }, cell);
  };
  table.body.replaceChildren(space(first), ...Array.from(shown, (edge, index) => rowOf(edge, first + index)), space(Math.max(0, table.order.length - first - shown.length)));
  if (focused !== null) table.body.querySelector(`[data-row="${focused}"]`)?.focus({ preventScroll: true });
}

/** Makes the table anew. */
function drawTable() {
  const focused = document.activeElement?.dataset?.column;
  table.body = element("tbody");
  const head = element("thead", {}, element("tr", {}, ...table.columns.map(headOf)));
  byId("body").replaceChildren(element("table", { class: "grid", "aria-label": "Landmark edges", "aria-rowcount": table.order.length + 1 }, head, table.body));
  if (!table.order.length) byId("body").append(element("p", { class: "text" }, edgeCount ? "No edge passes the filters." : "This graph has no landmark edges."));
  fillRows(true);
  if (focused) head.querySelector(`[data-column="${focused}"]`)?.focus();
}

/** Scrolls to a row, and gives it the focus if that is wanted. */
function reveal(row, focus = false) {
  const place = byId("body"), top = row * rowHeight;
  if (row < 0) return;
  if (top < place.scrollTop + rowHeight || top + 2 * rowHeight > place.scrollTop + place.clientHeight) {
    place.scrollTop = focus ? (top < place.scrollTop + rowHeight ? top : top + 3 * rowHeight - place.clientHeight) : top - place.clientHeight / 2;
  }
  fillRows(true);
  if (focus) table.body.querySelector(`[data-row="${row}"]`)?.focus({ preventScroll: true });
}

when(["map"], () => { table.columns = columnsOf(mapShown()); });
when(["map", "filters", "probability", "pair", "part", "sort", "descending", "after", "tab"], () => {
  sortRows();
  if (state.tab === "edges") drawTable();
});
when(["selected"], () => {
  if (state.tab === "edges") reveal(table.order.indexOf(state.selected));
  fillRows(true);
});

const rowAt = (event) => {
  const row = event.target.closest?.("tr[data-row]");
  return row ? Number(row.dataset.row) : -1;
};
byId("body").addEventListener("scroll", () => fillRows(), { passive: true });
byId("body").addEventListener("click", (event) => { if (rowAt(event) >= 0) select(table.order[rowAt(event)]); });
byId("body").addEventListener("pointerover", (event) => {
  if (event.pointerType === "mouse") change({ hovered: rowAt(event) >= 0 ? table.order[rowAt(event)] : -1 });
});
byId("body").addEventListener("pointerleave", () => change({ hovered: -1 }));
byId("body").addEventListener("keydown", (event) => {
  const row = rowAt(event), page = Math.floor(byId("body").clientHeight / rowHeight) - 2, last = table.order.length - 1;
  const moves = { ArrowDown: row + 1, ArrowUp: row - 1, PageDown: row + page, PageUp: row - page, Home: 0, End: last };
  if (row < 0) return;
  if (event.key in moves) reveal(Math.max(0, Math.min(last, moves[event.key])), true);
  else if (event.key === "Enter" || event.key === " ") select(table.order[row]);
  else return;
  event.preventDefault();
});
