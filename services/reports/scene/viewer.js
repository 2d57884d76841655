// A kitchen, robots and their motions in WebGL 2. Reads the JSON beside it and loads nothing.
(() => {
  "use strict";
  const figure = document.currentScript.closest("figure");
  const data = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
  const stage = figure.querySelector(".sdt-stage");

  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const floats = (text) => new Float32Array(bytes(text));
  const make = (tag, parent, properties = {}) => parent.appendChild(Object.assign(document.createElement(tag), properties));

  // Matrices are column-major, as WebGL has them.
  const product = (a, b) => {
    const c = new Float32Array(16);
    for (let i = 0; i < 4; i++)
      for (let j = 0; j < 4; j++)
        for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    return c;
  };
  const identity = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  const minus = (a, b) => a.map((x, i) => x - b[i]);
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = (a) => { const n = Math.hypot(...a) || 1; return a.map((x) => x / n); };

  const trees = data.trees.map((tree) => {
    const rows = floats(tree.placements), placements = [];
    for (let i = 0; i < tree.joints.length; i++) {
      const p = rows.subarray(12 * i, 12 * i + 12);
      placements.push(new Float32Array([p[0], p[4], p[8], 0, p[1], p[5], p[9], 0, p[2], p[6], p[10], 0, p[3], p[7], p[11], 1]));
    }
    return { ...tree, placements, axes: floats(tree.axes), rest: floats(tree.rest), index: new Map(tree.joints.map((name, i) => [name, i])) };
  });
  const clips = data.clips.map((clip) => ({ ...clip, times: floats(clip.times), values: floats(clip.values) }));

  function motion(tree, joint, q) {
    const [x, y, z] = tree.axes.subarray(3 * joint, 3 * joint + 3);
    if (tree.slides[joint]) return new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, q * x, q * y, q * z, 1]);
    const s = Math.sin(q), c = Math.cos(q), d = 1 - c;
    return new Float32Array([
      c + d * x * x, s * z + d * x * y, -s * y + d * x * z, 0, -s * z + d * x * y, c + d * y * y, s * x + d * y * z, 0,
      s * y + d * x * z, -s * x + d * y * z, c + d * z * z, 0, 0, 0, 0, 1]);
  }
  function positions(clip, tree, time) {
    const q = tree.rest.slice(), times = clip.times, n = clip.joints.length;
    let k = 0;
    while (k + 2 < times.length && times[k + 1] <= time) k++;
    const next = Math.min(k + 1, times.length - 1), span = times[next] - times[k];
    const u = span > 0 ? Math.min(1, Math.max(0, (time - times[k]) / span)) : 0;
    clip.joints.forEach((name, j) => {
      const i = tree.index.get(name);
      if (i !== undefined) q[i] = (1 - u) * clip.values[k * n + j] + u * clip.values[next * n + j];
    });
    return q;
  }
  function frames(tree, q) {
    const found = [];
    tree.parents.forEach((parent, i) => {
      const here = product(tree.placements[i], motion(tree, i, q[i]));
      found.push(parent < 0 ? here : product(found[parent], here));
    });
    return found;
  }

  // What people see and touch.
  const canvas = make("canvas", stage, { tabIndex: 0 });
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${data.title}. Drag or use the arrow keys to turn, + and - to zoom, space to play.`);
  const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    stage.textContent = "This browser has no WebGL 2, which the 3D view needs; figures and tables are complete without it.";
    return;
  }
  const key = make("p", stage, { className: "sdt-key" });
  const bar = make("div", stage, { className: "sdt-bar" });
  const choice = make("select", bar), play = make("button", bar, { type: "button", textContent: "Play" });
  choice.setAttribute("aria-label", "Motion");
  clips.forEach((clip, i) => make("option", choice, { value: i, textContent: clip.name }));
  choice.hidden = clips.length < 2;
  const slider = make("input", bar, { type: "range", min: 0, max: 1000, value: 1000 });
  slider.setAttribute("aria-label", "Time");
  const label = make("span", bar, { className: "sdt-time" });
  const speed = make("select", bar);
  speed.setAttribute("aria-label", "Speed");
  [1, 2, 4, 8].forEach((x) => make("option", speed, { value: x, textContent: `× ${x}`, selected: x === 4 }));
  const home = make("button", bar, { type: "button", textContent: "Whole view" });
  const note = make("div", stage, { className: "sdt-note" });
  note.setAttribute("aria-live", "polite");

  // WebGL.
  const shader = (kind, source) => { const s = gl.createShader(kind); gl.shaderSource(s, source); gl.compileShader(s); return s; };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `#version 300 es
    in vec3 point; uniform mat4 screen, place; out vec3 world;
    void main() { vec4 p = place * vec4(point, 1.0); world = p.xyz; gl_Position = screen * p; }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `#version 300 es
    precision highp float; in vec3 world; uniform vec4 color; uniform float lit; out vec4 shown;
    void main() {
      vec3 n = normalize(cross(dFdx(world), dFdy(world)));
      float light = 0.64 + 0.20 * abs(dot(n, vec3(0.36, 0.48, 0.80))) + 0.16 * abs(n.z);
      shown = vec4(color.rgb * mix(1.0, light, lit), color.a);
    }`));
  gl.linkProgram(program);
  gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const uniforms = { screen: at("screen"), place: at("place"), color: at("color"), lit: at("lit") };
  const point = gl.getAttribLocation(program, "point");
  const buffer = (kind, array) => { const b = gl.createBuffer(); gl.bindBuffer(kind, b); gl.bufferData(kind, array, gl.STATIC_DRAW); return b; };
  function uploaded(vertices, faces, edges) {
    return { vertices: buffer(gl.ARRAY_BUFFER, vertices), faces: buffer(gl.ELEMENT_ARRAY_BUFFER, faces), edges: edges && buffer(gl.ELEMENT_ARRAY_BUFFER, edges) };
  }
  trees.forEach((tree) => { tree.buffers = uploaded(floats(tree.vertices), new Uint32Array(bytes(tree.faces)), new Uint32Array(bytes(tree.edges))); });

  // A line as a tube of four sides, since WebGL's own lines are one pixel wide.
  function tube(line) {
    const points = floats(line.points), n = points.length / 3, radius = 0.008, vertices = [], faces = [];
    for (let i = 0; i < n; i++) {
      const p = [...points.subarray(3 * i, 3 * i + 3)], j = Math.min(i, n - 2);
      const along = n > 1 ? unit(minus([...points.subarray(3 * j + 3, 3 * j + 6)], [...points.subarray(3 * j, 3 * j + 3)])) : [0, 0, 1];
      const side = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), up = cross(along, side);
      for (const [a, b] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) vertices.push(...p.map((x, k) => x + radius * (a * side[k] + b * up[k])));
      if (i) for (let k = 0; k < 4; k++) {
        const a = 4 * (i - 1) + k, b = 4 * (i - 1) + ((k + 1) % 4);
        faces.push(a, b, a + 4, b, b + 4, a + 4);
      }
    }
    return { ...uploaded(new Float32Array(vertices), new Uint32Array(faces)), count: faces.length, color: line.color, label: line.label };
  }
  const common = data.lines.map(tube);
  clips.forEach((clip) => { clip.tubes = clip.lines.map(tube); });

  let now = { clip: clips[0], time: 0, playing: false, last: 0, asked: false };
  const camera = { ...data.camera };
  const duration = () => now.clip.times[now.clip.times.length - 1];

  function screen() {
    const { target, yaw, pitch } = camera, ratio = canvas.width / canvas.height;
    const distance = camera.distance * Math.max(1, data.aspect / ratio);
    const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
    const eye = target.map((x, i) => x + distance * back[i]), right = [-Math.sin(yaw), Math.cos(yaw), 0], up = cross(back, right);
    const look = new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
    const f = 1 / Math.tan(data.camera.angle / 2), near = Math.max(0.05, distance - camera.reach), far = 100;
    return product(new Float32Array([f / ratio, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0]), look);
  }
  function ink(name, alpha, lit) {
    gl.uniform4f(uniforms.color, ...(data.colors[name] || data.colors.kitchen), alpha);
    gl.uniform1f(uniforms.lit, lit);
  }
  function bind(buffers, elements) {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.vertices);
    gl.vertexAttribPointer(point, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, elements);
  }
  function drawTree(tree, red, alpha) {
    const placed = frames(tree, positions(now.clip, tree, now.time));
    for (const part of ["faces", "edges"]) {
      bind(tree.buffers, tree.buffers[part]);
      let first = 0;
      for (const [iri, , joint, kind, faceCount, edgeCount] of tree.bodies) {
        const count = part === "faces" ? faceCount : edgeCount;
        gl.uniformMatrix4fv(uniforms.place, false, joint < 0 ? identity : placed[joint]);
        if (part === "faces") ink(red.has(iri) ? "red" : kind, red.has(iri) ? Math.max(alpha, 0.8) : alpha, 1);
        else { gl.uniform4f(uniforms.color, 0.2, 0.2, 0.22, 0.5 * alpha); gl.uniform1f(uniforms.lit, 0); }
        gl.drawElements(part === "faces" ? gl.TRIANGLES : gl.LINES, count, gl.UNSIGNED_INT, 4 * first);
        first += count;
      }
    }
  }
  function draw() {
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * scale)), height = Math.max(1, Math.round(canvas.clientHeight * scale));
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.97, 0.97, 0.96, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(0.7, 1);
    gl.enableVertexAttribArray(point);
    gl.uniformMatrix4fv(uniforms.screen, false, screen());
    const red = new Set(now.clip.red), [kitchen, ...robots] = now.clip.trees.map((i) => trees[i]);
    drawTree(kitchen, red, 1);
    if (!now.clip.ghost) robots.forEach((tree) => drawTree(tree, red, 1));
    gl.uniformMatrix4fv(uniforms.place, false, identity);
    for (const one of [...common, ...now.clip.tubes]) {
      bind(one, one.faces);
      ink(one.color, 1, 0.4);
      gl.drawElements(gl.TRIANGLES, one.count, gl.UNSIGNED_INT, 0);
    }
    if (now.clip.ghost) robots.forEach((tree) => drawTree(tree, red, 0.4));
  }
  function tell() {
    const phase = now.clip.phases.filter(([, begin]) => begin <= now.time + 1e-6).pop();
    label.textContent = duration() > 0 ? `${now.time.toFixed(1)} s of ${duration().toFixed(1)} s${phase ? ", " + phase[0] : ""}` : "a posture";
    slider.value = duration() > 0 ? (1000 * now.time) / duration() : 0;
    slider.disabled = play.disabled = speed.disabled = !(duration() > 0);
    play.textContent = now.playing ? "Pause" : "Play";
  }
  function step(stamp) {
    now.asked = false;
    if (now.playing) {
      now.time = Math.min(duration(), now.time + ((stamp - now.last) / 1000) * Number(speed.value));
      now.playing = now.time < duration();
    }
    now.last = stamp;
    draw();
    tell();
    if (now.playing) ask();
  }
  const ask = () => { if (!now.asked) { now.asked = true; requestAnimationFrame(step); } };
  function show(index) {
    const clip = clips[index];
    now = { ...now, clip, time: clip.times[clip.times.length - 1], playing: false };
    choice.value = index;
    Object.assign(camera, clip.camera || data.camera);
    note.textContent = clip.note;
    key.replaceChildren();
    new Map([...common, ...clip.tubes].map((one) => [one.color === "path" ? "path of a handle that can be moved" : one.label, one.color])).forEach((color, text) => {
      const row = make("div", key), swatch = make("span", row);
      swatch.style.background = `rgb(${data.colors[color].map((x) => Math.round(255 * x)).join(",")})`;
      row.append(text);
    });
    key.hidden = !key.childNodes.length;
    ask();
  }
  function toggle() {
    if (!(duration() > 0)) return;
    now.playing = !now.playing;
    if (now.playing && now.time >= duration()) now.time = 0;
    now.last = performance.now();
    ask();
  }
  play.onclick = toggle;
  choice.onchange = () => show(Number(choice.value));
  slider.oninput = () => { now.time = (duration() * Number(slider.value)) / 1000; now.playing = false; ask(); };
  home.onclick = () => { Object.assign(camera, data.camera); ask(); };

  const held = new Map();
  const turn = (dx, dy) => { camera.yaw -= dx; camera.pitch = Math.min(1.55, Math.max(-0.2, camera.pitch + dy)); ask(); };
  const zoom = (factor) => { camera.distance = Math.min(40, Math.max(0.3, camera.distance * factor)); ask(); };
  function shift(dx, dy) {
    const right = [-Math.sin(camera.yaw), Math.cos(camera.yaw), 0], k = camera.distance / 700;
    camera.target = camera.target.map((x, i) => x - k * dx * right[i] + (i === 2 ? k * dy : 0));
    ask();
  }
  canvas.onpointerdown = (e) => { canvas.setPointerCapture(e.pointerId); held.set(e.pointerId, { x: e.clientX, y: e.clientY, shift: e.button === 2 || e.shiftKey }); };
  canvas.onpointerup = canvas.onpointercancel = (e) => held.delete(e.pointerId);
  canvas.onpointermove = (e) => {
    const before = held.get(e.pointerId), now = { ...before, x: e.clientX, y: e.clientY };
    if (!before) return;
    const other = [...held].filter(([id]) => id !== e.pointerId).map(([, each]) => each)[0];
    const apart = (one) => Math.max(1, Math.hypot(one.x - other.x, one.y - other.y));
    if (other) zoom(apart(before) / apart(now));
    else if (before.shift) shift(now.x - before.x, now.y - before.y);
    else turn((now.x - before.x) / 200, (now.y - before.y) / 200);
    held.set(e.pointerId, now);
  };
  canvas.oncontextmenu = (e) => e.preventDefault();
  canvas.addEventListener("wheel", (e) => { if (e.ctrlKey || document.activeElement === canvas) { e.preventDefault(); zoom(Math.exp(e.deltaY / 600)); } }, { passive: false });
  canvas.onkeydown = (e) => {
    const keys = {
      ArrowLeft: () => turn(0.08, 0), ArrowRight: () => turn(-0.08, 0), ArrowUp: () => turn(0, 0.06), ArrowDown: () => turn(0, -0.06),
      "+": () => zoom(0.9), "-": () => zoom(1.1), " ": toggle,
    };
    if (keys[e.key]) { e.preventDefault(); keys[e.key](); }
  };
  new ResizeObserver(ask).observe(canvas);
  document.addEventListener("sdt-show", (e) => {
    const index = clips.findIndex((clip) => clip.name === e.detail);
    if (index >= 0) { show(index); figure.scrollIntoView({ block: "nearest" }); }
  });
  figure.sdtView = {
    names: clips.map((clip) => clip.name),
    show,
    seek: (time) => { now.time = time; now.playing = false; ask(); },
    frame: (joint) => { for (const tree of trees) if (tree.index.has(joint)) return [...frames(tree, positions(now.clip, tree, now.time))[tree.index.get(joint)]]; },
  };
  show(0);
})();
