// Occupancy grids of laser logs before and after rejection, with the verdict on every candidate.

const verdicts = [
  { name: "r", text: "rejected", style: () => ({ colour: colour("rejected"), width: 1.2, dash: [5, 4] }) },
  { name: "u", text: "undecided", style: () => ({ colour: colour("undecided"), width: 1.6, dash: [2, 3] }) },
  { name: "a", text: "accepted", style: () => ({ colour: colour("kept"), width: 2 }) },
  { name: "f", text: "accepted, but incorrect", style: () => ({ colour: colour("false"), width: 3.2, dot: true }) },
];

/** Nodes, verdict, truth and reason of each candidate of a log. */
function candidatesOf(log) {
  const [from, to, reason] = ["from", "to", "reason"].map((name) => series(log.candidates[name], 1));
  return log.candidates.id.map((id, index) => {
    const truth = log.candidates.truth[index], verdict = log.candidates.verdict[index];
    return { id, from: from[index], to: to[index], verdict, truth, kind: verdict === "a" && truth === "f" ? "f" : verdict, reason: log.candidates.reasons[reason[index]] };
  });
}

/** Positions of the nodes of a map, metres. */
function placesOf(map) {
  return { x: series(map.track.right, page.map_step), y: series(map.track.up, page.map_step) };
}

/** A candidate in a sentence. */
function toldCandidate(one) {
  const verdict = verdicts.find((kind) => kind.name === one.verdict).text;
  const truth = { t: "; by its label it is correct", f: "; by its label it is incorrect", "?": "" }[one.truth];
  return `Candidate ${one.id}, keyframes ${one.from} and ${one.to}: ${verdict}${one.reason ? ` (${one.reason})` : ""}${truth}.`;
}

/** The picture of a map in a colour of its own: the file has opacities alone. */
class Ink {
  constructor(map, ready) {
    this.sheets = new Map();
    this.image = new Image();
    this.image.onload = ready;
    this.image.src = `data:image/png;base64,${map.picture}`;
  }
  /** The picture with one pixel for a square of cells, `side` along each side; null until it is decoded. */
  in(ink, side) {
    const { naturalWidth: width, naturalHeight: height, complete } = this.image;
    if (!complete || !width) return null;
    if (this.ink !== ink) this.sheets.clear();
    this.ink = ink;
    if (!this.sheets.has(side)) this.sheets.set(side, this.sheet(width, height, side));
    return this.sheets.get(side);
  }
  sheet(width, height, side) {
    const sheet = element("canvas", { width, height });
    const context = sheet.getContext("2d", { willReadFrequently: true });
    context.drawImage(this.image, 0, 0);
    const cells = context.getImageData(0, 0, width, height).data;
    [sheet.width, sheet.height] = [Math.ceil(width / side), Math.ceil(height / side)];
    // The mean of a square would dissolve its walls, which are one cell thick: the most opaque cell counts.
    const pixels = context.createImageData(sheet.width, sheet.height);
    for (let at = 3; at < cells.length; at += 4) {
      const cell = (at - 3) / 4, pixel = 4 * (Math.floor(Math.floor(cell / width) / side) * sheet.width + Math.floor((cell % width) / side)) + 3;
      pixels.data[pixel] = Math.max(pixels.data[pixel], cells[at]);
    }
    context.putImageData(pixels, 0, 0);
    context.globalCompositeOperation = "source-in";
    context.fillStyle = this.ink;
    context.fillRect(0, 0, sheet.width, sheet.height);
    return sheet;
  }
}

if (byId("maps-log")) {
  const shown = new Set(["way", ...verdicts.map((kind) => kind.name)]);
  const camera = new Camera();
  const sides = { before: "before", all_candidates: "all", after: "after" };
  const views = Object.entries(sides).map(([field, side]) => ({ field, side, map: new MapView(byId(`maps-${side}-map`), camera, "m") }));
  mapButtons(byId("maps-buttons"), camera);
  const pictures = new Map();
  let chosen = 0, drawn = null, candidates = [], pointed = null;

  const way = () => ({ colour: colour("third"), width: 1.3 });
  const countOf = (kind) => candidates.filter((one) => one.kind === kind.name).length;

  function drawLayers() {
    const kinds = [{ name: "way", text: "trajectory", style: way }, ...verdicts.filter((kind) => countOf(kind) || "ar".includes(kind.name))];
    byId("maps-layers").replaceChildren(...kinds.map((kind) => {
      const box = element("input", { type: "checkbox", id: `maps-layer-${kind.name}`, onchange: () => {
        if (box.checked) shown.add(kind.name);
        else shown.delete(kind.name);
        camera.paint();
      } });
      box.checked = shown.has(kind.name);
      return element("label", {}, box, swatch(kind.style()), kind.name === "way" ? kind.text : `${kind.text}: ${countOf(kind)}`);
    }));
  }

  function painter(log, map) {
    if (!pictures.has(map)) pictures.set(map, new Ink(map, () => camera.paint()));
    const track = placesOf(map);
    return (context, toScreen, scale) => {
      const cell = log.resolution * scale * (devicePixelRatio || 1);
      const side = cell < 0.3 ? 4 : cell < 0.6 ? 2 : 1;
      const sheet = pictures.get(map).in(colour("ink"), side);
      if (sheet) {
        // Cells are squares where they are large, and a smooth picture where they are small.
        context.imageSmoothingEnabled = cell < 3;
        context.imageSmoothingQuality = "high";
        const size = (pixels) => pixels * side * log.resolution * scale;
        context.drawImage(sheet, ...toScreen(map.corner[0], map.corner[1] + map.size[1]), size(sheet.width), size(sheet.height));
      }
      if (shown.has("way")) trace(context, toScreen, track, 0, track.x.length, way());
      const ends = (one) => [one.from, one.to].map((node) => toScreen(track.x[node], track.y[node]));
      for (const kind of verdicts.filter((one) => shown.has(one.name))) {
        const style = kind.style();
        // Hundreds of rejected candidates would hide the map.
        context.globalAlpha = kind.name === "r" ? Math.max(0.15, Math.min(1, 40 / countOf(kind))) : 1;
        for (const one of candidates) if (one.kind === kind.name) strokeEdge(context, ends(one), style);
      }
      context.globalAlpha = 1;
      if (pointed) strokeEdge(context, ends(pointed), { colour: colour("ink"), width: 3, dot: true });
    };
  }

  function pointer(map) {
    return (x, y, tolerance) => {
      const { x: right, y: up } = placesOf(map);
      let nearest = null, least = tolerance;
      for (const one of candidates.filter((candidate) => shown.has(candidate.kind))) {
        const away = distance(x, y, [right[one.from], up[one.from]], [right[one.to], up[one.to]]);
        if (away <= least) [nearest, least] = [one, away];
      }
      if (nearest === pointed) return;
      pointed = nearest;
      byId("maps-readout").textContent = pointed ? toldCandidate(pointed) : "Point at a candidate to see its details.";
      camera.paint();
    };
  }

  byId("maps-log").addEventListener("change", (event) => {
    chosen = Number(event.target.value);
    redraw();
  });

  figure(() => {
    const log = page.maps[chosen];
    if (drawn !== log) [drawn, candidates, pointed] = [log, candidatesOf(log), null];
    offer(byId("maps-log"), page.maps.map((one, index) => [index, one.name]), chosen);
    byId("maps-summary").textContent = `${candidates.length} candidates; cells of ${short(log.resolution)} m`;
    drawLayers();
    const corners = ({ corner: [x, y], size: [width, height] }) => ({ x: [x, x + width], y: [y, y + height] });
    // Beams of a map that is bent out of shape would make the others small: its trajectory is enough.
    camera.lookAt(around([corners(log.before), corners(log.after), log.all_candidates && placesOf(log.all_candidates)].filter(Boolean)));
    for (const { field, side, map } of views) {
      const own = log[field];
      byId(`maps-${side}`).hidden = !own;
      map.draw = own ? painter(log, own) : null;
      map.point = own ? pointer(own) : null;
      const counts = verdicts.map((kind) => `${countOf(kind)} ${kind.text}`).join(", ");
      byId(`maps-${side}-map`).setAttribute("aria-label", `${byId(`maps-${side}`).querySelector("h3").textContent}. Occupancy grid of ${log.name} with candidates: ${counts}.`);
      map.schedule();
    }
  });
}
