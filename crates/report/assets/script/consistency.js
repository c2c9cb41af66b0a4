// Which candidates of PCM agree with each other.

if (byId("consistency-map")) {
  const canvas = byId("consistency-map");
  const orders = [["clique", "clique first"], ["session", "along the first experience"], ["truth", "incorrect last"]];
  let order = "clique", shown = null, cursor = [0, 0];
  byId("consistency-order").addEventListener("change", (event) => {
    order = event.target.value;
    redraw();
  });

  /** The candidates with their pairs, and how to look a pair up. */
  function candidates(view) {
    const { edges, group, clique, pairs } = view.consistency;
    const count = edges.length, inClique = bits(clique), pair = bits(pairs);
    const consistent = (one, other) => {
      if (one === other) return true;
      const [row, column] = one < other ? [one, other] : [other, one];
      return pair(row * count - (row * (row + 1)) / 2 + column - row - 1);
    };
    const list = edges.map((edge, index) => ({
      index, group: group[index], kept: inClique(index), truth: view.edges.truth[edge], id: view.edges.id[edge], frames: view.edges.frames[edge],
    }));
    const kept = list.filter((one) => one.kept);
    for (const one of list) one.agrees = kept.reduce((sum, other) => sum + consistent(one.index, other.index), 0);
    const keys = {
      clique: (one) => [one.group, one.kept ? 0 : 1, one.kept ? Number(one.truth === "f") : -one.agrees, one.index],
      session: (one) => [one.group, one.index],
      truth: (one) => [one.group, one.truth === "f" ? 1 : 0, one.kept ? 0 : 1, one.index],
    };
    const key = keys[order];
    list.sort((one, other) => {
      const [first, second] = [key(one), key(other)];
      const place = first.findIndex((value, index) => value !== second[index]);
      return place < 0 ? 0 : first[place] - second[place];
    });
    return { list, consistent, kept };
  }

  function rgb(name) {
    const text = colour(name);
    return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
  }

  function paint() {
    const ratio = devicePixelRatio || 1, size = Math.round(canvas.clientWidth * ratio), strip = Math.round(9 * ratio);
    canvas.width = canvas.height = size;
    const context = canvas.getContext("2d");
    const { list, consistent } = shown, count = list.length, margin = 2 * strip + 6, side = size - margin;
    const image = new ImageData(count, count);
    const colours = { no: rgb("ground"), agree: rgb("agree"), clique: rgb("clique"), false: rgb("false") };
    list.forEach((one, row) => list.forEach((other, column) => {
      let which = "no";
      if (consistent(one.index, other.index)) {
        which = one.truth === "f" || other.truth === "f" ? "false" : one.kept && other.kept ? "clique" : "agree";
      }
      image.data.set([...colours[which], 255], 4 * (row * count + column));
    }));
    const small = new OffscreenCanvas(count, count);
    small.getContext("2d").putImageData(image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(small, margin, margin, side, side);
    list.forEach((one, at) => {
      const start = margin + (at * side) / count, length = side / count + 0.5;
      for (const [offset, paintIt, fill] of [[0, one.truth === "f", colour("false")], [strip + 2, one.kept, colour("clique")]]) {
        if (!paintIt) continue;
        context.fillStyle = fill;
        context.fillRect(start, offset, length, strip);
        context.fillRect(offset, start, strip, length);
      }
    });
    context.strokeStyle = colour("line");
    context.strokeRect(margin, margin, side - 1, side - 1);
    shown.margin = margin / ratio;
  }

  function read(row, column) {
    const one = shown?.list[row], other = shown?.list[column];
    if (!one || !other) return;
    const describe = (edge) => `edge ${edge.id} (frames ${edge.frames[0]} and ${edge.frames[1]}, ${edge.truth === "f" ? "incorrect" : edge.truth === "t" ? "correct" : "truth unknown"}, ${edge.kept ? "kept" : "rejected"})`;
    byId("consistency-readout").textContent = one === other ? `${describe(one)} agrees with ${one.agrees} of the clique.`
      : `${describe(one)} and ${describe(other)}: ${one.group !== other.group ? "of different pairs of sessions, not compared" : shown.consistent(one.index, other.index) ? "consistent" : "not consistent"}.`;
  }

  canvas.addEventListener("pointermove", (event) => {
    if (!shown) return;
    const box = canvas.getBoundingClientRect(), count = shown.list.length;
    const at = (place, start) => Math.floor(((place - start - shown.margin) / (box.width - shown.margin)) * count);
    read(at(event.clientY, box.top), at(event.clientX, box.left));
  });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    if (!step || !shown) return;
    event.preventDefault();
    cursor = cursor.map((value, index) => Math.max(0, Math.min(shown.list.length - 1, value + step[index])));
    read(...cursor);
  });

  figure(() => {
    const view = seed();
    offer(byId("consistency-order"), orders, order);
    shown = view?.consistency ? candidates(view) : null;
    canvas.hidden = !shown;
    byId("consistency-legend").hidden = !shown;
    if (!shown) {
      byId("consistency-summary").textContent = "PCM has processed no graph of this selection, or the graph has too many candidates for this page.";
      return;
    }
    const { list, kept } = shown, wrong = list.filter((one) => one.truth === "f"), through = wrong.filter((one) => one.kept);
    const summary = `${list.length} candidates, ${kept.length} kept; ${wrong.length} incorrect, ${through.length} of them kept; gate ${view.consistency.gate} (${view.consistency.method})`;
    byId("consistency-summary").textContent = summary;
    canvas.setAttribute("aria-label", `Consistency matrix: ${summary}.`);
    legend(byId("consistency-legend"), [
      [{ fill: colour("clique") }, "consistent, both kept"], [{ fill: colour("agree") }, "consistent, not both kept"],
      [{ fill: colour("false") }, "consistent, at least one incorrect"], [{ fill: colour("ground"), outline: colour("line") }, "not consistent"],
    ]);
    paint();
  });
}
