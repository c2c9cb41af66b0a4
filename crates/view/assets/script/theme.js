// Colours. They live in the style sheet; canvases ask for them by name.

const root = document.documentElement;
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const prefersStill = matchMedia("(prefers-reduced-motion: reduce)");
const palette = new Map();
let wanted = "automatic";

function applyTheme(forced) {
  palette.clear();
  root.dataset.theme = forced ?? (wanted === "automatic" ? (prefersDark.matches ? "dark" : "light") : wanted);
}

applyTheme();

function colour(name) {
  if (!palette.has(name)) palette.set(name, getComputedStyle(root).getPropertyValue(`--${name}`).trim());
  return palette.get(name);
}

/** The colour of a session's path: grey if there is one session only. */
function sessionColour(session) {
  return colour(sessions.length < 2 || session < 0 ? "path" : `path-${1 + (session % 8)}`);
}

const rejecting = { verify: 1, pcm: 2, multicut: 3 };
const rejectedDashes = [null, [2, 3], [6, 3], [6, 3, 2, 3], [1, 3], [9, 4]];

/** Colour, width and dashes of the edges of a state; `place` counts the states of rejection. */
function stateStyle(state, place) {
  switch (state.kind) {
    case "kept":
      return { colour: colour("kept"), width: 1.7, dash: state.name === "in use" ? null : [7, 4] };
    case "undecided":
      return { colour: colour("undecided"), width: 1.7, dash: state.name === "undecided (in use)" ? [8, 3] : [4, 3] };
    default: {
      const number = rejecting[state.name.replace("rejected by ", "")] ?? 1 + ((3 + place) % 5);
      return { colour: colour(`rejected-${number}`), width: 1.3, dash: rejectedDashes[number] };
    }
  }
}
