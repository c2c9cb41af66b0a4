// Scales of axes, their ticks, and numbers as text.

/** Metres with two decimals below ten and one above, as the tables have them. */
function metres(value) {
  return Math.abs(value) < 10 ? value.toFixed(2) : value.toFixed(1);
}

/** A number without digits that mean nothing. */
function short(value) {
  return String(Math.round(value * 1e6) / 1e6);
}

function percent(rate) {
  return `${short(rate * 100)} %`;
}

function linear(from, to, start, end) {
  const span = to - from || 1;
  const scale = (value) => start + ((value - from) / span) * (end - start);
  scale.invert = (place) => from + ((place - start) / (end - start)) * span;
  const rough = span / Math.max(2, Math.abs(end - start) / 90);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= rough);
  scale.ticks = [];
  for (let tick = Math.ceil(from / step) * step; tick <= to + step * 1e-9; tick += step) scale.ticks.push([tick, short(tick)]);
  return scale;
}

function logarithmic(from, to, start, end) {
  const low = Math.log10(from), high = Math.log10(to);
  const scale = (value) => start + ((Math.log10(Math.max(value, from)) - low) / (high - low || 1)) * (end - start);
  scale.invert = (place) => 10 ** (low + ((place - start) / (end - start)) * (high - low));
  scale.ticks = [];
  for (let power = Math.ceil(low - 1e-9); power <= high + 1e-9; power += 1) scale.ticks.push([10 ** power, short(10 ** power)]);
  return scale;
}

/** The next power of ten, or two or five of it, at or above a value. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= value * (1 - 1e-9));
}
