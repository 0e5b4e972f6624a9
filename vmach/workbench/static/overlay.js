// Lines over the part: the tool's path, the tool, and where it really is.

const VERTEX = `#version 300 es
in vec3 position; in vec4 colour;
uniform mat3 axes; uniform vec3 centre; uniform vec3 scale;
out vec4 shown;
void main() { shown = colour; gl_Position = vec4(axes * (position - centre) * scale, 1.0); gl_PointSize = 5.0; }`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec4 shown; out vec4 colour;
void main() { colour = vec4(shown.rgb * shown.a, shown.a); }`;

export class Overlay {
  constructor(scene) {
    const gl = scene.gl;
    this.program = scene.link(VERTEX, FRAGMENT);
    this.parts = []; // { mode, count, array }
    this.gl = gl;
    scene.overlays.push(this);
  }
  // Lines or points: places (x, y, z ...), one colour (r, g, b, a) each or one for all.
  part(mode, places, colours) {
    const gl = this.gl, count = places.length / 3, array = gl.createVertexArray();
    const full = colours.length === 4 ? Float32Array.from({ length: 4 * count }, (_, i) => colours[i % 4]) : colours;
    gl.bindVertexArray(array);
    for (const [name, data, size] of [["position", places, 3], ["colour", full, 4]]) {
      const at = gl.getAttribLocation(this.program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, Float32Array.from(data), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
    }
    gl.bindVertexArray(null);
    return { mode, count, array };
  }
  drop(part) { if (part) this.gl.deleteVertexArray(part.array); }
  draw(scene, camera) {
    const gl = this.gl, parts = this.parts.filter((part) => part && part.count > 0);
    if (!parts.length) return;
    gl.useProgram(this.program);
    scene.aim(this.program, camera);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    for (const part of parts) {
      gl.bindVertexArray(part.array);
      gl.drawArrays(part.mode, part.first ?? 0, part.count);
    }
    gl.bindVertexArray(null);
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(scene.program);
  }
}
