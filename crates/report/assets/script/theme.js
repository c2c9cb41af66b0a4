// Colours. They live in the style sheet; canvases ask for them by name.

const root = document.documentElement;
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
let wanted = "automatic";

function applyTheme(forced) {
  root.dataset.theme = forced ?? (wanted === "automatic" ? (prefersDark.matches ? "dark" : "light") : wanted);
}

function colour(name) {
  return getComputedStyle(root).getPropertyValue(`--${name}`).trim();
}

const methodColours = { none: "method-none", pcm: "method-pcm", gc: "method-gc", "pcm+gc": "method-both", oracle: "method-oracle" };
const dashes = [null, [7, 3], [2, 3], [9, 3, 2, 3], [1, 2]];

/** Colour and dashes of a method, the same in every figure. */
function methodStyle(name, methods) {
  const known = methodColours[name];
  const others = methods.filter((method) => !methodColours[method]);
  const place = others.indexOf(name);
  return {
    colour: colour(known ?? `hue-${[4, 7, 8, 5, 2, 1, 3, 6][place % 8]}`),
    dash: known ? { none: [2, 3], pcm: [7, 3], gc: [9, 3, 2, 3] }[name] ?? null : dashes[(place + 1) % dashes.length],
    width: name === "pcm+gc" ? 2.4 : 1.8,
  };
}

function experienceColour(index) {
  return colour(["first", "second", "third", "fourth"][index % 4]);
}

// Viridis from light to dark: the larger the darker, and told apart in grey and by colour-blind readers.
const viridis = ["#fde725", "#b5de2b", "#6ece58", "#35b779", "#1f9e89", "#26828e", "#31688e", "#3e4989", "#482878", "#440154"];
// Blue for better, orange for worse; the middle is the ground.
const better = ["#f2f2f2", "#a6cbe3", "#4d95c4", "#0b5d99"];
const worse = ["#f2f2f2", "#f5c79b", "#e08a3c", "#a84a00"];

function along(stops, share) {
  const place = Math.max(0, Math.min(1, share)) * (stops.length - 1);
  const index = Math.min(stops.length - 2, Math.floor(place));
  const part = place - index;
  const channel = (stop, at) => parseInt(stop.slice(1 + 2 * at, 3 + 2 * at), 16);
  const mixed = [0, 1, 2].map((at) => Math.round(channel(stops[index], at) * (1 - part) + channel(stops[index + 1], at) * part));
  return { css: `rgb(${mixed.join(",")})`, dark: 0.299 * mixed[0] + 0.587 * mixed[1] + 0.114 * mixed[2] < 140 };
}
