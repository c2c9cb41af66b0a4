// The filter by probability, with a histogram.

const bins = 24;

function probabilities() {
  const column = mapShown().column("verify_probability");
  return column?.numeric ? column.numbers : null;
}

when(["map", "probability"], () => {
  const values = probabilities();
  byId("probability").hidden = !values;
  if (!values) return;
  const counts = new Array(bins).fill(0), [low, high] = state.probability ?? [0, 1];
  let known = 0;
  for (const value of values) {
    if (value === null) continue;
    counts[Math.max(0, Math.min(bins - 1, Math.floor(value * bins)))] += 1;
    known += 1;
  }
  // Heights grow with the square root: most probabilities are near 0 or 1, and the others are of interest.
  const top = Math.sqrt(Math.max(1, ...counts)), width = 240 / bins;
  byId("histogram").replaceChildren(...counts.map((count, bin) => {
    const height = count ? Math.max(2, (Math.sqrt(count) / top) * 42) : 0, inside = (bin + 1) / bins > low && bin / bins < high;
    return svg("rect", { x: bin * width + 0.5, y: 44 - height, width: width - 1, height, class: inside ? "inside" : null },
      svg("title", {}, `${(bin / bins).toFixed(2)} to ${((bin + 1) / bins).toFixed(2)}: ${counted(count, "edge")}`));
  }));
  byId("histogram").setAttribute("aria-label", `Histogram of the probabilities of ${counted(known, "edge")}`);
  byId("low").value = low;
  byId("high").value = high;
  byId("range").textContent = state.probability ? `${low.toFixed(2)} to ${high.toFixed(2)}` : "all";
});

for (const name of ["low", "high"]) {
  byId(name).addEventListener("input", () => {
    let [low, high] = [Number(byId("low").value), Number(byId("high").value)];
    // The handle that moves pushes the other.
    if (low > high) [low, high] = name === "low" ? [low, low] : [high, high];
    change({ probability: low <= 0 && high >= 1 ? null : [low, high] });
  });
}
