"use strict";

// Pointer, wheel and keys turn, move and zoom a view; a click says where it was.
// `view` has orbit, pan, zoomAt and home, as a Scene has.
function listenToGestures(canvas, view, onClick) {
  const pointers = new Map();
  let travelled = 0;
  const spread = () => {
    const [p, q] = [...pointers.values()];
    return { x: (p.x + q.x) / 2, y: (p.y + q.y) / 2, size: Math.hypot(p.x - q.x, p.y - q.y) };
  };
  const here = (event) => ({ x: event.offsetX, y: event.offsetY });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, here(event));
    if (pointers.size === 1) travelled = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = here(event), dx = now.x - before.x, dy = now.y - before.y;
    travelled += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 2) {
      const old = spread();
      pointers.set(event.pointerId, now);
      const young = spread();
      view.pan(young.x - old.x, young.y - old.y);
      view.zoomAt(young.size / (old.size || 1), young.x, young.y);
      return;
    }
    pointers.set(event.pointerId, now);
    if (event.shiftKey || event.buttons > 1) view.pan(dx, dy);
    else view.orbit(dx, dy);
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => {
    const alone = pointers.size === 1;
    pointers.delete(event.pointerId);
    if (kind === "pointerup" && alone && travelled <= 5 && event.button === 0) onClick(event.offsetX, event.offsetY);
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    view.zoomAt(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
  }, { passive: false });
  const middle = () => [canvas.clientWidth / 2, canvas.clientHeight / 2];
  const keys = {
    ArrowLeft: () => view.orbit(-12, 0), ArrowRight: () => view.orbit(12, 0),
    ArrowUp: () => view.orbit(0, -12), ArrowDown: () => view.orbit(0, 12),
    "+": () => view.zoomAt(1.2, ...middle()), "-": () => view.zoomAt(1 / 1.2, ...middle()), 0: () => view.home(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
}

// The directions of the axes as the lines and letters of an SVG.
function triad(scene) {
  const [right, up] = scene.axes();
  return ["X", "Y", "Z"].map((name, k) => {
    const x = 34 * right[k], y = -34 * up[k];
    return `<line x1="0" y1="0" x2="${x}" y2="${y}"/><text x="${1.27 * x}" y="${1.27 * y}">${name}</text>`;
  }).join("");
}
