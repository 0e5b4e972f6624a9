// The NC text: only the lines in sight are in the page, so that a long program scrolls as a short one.

import { attempt, bench } from "./bench.js";
import { framed, get } from "./api.js";
import { byId, el, redraw, signed } from "./dom.js";
import { stage } from "./stage.js";

const ROW = 20, LOT = 400, AGAIN_MS = 2000;
const text = { lines: [], total: 0, loading: new Set(), selected: 0 };
let highlight = null;

export function openProgram() {
  Object.assign(text, { lines: [], total: bench.about.lines, loading: new Set(), selected: 0 });
  byId("program-name").textContent = bench.about.program;
  byId("program-size").textContent = `${bench.about.lines} lines`;
  byId("lines-sheet").style.height = ROW * text.total + "px";
  byId("line-foot").textContent = "A click shows what a line makes.";
  byId("lines").scrollTop = 0;
  draw();
}

export function listenToProgram() {
  const view = byId("lines");
  view.addEventListener("scroll", () => requestAnimationFrame(draw));
  new ResizeObserver(draw).observe(view);
  view.addEventListener("click", (event) => {
    const row = event.target.closest("[data-line]");
    if (row) showLine(Number(row.dataset.line));
  });
  view.addEventListener("keydown", (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 20, PageUp: -20 }[event.key];
    if (!step) return;
    event.preventDefault();
    showLine(Math.max(1, Math.min(text.total, (text.selected || 1) + step)), true);
  });
  bench.on("point", (point) => {
    if (point?.line > 0) follow(point.line);
  });
}

// Bring a line into sight and mark it.
export function follow(line) {
  if (line < 1 || line > text.total) return;
  text.selected = line;
  const view = byId("lines"), top = ROW * (line - 1);
  if (top < view.scrollTop + ROW || top > view.scrollTop + view.clientHeight - 2 * ROW)
    view.scrollTop = top - view.clientHeight / 2;
  draw();
}

const showLine = attempt(async (line, isFollowed = false) => {
  text.selected = line;
  if (isFollowed) follow(line);
  draw();
  const [made, places] = await framed("/api/line?line=" + line);
  if (text.selected !== line) return;
  mark(places);
  byId("line-foot").textContent = made.count
    ? `Line ${line} makes ${made.count} points of ${made.features.slice(0, 2).join(", ")}${made.features.length > 2 ? " …" : ""}: ${signed(made.low_um)} to ${signed(made.high_um)} µm`
    : `Line ${line} makes no inspected point.`;
  bench.tell("line", line);
});

function mark(places) {
  const { overlay, scene } = stage;
  if (!overlay) return;
  overlay.drop(highlight);
  overlay.parts = overlay.parts.filter((part) => part !== highlight);
  highlight = places.length ? overlay.part(scene.gl.POINTS, places, [0.98, 0.86, 0.1, 1]) : null;
  if (highlight) overlay.parts.push(highlight);
  scene.redraw();
}

export function clearMark() {
  if (stage.overlay && highlight) mark([]);
}

function draw() {
  const view = byId("lines"), sheet = byId("lines-sheet");
  if (!text.total) return redraw(sheet, []);
  const first = Math.max(0, Math.floor(view.scrollTop / ROW) - 5);
  const last = Math.min(text.total, Math.ceil((view.scrollTop + view.clientHeight) / ROW) + 5);
  for (let lot = Math.floor(first / LOT); lot <= Math.floor(Math.max(last - 1, 0) / LOT); lot++) load(lot);
  const rows = [];
  for (let i = first; i < last; i++) {
    const row = el("div", { class: "line" + (i + 1 === text.selected ? " selected" : "") },
      el("span", { class: "number" }, String(i + 1)), el("span", { class: "text" }, text.lines[i] ?? ""));
    row.setAttribute("role", "option");
    row.setAttribute("aria-selected", String(i + 1 === text.selected));
    row.dataset.line = i + 1;
    row.style.top = ROW * i + "px";
    rows.push(row);
  }
  redraw(sheet, rows);
}

const load = attempt(async (lot) => {
  if (text.loading.has(lot)) return;
  const { loading } = text;
  loading.add(lot);
  let found;
  try {
    found = await get(`/api/program?first=${lot * LOT + 1}&count=${LOT}`);
  } catch (error) {
    setTimeout(() => { loading.delete(lot); draw(); }, AGAIN_MS); // as long as it is in sight
    throw error;
  }
  if (loading !== text.loading) return; // another program since
  found.lines.forEach((line, i) => { text.lines[lot * LOT + i] = line; });
  draw();
});
