const decoded = new Map();

function bytesOf(text) {
  const binary = atob(text);
  return Uint8Array.from(binary, (character) => character.charCodeAt(0));
}

/** Numbers of a series, rounded to `step` when it was written. */
function series(text, step = 1) {
  const known = decoded.get(text);
  if (known) return known;
  const values = [];
  let last = 0, rest = 0, factor = 1;
  for (const byte of bytesOf(text)) {
    rest += (byte & 0x7f) * factor;
    factor *= 128;
    if (byte < 0x80) {
      last += rest % 2 ? -(rest + 1) / 2 : rest / 2;
      values.push(last * step);
      rest = 0;
      factor = 1;
    }
  }
  const result = Float64Array.from(values);
  decoded.set(text, result);
  return result;
}

/** Truth values, eight a byte, lowest first. */
function bits(text) {
  const bytes = bytesOf(text);
  return (index) => ((bytes[index >> 3] >> (index & 7)) & 1) === 1;
}
