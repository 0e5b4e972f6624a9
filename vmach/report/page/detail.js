"use strict";

// How much detail is drawn. At rest: all triangles, with smooth edges. While the view turns or the colours change:
// fewer triangles and no smoothing, where a whole picture takes longer than people take for a movement.

const SLOW_MS = 40, SAMPLES = 4, QUICK_TRIANGLES = 9000;

// Fewer triangles over the same vertices. Vertices in one cell of a grid whose normals are alike become one of them;
// one of a sharp edge if there is any, so that faces go on meeting there.
function fewerTriangles(model) {
  const { vertices, normals, triangles, outline, low } = model;
  if (triangles.length <= 4 * QUICK_TRIANGLES) return triangles;
  const count = vertices.length / 3, isEdge = new Uint8Array(count), standsFor = new Uint32Array(count), best = new Map();
  for (const i of outline) isEdge[i] = 1;
  const every = 3 * 16; // the area by a sample
  let twiceArea = 0;
  for (let i = 0; i < triangles.length; i += every) twiceArea += (every / 3) * Math.hypot(...model.triangleNormal(i));
  const size = Math.sqrt(twiceArea / QUICK_TRIANGLES), cells = 2048, keys = new Float64Array(count), away = new Float32Array(count);
  for (let i = 0; i < count; i++) {
    let key = 0, distance = isEdge[i] ? 0 : 1e9;
    for (let k = 0; k < 3; k++) {
      const at = (vertices[3 * i + k] - low[k]) / size, cell = Math.floor(at);
      key = cells * key + cell;
      distance += (at - cell - 0.5) ** 2;
    }
    for (let k = 0; k < 3; k++) key = 3 * key + Math.round(normals[3 * i + k]) + 1;
    [keys[i], away[i]] = [key, distance];
    const known = best.get(key);
    if (known === undefined || distance < away[known]) best.set(key, i);
  }
  for (let i = 0; i < count; i++) standsFor[i] = best.get(keys[i]);
  const out = new Uint32Array(triangles.length);
  let next = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const a = standsFor[triangles[i]], b = standsFor[triangles[i + 1]], c = standsFor[triangles[i + 2]];
    if (a === b || b === c || c === a) continue;
    out[next++] = a; out[next++] = b; out[next++] = c;
  }
  return out.slice(0, next);
}

// Draws with smooth edges into a room of its own, and knows how long that took.
class SmoothPicture {
  constructor(gl) {
    this.gl = gl; this.took_ms = 0;
    this.frame = gl.createFramebuffer();
    this.parts = [[gl.COLOR_ATTACHMENT0, gl.RGBA8], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]].map(
      ([place, format]) => ({ place, format, buffer: gl.createRenderbuffer() }));
  }
  get isSlow() { return this.took_ms > SLOW_MS; }
  draw(width, height, work) {
    const { gl } = this, began = performance.now();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    if (this.width !== width || this.height !== height) this.resize(width, height);
    work();
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.frame);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.time(began);
  }
  resize(width, height) {
    const { gl } = this;
    Object.assign(this, { width, height });
    for (const { place, format, buffer } of this.parts) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES)), format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
  }
  time(began) { // nobody waits for it
    const { gl } = this, sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      if (gl.isContextLost()) return;
      if (gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) return setTimeout(look, 8);
      this.took_ms = performance.now() - began;
      gl.deleteSync(sync);
    };
    setTimeout(look, 0);
  }
}
