// The trust benchmark: regret of every run, one panel a family, one lane a method.

if (byId("trust-regret")) {
  const trust = page.trust, linearBelow = 0.1, lane = 16, levels = 5, radius = 2.4;
  byId("trust-half").textContent = trust.half;

  /** log(1 + r / 0.1): 0 is on the axis. */
  const shareOf = (regret) => Math.log1p(regret / linearBelow) / Math.log1p(trust.top / linearBelow);
  const ticks = [0];
  for (let tick = linearBelow; tick <= trust.top * (1 + 1e-9); tick *= 10) ticks.push(tick);

  /** Dots that would coincide avoid each other across the lane; beyond five they are drawn once. */
  function spread(regrets) {
    const taken = new Map(), dots = [];
    const marked = ([, kept]) => kept > 0;
    for (const run of [...regrets].sort((one, other) => marked(other) - marked(one) || one[0] - other[0])) {
      const key = Math.round(shareOf(run[0]) * 80), level = taken.get(key) ?? 0;
      taken.set(key, level + 1);
      if (level >= levels) continue;
      const step = Math.ceil(level / 2) / Math.floor(levels / 2);
      dots.push({ regret: run[0], kept: run[1], across: level % 2 ? -step : step });
    }
    return dots.sort((one, other) => (one.kept > 0) - (other.kept > 0));
  }

  function panel(family) {
    const left = 6 + 6.8 * Math.max(...trust.methods.map((name) => name.length)), right = 82, width = 470;
    const inner = width - left - right, bottom = lane * trust.methods.length + 4;
    const at = (regret) => left + inner * shareOf(regret);
    const drawing = svg("svg", { viewBox: `0 0 ${width} ${bottom + 22}`, role: "img",
      "aria-label": `Regret of every run of ${family.name}: the table of the same name has its mean and its worst.` });
    for (const tick of ticks) {
      drawing.append(
        svg("line", { class: "grid", x1: at(tick), x2: at(tick), y1: 2, y2: bottom }),
        svg("text", { x: at(tick), y: bottom + 15, "text-anchor": "middle" }, short(tick)));
    }
    family.methods.forEach((method, index) => {
      const middle = 4 + lane * (index + 0.5), name = trust.methods[index];
      const runs = method.regrets.length + method.unfinished;
      drawing.append(
        svg("line", { class: "grid", x1: left, x2: left + inner, y1: middle, y2: middle }),
        svg("text", { x: left - 8, y: middle + 4, "text-anchor": "end" }, name));
      for (const dot of spread(method.regrets)) {
        const false_ = dot.kept > 0;
        drawing.append(svg("circle", {
          cx: at(dot.regret), cy: middle + dot.across * (lane / 2 - radius - 0.6), r: radius,
          fill: false_ ? colour("paper") : colour("first"), stroke: false_ ? colour("false") : "none", "stroke-width": 1.4,
        }, svg("title", {}, `${name}: regret ${metres(dot.regret)} m, ${false_ ? `${dot.kept} false kept` : "no false edge kept"}`)));
      }
      if (method.mean !== null) {
        drawing.append(svg("rect", { x: at(method.mean) - 1.2, y: middle - lane / 2 + 1, width: 2.4, height: lane - 2, fill: colour("ink") },
          svg("title", {}, `${name}: mean regret ${metres(method.mean)} m`)));
      }
      if (runs) drawing.append(svg("text", { x: left + inner + 44, y: middle + 4, "text-anchor": "end" }, wholePercent(method.within / runs)));
      if (method.unfinished) {
        const text = svg("text", { x: left + inner + 50, y: middle + 4 }, `× ${method.unfinished}`, svg("title", {}, `${method.unfinished} of ${runs} runs without a result`));
        text.style.fill = colour("false");
        drawing.append(text);
      }
    });
    return element("div", {}, element("h4", {}, family.name), drawing);
  }

  /** Whole percent, never rounded to all or nothing. */
  function wholePercent(share) {
    const percent = share <= 0 ? 0 : share >= 1 ? 100 : Math.min(99, Math.max(1, Math.round(100 * share)));
    return `${percent} %`;
  }

  figure(() => {
    legend(byId("trust-legend"), [
      [{ dot: true, colour: colour("first") }, "no false edge kept"],
      [{ ring: true, colour: colour("false") }, "a false edge kept"],
      [{ bar: true, colour: colour("ink") }, "mean of the finished runs"],
    ]);
    byId("trust-regret").replaceChildren(...trust.families.map(panel));
  });
}
