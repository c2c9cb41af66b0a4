// Where the sessions went.

figure(() => {
  const place = byId("tracks");
  if (!place) return;
  const sessions = (experiment()?.sessions ?? []).filter((one) => one.truth && one.seeds.length);
  const boxes = sessions.map((one) => around([places(one.truth)]));
  const size = Math.max(1, ...boxes.map((box) => box.width), ...boxes.map((box) => box.height)) * 1.06;
  const width = 320, height = (Math.max(1, ...boxes.map((box) => box.height)) / size) * width + 50;
  place.replaceChildren(...sessions.map((one, index) => {
    const { x, y } = places(one.truth), box = boxes[index];
    const toScreen = (at) => [width / 2 + ((x[at] - box.x) / size) * width, (height - 26) / 2 - ((y[at] - box.y) / size) * width];
    const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Ground truth of session ${one.name}` });
    one.seeds[0].experiences.forEach((experience, number) => {
      const points = [];
      for (let at = experience.start; at < experience.end; at += 1) points.push(toScreen(at));
      drawing.append(svg("path", { d: path(points), fill: "none", stroke: experienceColour(number), "stroke-width": 1.6, "stroke-linejoin": "round" },
        svg("title", {}, experience.name)));
    });
    const [startX, startY] = toScreen(0), [endX, endY] = toScreen(x.length - 1);
    drawing.append(
      svg("circle", { cx: startX, cy: startY, r: 5, fill: colour("ink") }),
      svg("rect", { x: endX - 4.5, y: endY - 4.5, width: 9, height: 9, fill: colour("paper"), stroke: colour("ink"), "stroke-width": 2 }));
    const bar = roundUp(size / 12);
    drawing.append(
      svg("path", { class: "axis", d: `M12 ${height - 10}v4h${(bar / size) * width}v-4` }),
      svg("text", { x: 12, y: height - 14 }, `${short(bar)} m`));
    let length = 0;
    for (let at = 1; at < x.length; at += 1) length += Math.hypot(x[at] - x[at - 1], y[at] - y[at - 1]);
    return element("div", {}, element("h4", {}, one.name), drawing,
      element("div", { class: "counts" }, `${x.length} viewpoints, ${(length / 1000).toFixed(1)} km; ${page.axes[0]} to the right, ${page.axes[1]} upwards`));
  }));
});
