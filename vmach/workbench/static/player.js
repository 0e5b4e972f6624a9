// Playback: the tool along the program, and how far off it is, magnified.

import { attempt, bench, isAtWork, once } from "./bench.js";
import { framed } from "./api.js";
import { byId, clock, el, fixed, redraw, signed, svg } from "./dom.js";
import { follow } from "./program.js";
import { startRun } from "./runs.js";
import { needPicture, stage } from "./stage.js";

const SPEEDS = [1, 10, 60, 300], SIDES = 36, TRAIL = 600; // nodes of the path behind the tool
const CHART = { width: 1000, height: 44, steps: 500 }, MOST_HITS = 4;
const player = { data: null, at: 0, isPlaying: false, speed: 60, parts: [] };
const C = { time: 0, x: 1, dx: 4, line: 7, tool: 8, feed: 9, rpm: 10, warmth: 11 }; // columns of a node

export function listenToPlayer() {
  const play = el("button", { type: "button", id: "play", title: "Play the program" }, "▶ Play");
  const slider = el("input", { type: "range", min: 0, max: 1000, value: 0, id: "time", "aria-label": "Time of the program" });
  const speed = el("select", { "aria-label": "Speed of playback" }, SPEEDS.map((s) => el("option", { value: s, selected: s === player.speed }, `${s}×`)));
  const close = el("button", { type: "button", title: "Leave the playback", hidden: true }, "×");
  const text = el("p", { class: "telling", id: "telling" }, ""), states = el("p", { class: "states", id: "states", hidden: true });
  const chart = svg("svg", { class: "course", viewBox: `0 0 ${CHART.width} ${CHART.height}`, preserveAspectRatio: "none", hidden: "", role: "img",
    "aria-label": "Speed of the spindle, and warmth of spindle and axes, over the time of the program" });
  const hits = el("p", { class: "hits", id: "hits", hidden: true });
  byId("player").replaceChildren(play, slider, speed, close, chart, states, hits, text);
  Object.assign(player, { play, slider, close, text, states, chart, hits });
  play.onclick = once(async () => { await open(); player.isPlaying ? pause() : run(); });
  slider.oninput = attempt(async () => {
    await open();
    pause();
    seek((Number(slider.value) / 1000) * player.facts.duration_s);
  });
  speed.onchange = () => { player.speed = Number(speed.value); };
  close.onclick = leave;
  bench.on("part", leave);
  bench.on("shown", showHits);
  bench.on("run", ({ kind }) => { if (kind === "collisions") showHits(); });
}

// Asked for once, however often it is clicked meanwhile.
function open() {
  if (player.data) return null;
  player.opening ??= load().finally(() => { player.opening = null; });
  return player.opening;
}

async function load() {
  needPicture();
  const { revision } = bench.state;
  const [facts, data] = await framed("/api/playback");
  if (revision !== bench.state.revision) throw new Error("The job was read anew; play it again.");
  Object.assign(player, { facts, data });
  for (const one of [player.close, player.states, player.hits]) one.hidden = false;
  player.chart.removeAttribute("hidden");
  drawPath();
  drawCourse();
  showHits();
  if (bench.about.has_blank && !found() && !isAtWork("collisions")) startRun("/api/collisions");
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
  for (const one of [player.close, player.states, player.hits]) one.hidden = true;
  player.chart.setAttribute("hidden", "");
  player.slider.value = 0;
  player.text.textContent = "";
}

const row = (i) => player.facts.columns.length * i;
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
  const share = span > 0 ? Math.max(0, Math.min(1, (player.at - from) / span)) : 0; // before the first node: as there
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
    data[row(j) + C.feed] ? `F ${Math.round(data[row(j) + C.feed])}` : "rapid");
  showStates(mix);
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

// ---- what goes on beside the tool: speed of the spindle, warmth, collisions

// The course of the speed as an area, of every warmth as a line, over the time of the program.
function drawCourse() {
  const { data, facts } = player, { width, height, steps } = CHART, nodes = Array.from({ length: steps + 1 }, (_, k) => nodeAt((k / steps) * facts.duration_s));
  const course = (column) => nodes.map((i) => data[row(i) + column]), most = (values) => values.reduce((a, b) => Math.max(a, Math.abs(b)), 0);
  const speeds = course(C.rpm).map(Math.abs), warmths = facts.bodies.map((_, k) => course(C.warmth + k)), top = Math.max(1e-9, ...warmths.map(most));
  const points = (values, end) => values.map((v, k) => `${(k / steps) * width},${height - 2 - ((height - 6) * v) / end}`).join(" ");
  player.chart.replaceChildren(
    svg("polygon", { class: "speed", points: `0,${height} ${points(speeds, most(speeds) || 1)} ${width},${height}` }),
    ...warmths.map((values, k) => svg("polyline", { class: "warmth body-" + k, points: points(values, top) })),
    ...(found() ?? []).map((hit) => svg("line", { class: "hit", x1: x(hit.time_s), x2: x(hit.time_s), y1: 0, y2: height })),
    svg("line", { class: "now", x1: x(player.at), x2: x(player.at), y1: 0, y2: height }));
}

const x = (seconds) => (CHART.width * seconds) / (player.facts.duration_s || 1);

function showStates(mix) {
  const now = player.chart.lastChild;
  for (const name of ["x1", "x2"]) now.setAttribute(name, x(player.at));
  redraw(player.states, [el("span", { title: "Speed of the spindle" }, el("i", { class: "key" }), `S ${Math.round(Math.abs(mix(C.rpm)))} 1/min`),
    ...player.facts.bodies.map((body, k) => el("span", { title: `100 %: ${body.reference}. Time constant ${Math.round(body.time_constant_s)} s, ${body.is_of_job ? "of the job" : "a usual one"}` },
      svg("svg", { viewBox: "0 0 26 6", "aria-hidden": "true" }, svg("line", { class: "body-" + k, x1: 0, x2: 26, y1: 3, y2: 3 })), `${body.name} ${fixed(100 * mix(C.warmth + k), 1)} %`)), el("span", { class: "soft" }, "warm")]);
}

const found = () => bench.state.shown?.collisions?.found;

// Collisions stand in the course, and as buttons that lead there.
function showHits() {
  player.play.classList.toggle("collides", Boolean(found()?.length));
  if (!player.data) return;
  drawCourse();
  const hits = found();
  if (!hits) return redraw(player.hits, [el("span", { class: "soft" }, isAtWork("collisions") ? "Looking for collisions …" : bench.about.has_blank ? "" : "No blank, so no collisions are looked for.")]);
  redraw(player.hits, hits.length ? [...hits.slice(0, MOST_HITS).map((hit) => {
    const button = el("button", { type: "button", class: "hit" }, `⚠ line ${hit.line}: ${hit.kind}, ${fixed(hit.depth_mm, 1)} mm`);
    button.onclick = () => { pause(); seek(hit.time_s); };
    return button;
  }), hits.length > MOST_HITS ? el("span", { class: "soft" }, `and ${hits.length - MOST_HITS} more`) : null] : [el("span", { class: "soft" }, "No collision.")]);
}
