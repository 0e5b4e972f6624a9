// Playback: the tool along the program, and how far off it is, magnified.

import { attempt, bench } from "./bench.js";
import { framed } from "./api.js";
import { byId, clock, el, fixed, signed } from "./dom.js";
import { follow } from "./program.js";
import { stage } from "./stage.js";

const SPEEDS = [1, 10, 60, 300], SIDES = 36, TRAIL = 600; // nodes of the path behind the tool
const player = { data: null, at: 0, isPlaying: false, speed: 60, parts: [] };
const C = { time: 0, x: 1, dx: 4, line: 7, tool: 8, feed: 9, rpm: 10 };

export function listenToPlayer() {
  const play = el("button", { type: "button", id: "play", title: "Play the program" }, "▶ Play");
  const slider = el("input", { type: "range", min: 0, max: 1000, value: 0, id: "time", "aria-label": "Time of the program" });
  const speed = el("select", { "aria-label": "Speed of playback" }, SPEEDS.map((s) => el("option", { value: s, selected: s === player.speed }, `${s}×`)));
  const close = el("button", { type: "button", title: "Leave the playback", hidden: true }, "×");
  const text = el("p", { class: "telling", id: "telling" }, "");
  byId("player").replaceChildren(play, slider, speed, close, text);
  Object.assign(player, { play, slider, close, text });
  play.onclick = attempt(async () => { await open(); player.isPlaying ? pause() : run(); });
  slider.oninput = attempt(async () => {
    await open();
    pause();
    seek((Number(slider.value) / 1000) * player.facts.duration_s);
  });
  speed.onchange = () => { player.speed = Number(speed.value); };
  close.onclick = leave;
  bench.on("part", leave);
  bench.on("shown", marks);
}

async function open() {
  if (player.data) return;
  const [facts, data] = await framed("/api/playback");
  Object.assign(player, { facts, data });
  player.close.hidden = false;
  drawPath();
  marks();
}

function leave() {
  pause();
  const { overlay } = stage;
  if (overlay) {
    player.parts.forEach((part) => overlay.drop(part));
    overlay.parts = overlay.parts.filter((part) => !player.parts.includes(part));
    stage.scene.redraw();
  }
  Object.assign(player, { data: null, parts: [], at: 0 });
  player.close.hidden = true;
  player.slider.value = 0;
  player.text.textContent = "";
}

const row = (i) => 11 * i;
const count = () => player.facts.count;

// The path as line pieces, the strip of colours from small to large errors; rapid moves pale.
function drawPath() {
  const { data, facts } = player, pieces = Math.max(0, count() - 1), places = new Float32Array(6 * pieces), colours = new Float32Array(8 * pieces);
  for (let i = 0; i < pieces; i++) for (const end of [0, 1]) {
    const r = row(i + end), size = Math.hypot(data[r + 4], data[r + 5], data[r + 6]) / (facts.largest_um || 1);
    places.set(data.subarray(r + C.x, r + C.x + 3), 6 * i + 3 * end);
    const rapid = data[row(i + 1) + C.feed] === 0;
    colours.set(rapid ? [0.5, 0.5, 0.55, 0.25] : [0.15 + 0.65 * size, 0.35, 0.75 - 0.6 * size, 0.85], 8 * i + 4 * end);
  }
  player.path = stage.overlay.part(stage.scene.gl.LINES, places, colours);
  player.parts = [player.path];
  stage.overlay.parts.push(player.path);
}

function run() {
  if (player.at >= player.facts.duration_s) player.at = 0;
  player.isPlaying = true;
  player.play.textContent = "❚❚ Pause";
  let last = performance.now();
  const step = (now) => {
    if (!player.isPlaying) return;
    seek(player.at + (player.speed * Math.min(now - last, 200)) / 1000);
    last = now;
    if (player.at >= player.facts.duration_s) return pause();
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function pause() {
  player.isPlaying = false;
  player.play.textContent = "▶ Play";
}

// The last node at or before a time, by halves.
function nodeAt(seconds) {
  let low = 0, high = count() - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (player.data[row(middle)] <= seconds) low = middle; else high = middle - 1;
  }
  return low;
}

function seek(seconds) {
  const { data, facts } = player;
  player.at = Math.max(0, Math.min(facts.duration_s, seconds));
  player.slider.value = (1000 * player.at) / (facts.duration_s || 1);
  const i = nodeAt(player.at), j = Math.min(i + 1, count() - 1), from = data[row(i)], span = data[row(j)] - from;
  const share = span > 0 ? Math.min(1, (player.at - from) / span) : 0;
  const mix = (k) => data[row(i) + k] + share * (data[row(j) + k] - data[row(i) + k]);
  const tip = [0, 1, 2].map((k) => mix(C.x + k)), error = [0, 1, 2].map((k) => mix(C.dx + k));
  const first = Math.max(0, i - TRAIL);
  Object.assign(player.path, { first: 2 * first, count: Math.max(2, 2 * (i - first)) });
  drawTool(tip, error, data[row(j) + C.tool]);
  follow(data[row(j) + C.line]);
  const zero = facts.zero_mm, length = facts.tools[data[row(j) + C.tool]]?.length_mm ?? 0;
  const axes = tip.map((x, k) => x + zero[k] + (k === 2 ? length : 0));
  player.text.replaceChildren(
    el("b", {}, clock(player.at)), ` / ${clock(facts.duration_s)} · line ${data[row(j) + C.line]} · T${data[row(j) + C.tool]} · `,
    axes.map((x, k) => `${"XYZ"[k]} ${fixed(x, 1)}`).join(" "), " · error ",
    el("b", {}, error.map((x) => signed(x, 1)).join(", ")), " µm · ",
    data[row(j) + C.feed] ? `F ${Math.round(data[row(j) + C.feed])}` : "rapid", ` · S ${Math.round(data[row(j) + C.rpm])}`);
}

// The tool where it should be, pale, and where it is, with the error so much larger that it shows.
function drawTool(tip, error, number) {
  const { scene, overlay } = stage, tool = player.facts.tools[number] ?? { diameter_mm: 6 };
  const radius = tool.diameter_mm / 2, height = Math.min(60, 3 * tool.diameter_mm + 20);
  const scale = (0.12 * scene.model.radius) / (player.facts.largest_um || 1); // mm of the picture a µm
  const real = tip.map((x, k) => x + scale * error[k]);
  const outline = (at) => {
    const lines = [];
    for (let s = 0; s < SIDES; s++) {
      const [a, b] = [s, s + 1].map((n) => (2 * Math.PI * n) / SIDES), ring = (angle, z) => [at[0] + radius * Math.cos(angle), at[1] + radius * Math.sin(angle), at[2] + z];
      lines.push(...ring(a, 0), ...ring(b, 0), ...ring(a, height), ...ring(b, height));
      if (s % 9 === 0) lines.push(...ring(a, 0), ...ring(a, height));
    }
    return lines;
  };
  const parts = [
    overlay.part(scene.gl.LINES, outline(tip), [0.45, 0.5, 0.55, 0.6]),
    overlay.part(scene.gl.LINES, outline(real), [0.76, 0.29, 0.12, 1]),
    overlay.part(scene.gl.LINES, [...tip, ...real], [0.95, 0.75, 0.1, 1]),
  ];
  const old = player.parts.slice(1, 4);
  old.forEach((part) => overlay.drop(part));
  player.parts = [player.path, ...parts, ...player.parts.slice(4)];
  overlay.parts = [...overlay.parts.filter((part) => !old.includes(part)), ...parts];
  scene.redraw();
}

// Collisions that the report found stand as marks beside the slider of time.
function marks() {
  const found = bench.state.shown?.report?.collisions ?? [];
  player.slider.title = found.length ? found.map((one) => one.text).join("\n") : "";
  player.play.classList.toggle("collides", found.length > 0);
}
