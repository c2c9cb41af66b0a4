/** Right and up coordinates of a track, metres; null without one. */
function places(track) {
  return track && { x: series(track.right, page.position_step), y: series(track.up, page.position_step) };
}

const page = JSON.parse(document.getElementById("data").textContent);
