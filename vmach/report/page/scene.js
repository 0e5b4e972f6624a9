"use strict";

// The compressed block of the page: see payload.py for its layout.
async function readPayload(base64) {
  return unpackPayload(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)));
}

async function unpackPayload(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const headerLength = new DataView(bytes.buffer).getUint32(0, true);
  const data = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + headerLength)));
  const columns = {};
  let at = 4 + headerLength;
  for (const [name, width, count] of data.columns) {
    const column = new Int32Array(count);
    let value = 0;
    for (let i = 0; i < count; i++) {
      for (let plane = 0; plane < width; plane++)
        value += bytes[at + plane * count + i] << (8 * plane);
      column[i] = value = width === 2 ? value & 0xffff : value | 0;
    }
    columns[name] = column;
    at += width * count;
  }
  return { ...data, columns };
}

const signed16 = (value) => (value << 16) >> 16;

// Mesh and points with lengths in mm and deviations in um.
class Model {
  constructor(data) {
    Object.assign(this, data);
    const c = data.columns;
    this.vertices = this.positions("vertex");
    if (c.point_x) { // a page may ask elsewhere for what is at a place
      this.points = this.positions("point");
      this.pointNormals = this.interleave(["normal_x", "normal_y", "normal_z"], (v) => signed16(v) / 32767);
    }
    this.triangles = new Uint32Array(3 * c.corner_0.length);
    for (let i = 0; i < c.corner_0.length; i++)
      for (let k = 0; k < 3; k++) this.triangles[3 * i + k] = c["corner_" + k][i];
    this.normals = this.vertexNormals();
    this.outline = this.sharpEdges();
    this.faceWidth_mm = this.faceWidth();
    this.low = [0, 1, 2].map((k) => data.origin_mm[k]);
    this.high = [0, 1, 2].map((k) => data.origin_mm[k] + 65535 * data.step_mm[k]);
    this.centre = this.low.map((low, k) => (low + this.high[k]) / 2);
    this.radius = Math.hypot(...this.low.map((low, k) => this.high[k] - low)) / 2;
  }
  interleave(names, convert) {
    const columns = names.map((name) => this.columns[name]);
    const out = new Float32Array(columns.length * columns[0].length);
    columns.forEach((column, k) => {
      for (let i = 0; i < column.length; i++) out[columns.length * i + k] = convert(column[i], k);
    });
    return out;
  }
  positions(kind) {
    const names = ["x", "y", "z"].map((axis) => `${kind}_${axis}`);
    return this.interleave(names, (v, k) => this.origin_mm[k] + v * this.step_mm[k]);
  }
  deviation(column, i) { // um, or null
    const value = signed16(this.columns[column][i]);
    return value === this.unknown ? null : value * this.value_step_um;
  }
  vertexValues(variant) { // (deviation in um, known) of each vertex
    const count = this.vertices.length / 3, out = new Float32Array(2 * count);
    for (let i = 0; i < count; i++) {
      const value = this.deviation("vertex:" + variant, i);
      out[2 * i] = value ?? 0;
      out[2 * i + 1] = value === null ? 0 : 1;
    }
    return out;
  }
  vertexNormals() {
    const v = this.vertices, t = this.triangles, out = new Float32Array(v.length);
    for (let i = 0; i < t.length; i += 3) {
      const n = this.triangleNormal(i);
      for (let k = 0; k < 9; k++) out[3 * t[i + Math.floor(k / 3)] + (k % 3)] += n[k % 3];
    }
    for (let i = 0; i < out.length; i += 3) {
      const length = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
      for (let k = 0; k < 3; k++) out[i + k] /= length;
    }
    return out;
  }
  triangleNormal(i) { // length: twice the area
    const v = this.vertices, [a, b, c] = [0, 1, 2].map((k) => 3 * this.triangles[i + k]);
    const p = [0, 1, 2].map((k) => v[b + k] - v[a + k]), q = [0, 1, 2].map((k) => v[c + k] - v[a + k]);
    return cross(p, q);
  }
  sharpEdges() { // edges that one triangle alone has: vertices are not shared across sharp edges
    const t = this.triangles, count = this.vertices.length / 3, keys = new Float64Array(t.length);
    for (let i = 0; i < t.length; i++) {
      const a = t[i], b = t[i % 3 === 2 ? i - 2 : i + 1];
      keys[i] = Math.min(a, b) * count + Math.max(a, b);
    }
    keys.sort();
    const out = [];
    for (let i = 0; i < keys.length; i++)
      if (keys[i] !== keys[i - 1] && keys[i] !== keys[i + 1]) out.push(Math.floor(keys[i] / count), keys[i] % count);
    return new Uint32Array(out);
  }
  // How wide faces are, as one strip of the same area and outline would be.
  faceWidth() {
    const v = this.vertices, e = this.outline;
    let area = 0, length = 0;
    for (let i = 0; i < this.triangles.length; i += 3) area += Math.hypot(...this.triangleNormal(i)) / 2;
    for (let i = 0; i < e.length; i += 2) length += Math.hypot(...[0, 1, 2].map((k) => v[3 * e[i + 1] + k] - v[3 * e[i] + k]));
    return length > 0 ? (2 * area) / length : Infinity;
  }
  // The inspected point nearest to a place on the surface, on a face of the same direction.
  nearestPoint(place, normal) {
    let best = -1, smallest = Infinity;
    for (let i = 0; i < this.points.length; i += 3) {
      let distance = 0, cosine = 0;
      for (let k = 0; k < 3; k++) {
        distance += (this.points[i + k] - place[k]) ** 2;
        cosine += this.pointNormals[i + k] * normal[k];
      }
      if (cosine > 0.7 && distance < smallest) [best, smallest] = [i / 3, distance];
    }
    return best;
  }
}

const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];

const VERTEX_SHADER = `#version 300 es
in vec3 position; in vec3 normal; in vec2 value;
uniform mat3 axes; uniform vec3 centre; uniform vec3 scale; uniform bool outline;
out vec3 seenNormal; out vec2 deviation; out vec3 place;
void main() {
  seenNormal = axes * normal; deviation = value; place = position;
  gl_Position = vec4(axes * (position - centre) * scale, 1.0);
  if (outline) gl_Position.z -= 0.004; // lines in front of the faces that they bound
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 seenNormal; in vec2 deviation; in vec3 place;
uniform vec4 section; // what lies beyond this plane is cut away
uniform sampler2D ramp; uniform float range, tolerance; uniform vec3 unknownColour, lineColour;
uniform bool greyWithin, outline;
out vec4 colour;
void main() {
  if (dot(place, section.xyz) > section.w) discard;
  if (outline) { colour = vec4(lineColour, 1.0); return; }
  vec3 light = normalize(vec3(-0.35, 0.5, 0.8));
  float shade = 0.70 + 0.30 * clamp(dot(normalize(seenNormal), light), 0.0, 1.0);
  vec3 rgb = texture(ramp, vec2(0.5 + 0.5 * deviation.x / range, 0.5)).rgb;
  float beyond = abs(deviation.x) - tolerance;
  if (greyWithin && beyond <= 0.0) rgb = vec3(0.86);
  if (greyWithin) rgb *= 0.25 + 0.75 * smoothstep(0.4, 1.2, abs(beyond) / max(fwidth(deviation.x), 1e-12));
  if (deviation.y < 0.5) {
    float stripe = mod(gl_FragCoord.x + gl_FragCoord.y, 12.0);
    rgb = unknownColour * (stripe < 3.0 ? 0.82 : 1.0);
  }
  colour = vec4(rgb * shade, 1.0);
}`;

const NARROWEST_PX = 6; // of faces that are drawn with their outline: a line at each side takes a third of it

// A parallel view of the model; azimuth and elevation in rad, zoom 1 shows all of it.
class Scene {
  constructor(canvas, model, colourStops, unknownColour) {
    this.canvas = canvas; this.model = model;
    const gl = this.gl = canvas.getContext("webgl2", { antialias: false, alpha: true });
    if (!gl) throw new Error("WebGL 2 is not available");
    this.onDraw = () => {}; this.onSettle = () => {};
    this.look = { range: 1, tolerance: 1, greyWithin: false, section: [0, 0, 0, 0] };
    this.overlays = []; // each draws itself over the part
    this.program = this.link(VERTEX_SHADER, FRAGMENT_SHADER);
    this.buffers = {};
    this.measure();
    this.smooth = new SmoothPicture(gl);
    this.fill(model);
    this.loadRamp(colourStops);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    gl.uniform3fv(this.uniform("unknownColour"), rgbOf(unknownColour));
    gl.uniform3fv(this.uniform("lineColour"), [0.16, 0.18, 0.2]);
    this.home();
    new ResizeObserver(() => { this.measure(); this.redraw(); }).observe(canvas);
  }
  // Asked for once a size and not at every turn: the browser lays the page out anew whenever it is asked.
  measure() { Object.assign(this, { width: this.canvas.clientWidth, height: this.canvas.clientHeight }); }
  uniform(name) { return this.gl.getUniformLocation(this.program, name); }
  link(...sources) {
    const gl = this.gl, program = gl.createProgram();
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, i) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, sources[i]);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }
  buffer(kind, data, attribute, size) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(kind, buffer);
    gl.bufferData(kind, data, gl.STATIC_DRAW);
    if (attribute) {
      const location = gl.getAttribLocation(this.program, attribute);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, gl.FLOAT, false, 0, 0);
    }
    return buffer;
  }
  fill(model) {
    const gl = this.gl, kinds = { triangles: gl.ELEMENT_ARRAY_BUFFER, outline: gl.ELEMENT_ARRAY_BUFFER };
    const columns = { position: [model.vertices, 3], normal: [model.normals, 3],
      value: [new Float32Array(model.vertices.length / 3 * 2), 2], triangles: [model.triangles], outline: [model.outline] };
    gl.deleteBuffer(this.buffers.fewer ?? null);
    Object.assign(this, { fewer: null });
    for (const [name, [data, size]] of Object.entries(columns)) {
      gl.deleteBuffer(this.buffers[name] ?? null);
      this.buffers[name] = this.buffer(kinds[name] ?? gl.ARRAY_BUFFER, data, size && name, size);
    }
  }
  load(model) { // another part in the same view, seen as the one before unless its size is another
    const isAlike = Math.abs(model.radius / this.model.radius - 1) < 0.01;
    this.model = model;
    this.fill(model);
    if (isAlike) this.redraw(); else this.home();
  }
  loadRamp(stops) {
    const gl = this.gl, width = 256, rgb = stops.map(rgbOf), pixels = new Uint8Array(4 * width);
    for (let i = 0; i < width; i++) {
      const at = (i / (width - 1)) * (stops.length - 1), j = Math.min(Math.floor(at), stops.length - 2);
      for (let k = 0; k < 3; k++) pixels[4 * i + k] = 255 * (rgb[j][k] + (at - j) * (rgb[j + 1][k] - rgb[j][k]));
      pixels[4 * i + 3] = 255;
    }
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, width, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    for (const [key, value] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) gl.texParameteri(gl.TEXTURE_2D, key, value);
  }
  show(variant) { this.setValues(this.model.vertexValues(variant)); }
  setValues(pairs) { // (value, known) of each vertex
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers.value);
    gl.bufferData(gl.ARRAY_BUFFER, pairs, gl.STATIC_DRAW);
    this.redraw();
  }
  setLook(change) { Object.assign(this.look, change); this.redraw(); }
  home(azimuth = -0.938, elevation = 0.588) {
    Object.assign(this, { azimuth, elevation, zoom: 1, target: [...this.model.centre] });
    this.redraw();
  }
  axes() { // rows: right, up, towards the viewer
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    return [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
  }
  mmPerPixel() { // as large as possible with every corner of the box inside at zoom 1
    const [right, up] = this.axes(), half = this.model.high.map((high, k) => (high - this.model.low[k]) / 2);
    const extent = (axis) => axis.reduce((sum, x, k) => sum + Math.abs(x) * half[k], 0);
    return 1.08 * Math.max(extent(right) / (this.width / 2), extent(up) / (this.height / 2)) / this.zoom;
  }
  toScreen(place) { // CSS pixels from the top left, depth in mm towards the viewer
    const p = place.map((x, k) => x - this.target[k]), [right, up, towards] = this.axes(), mm = this.mmPerPixel();
    return [this.width / 2 + dot(p, right) / mm, this.height / 2 - dot(p, up) / mm, dot(p, towards)];
  }
  // Turn until nothing hides a point of the surface: from its own side, steeper while covered.
  face({ at, normal }) {
    const sideways = Math.abs(normal[2]) < 0.9 ? Math.atan2(normal[1], normal[0]) : -0.938;
    const side = normal[2] < -0.3 ? -1 : 1;
    for (const elevation of [0.5, 0.8, 1.1, 1.3]) for (const turn of [0.4, -0.4, 0]) {
      this.home(sideways + turn, side * elevation);
      if (this.sees(at)) return;
    }
  }
  sees(place) {
    const [x, y, depth] = this.toScreen(place), seen = this.pick(x, y);
    return !seen || seen.depth < depth + 0.01 * this.model.radius;
  }
  orbit(dx, dy) {
    this.azimuth -= 0.008 * dx;
    this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + 0.008 * dy));
    this.redraw();
  }
  pan(dx, dy) {
    const [right, up] = this.axes(), mm = this.mmPerPixel();
    this.target = this.target.map((x, k) => x - mm * (dx * right[k] - dy * up[k]));
    this.redraw();
  }
  zoomAt(factor, x, y) { // what is under (x, y) stays there
    const dx = x - this.width / 2, dy = y - this.height / 2;
    this.pan(-dx, -dy);
    this.zoom = Math.max(0.3, Math.min(200, this.zoom * factor));
    this.pan(dx, dy);
  }
  redraw() {
    this.stir();
    this.pending ??= requestAnimationFrame(() => {
      this.pending = null;
      if (this.smooth.isSlow) this.drawQuickly(); else this.draw();
    });
  }
  stir() { // something moves: it does not rest yet
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.settle(), this.smooth.isSlow ? 350 : 160);
  }
  settle() {
    if (this.isRough) requestAnimationFrame(() => this.draw());
    this.onSettle();
  }
  get isSeen() { return this.width > 0 && this.height > 0; }
  draw() {
    if (!this.isSeen) return;
    this.isRough = false;
    this.smooth.draw(...this.pixels(), () => this.paint("triangles", this.model.triangles.length));
    this.onDraw();
  }
  drawQuickly() {
    const gl = this.gl;
    if (!this.isSeen) return;
    this.isRough = true;
    if (!this.fewer) {
      this.fewer = fewerTriangles(this.model);
      this.buffers.fewer = this.buffer(gl.ELEMENT_ARRAY_BUFFER, this.fewer);
    }
    this.pixels();
    this.paint("fewer", this.fewer.length);
    this.onDraw();
  }
  pixels() { // of the canvas, which takes its size on the page
    const { canvas } = this, ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(this.width * ratio), height = Math.round(this.height * ratio);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    return [width, height];
  }
  paint(triangles, count) {
    const { gl, canvas, look } = this, mm = this.mmPerPixel(), [right, up, towards] = this.axes();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const depth = this.model.radius + Math.hypot(...this.target.map((x, k) => x - this.model.centre[k]));
    const camera = {
      axes: [0, 1, 2].flatMap((k) => [right[k], up[k], towards[k]]), centre: this.target,
      scale: [2 / (this.width * mm), 2 / (this.height * mm), -1 / depth],
    };
    this.aim(this.program, camera);
    gl.uniform1f(this.uniform("range"), look.range);
    gl.uniform1f(this.uniform("tolerance"), look.tolerance);
    gl.uniform1i(this.uniform("greyWithin"), look.greyWithin);
    gl.uniform4fv(this.uniform("section"), look.section);
    // lines around faces of a few pixels would hide their colours, as of the squares that stand for a part without CAD
    const lines = this.model.faceWidth_mm / mm < NARROWEST_PX ? 0 : this.model.outline.length;
    for (const [name, mode, isOutline, length] of [[triangles, gl.TRIANGLES, 0, count], ["outline", gl.LINES, 1, lines]]) {
      gl.uniform1i(this.uniform("outline"), isOutline);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers[name]);
      gl.drawElements(mode, length, gl.UNSIGNED_INT, 0);
    }
    for (const overlay of this.overlays) overlay.draw(this, camera);
  }
  aim(program, { axes, centre, scale }) {
    const gl = this.gl, at = (name) => gl.getUniformLocation(program, name);
    gl.uniformMatrix3fv(at("axes"), false, axes);
    gl.uniform3fv(at("centre"), centre);
    gl.uniform3fv(at("scale"), scale);
  }
  // The vertices turned into the view, and which triangles may lie under each cell of a grid over
  // it: many places are asked for in one view.
  turned() {
    const { model, azimuth, elevation } = this;
    if (this.kept?.model === model && this.kept.azimuth === azimuth && this.kept.elevation === elevation) return this.kept;
    const { vertices, triangles } = model, axes = this.axes(), flat = new Float32Array(vertices.length);
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (let i = 0; i < vertices.length; i += 3)
      for (let k = 0; k < 3; k++) {
        const [x, y, z] = axes[k], at = flat[i + k] = vertices[i] * x + vertices[i + 1] * y + vertices[i + 2] * z;
        if (k < 2) { if (at < low[k]) low[k] = at; if (at > high[k]) high[k] = at; }
      }
    const size = low.map((from, k) => Math.max(high[k] - from, 1e-9) / CELLS);
    const cell = (value, k) => Math.max(0, Math.min(CELLS - 1, Math.floor((value - low[k]) / size[k])));
    const first = new Uint32Array(CELLS * CELLS + 1);
    const visit = (work) => {
      for (let i = 0; i < triangles.length; i += 3) {
        const a = 3 * triangles[i], b = 3 * triangles[i + 1], c = 3 * triangles[i + 2];
        const left = cell(Math.min(flat[a], flat[b], flat[c]), 0), right = cell(Math.max(flat[a], flat[b], flat[c]), 0);
        const below = cell(Math.min(flat[a + 1], flat[b + 1], flat[c + 1]), 1), above = cell(Math.max(flat[a + 1], flat[b + 1], flat[c + 1]), 1);
        for (let x = left; x <= right; x++) for (let y = below; y <= above; y++) work(CELLS * x + y, i);
      }
    };
    visit((at) => { first[at + 1] += 1; });
    for (let at = 0; at < CELLS * CELLS; at++) first[at + 1] += first[at];
    const under = new Uint32Array(first[CELLS * CELLS]), next = first.slice();
    visit((at, i) => { under[next[at]++] = i; });
    return this.kept = { model, azimuth, elevation, flat, first, under, low, high, cell };
  }
  // What is seen at a pixel: place (mm), normal and depth, or null beside the part.
  pick(x, y) {
    const { triangles } = this.model, [right, up, towards] = this.axes(), mm = this.mmPerPixel();
    const px = dot(this.target, right) + (x - this.width / 2) * mm;
    const py = dot(this.target, up) - (y - this.height / 2) * mm;
    const { flat, first, under, low, high, cell } = this.turned();
    if (px < low[0] || px > high[0] || py < low[1] || py > high[1]) return null;
    let hit = null;
    const at = CELLS * cell(px, 0) + cell(py, 1);
    for (const i of under.subarray(first[at], first[at + 1])) {
      const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
      const [ax, ay, bx, by, cx, cy] = [flat[a] - px, flat[a + 1] - py, flat[b] - px, flat[b + 1] - py, flat[c] - px, flat[c + 1] - py];
      const u = bx * cy - cx * by, v = cx * ay - ax * cy, w = ax * by - bx * ay;
      if (u < 0 || v < 0 || w < 0 || u + v + w <= 0) continue;
      const depth = (u * flat[a + 2] + v * flat[b + 2] + w * flat[c + 2]) / (u + v + w);
      if (hit && depth <= hit.depth) continue;
      const place = [0, 1, 2].map((k) => px * right[k] + py * up[k] + depth * towards[k]);
      if (dot(place, this.look.section) <= this.look.section[3]) hit = { depth, i, place };
    }
    if (!hit) return null;
    const normal = this.model.triangleNormal(hit.i), length = Math.hypot(...normal) || 1;
    return { place: hit.place, normal: normal.map((n) => n / length), depth: hit.depth - dot(this.target, towards) };
  }
}

// Cells along each side of the grid in which a pick looks for triangles.
const CELLS = 96;

const rgbOf = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

// Azimuth and elevation of the standard views.
const QUARTER = Math.PI / 2;
const VIEWS = { overview: [], top: [-QUARTER, QUARTER], front: [-QUARTER, 0], right: [0, 0], back: [QUARTER, 0], below: [-QUARTER, -QUARTER] };
