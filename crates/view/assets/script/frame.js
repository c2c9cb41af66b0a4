// Painting happens once a frame, when something asked for it.

let waiting = null, overlayOnly = true;

/** Asks for the map to be painted in the next frame. */
function repaint() {
  overlayOnly = false;
  waiting ??= requestAnimationFrame(paint);
}

/** Asks for the layer above alone: what is pointed at. */
function repaintOverlay() {
  waiting ??= requestAnimationFrame(paint);
}
