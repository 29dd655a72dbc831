/* What the 3-D view of a report shows: ground, structures and balls, made of the scene that scene.py wrote.
   Needs THREE before it on the page; leaves SlopeWorld, with groundOf(scene, centre), structuresOf(scene, centre) and
   ballsOf(scene, centre, renderer).
   Axes as in the run: x east, y north, z up; lengths in m, heights not exaggerated. */
const SlopeWorld = (function () {
  'use strict';

  const NONE = 65535;               // a place or a height that is not there
  const NORTH_WEST = new THREE.Vector3(-0.5, 0.5, Math.SQRT1_2);    // where the light comes from, as on the maps
  const AT_REST = '#a3937b';

  function bytes(text) {
    const letters = atob(text);
    const found = new Uint8Array(letters.length);
    for (let i = 0; i < letters.length; i++) found[i] = letters.charCodeAt(i);
    return found.buffer;
  }

  // --- ground ---

  function heightsOf(packed, about) {
    return Float32Array.from(new Uint16Array(bytes(packed)),
                             (share) => share === NONE ? NaN : about.low + about.span * share / (NONE - 1));
  }

  /* A surface over the grid of the ground, rows from the south; keep(node) says which nodes it has. */
  function surface(about, heights, centre, keep) {
    const columns = about.columns, rows = about.rows;
    const [xlo, ylo, xhi, yhi] = about.box;
    const places = new Float32Array(3 * columns * rows), onMap = new Float32Array(2 * columns * rows);
    for (let j = 0, n = 0; j < rows; j++) {
      for (let i = 0; i < columns; i++, n++) {
        const east = i / (columns - 1), north = j / (rows - 1), z = heights[n];
        places.set([xlo + east * (xhi - xlo) - centre.x, ylo + north * (yhi - ylo) - centre.y,
                    isNaN(z) ? about.low : z], 3 * n);
        onMap.set([east, north], 2 * n);
      }
    }
    const corners = [];
    for (let j = 0; j + 1 < rows; j++) {
      for (let i = 0; i + 1 < columns; i++) {
        const a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
        for (const three of [[a, b, d], [a, d, c]]) if (three.every(keep)) corners.push(...three);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
    geometry.setAttribute('uv', new THREE.BufferAttribute(onMap, 2));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(corners), 1));
    geometry.computeVertexNormals();
    return geometry;
  }

  /* Walls from the edge of the ground down to a level, so that it stands as a block. */
  function walls(about, heights, centre, level) {
    const columns = about.columns, rows = about.rows, edge = [], places = [];
    for (let i = 0; i < columns; i++) edge.push(i);
    for (let j = 1; j < rows; j++) edge.push(j * columns + columns - 1);
    for (let i = columns - 2; i >= 0; i--) edge.push((rows - 1) * columns + i);
    for (let j = rows - 2; j >= 0; j--) edge.push(j * columns);
    const at = (n) => [about.box[0] + (n % columns) / (columns - 1) * (about.box[2] - about.box[0]) - centre.x,
                       about.box[1] + Math.floor(n / columns) / (rows - 1) * (about.box[3] - about.box[1]) - centre.y];
    for (let k = 0; k + 1 < edge.length; k++) {
      const [m, n] = [edge[k], edge[k + 1]];
      if (isNaN(heights[m]) || isNaN(heights[n])) continue;
      const a = [...at(m), heights[m]], b = [...at(n), heights[n]], c = [...at(m), level], d = [...at(n), level];
      places.push(...a, ...c, ...b, ...b, ...c, ...d);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(places), 3));
    return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({color: '#8d8778', side: THREE.DoubleSide}));
  }

  /* What is drawn on the ground: grid, road, released mass, section; a picture that is laid over it. */
  function overlay(scene, grid) {
    const [xlo, ylo, xhi, yhi] = scene.ground.box;
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = 2048;        // powers of two: also WebGL 1 can make smaller ones of it
    const pen = canvas.getContext('2d');
    const width = xhi - xlo, depth = yhi - ylo, thin = Math.max(width, depth) / 700;
    pen.setTransform(canvas.width / width, 0, 0, -canvas.height / depth, -xlo * canvas.width / width,
                     yhi * canvas.height / depth);         // from here on in metres of the run
    function line(points, colour, thickness, dashes, fill) {
      pen.beginPath();
      points.forEach(([x, y], k) => k ? pen.lineTo(x, y) : pen.moveTo(x, y));
      if (fill) {
        pen.fillStyle = fill;
        pen.fill();
      }
      pen.setLineDash((dashes || []).map((dash) => dash * thin));
      pen.lineWidth = thickness * thin;
      pen.strokeStyle = colour;
      pen.stroke();
    }
    function letter(text, [x, y]) {     // upright for somebody who looks north
      const high = 24 * thin;
      pen.save();
      pen.translate(x, y);
      pen.scale(1, -1);
      pen.font = `bold ${high}px sans-serif`;
      pen.textAlign = 'center';
      pen.textBaseline = 'middle';
      pen.lineWidth = high / 5;
      pen.strokeStyle = 'white';
      pen.setLineDash([]);
      pen.strokeText(text, 0, 0);
      pen.fillStyle = scene.colours.section;
      pen.fillText(text, 0, 0);
      pen.restore();
    }
    if (grid) {
      const step = scene.ground.grid;
      for (let x = Math.ceil(xlo / step) * step; x <= xhi; x += step) line([[x, ylo], [x, yhi]], '#00000048', 0.7);
      for (let y = Math.ceil(ylo / step) * step; y <= yhi; y += step) line([[xlo, y], [xhi, y]], '#00000048', 0.7);
    }
    scene.road.forEach((ring) => line(ring, scene.colours.road, 2.5, [], scene.colours.road + '40'));
    scene.release.forEach((ring) => line(ring, scene.colours.release, 2.2, [7, 4]));
    line(scene.section, scene.colours.section, 1.6, [12, 4, 2, 4]);
    const last = scene.section.length - 1;
    letter('A', scene.section[0]);
    letter("A'", scene.section[last]);
    const texture = new THREE.CanvasTexture(canvas);
    texture.anisotropy = 8;
    return texture;
  }

  const GROUND_VERTEX = `
    attribute float slip;
    varying vec3 outwards;
    varying vec2 onMap;
    varying float height, scar;
    void main() {
      outwards = normal;
      onMap = uv;
      height = position.z;
      scar = slip;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    }`;
  const GROUND_FRAGMENT = `
    uniform vec3 light;
    uniform sampler2D picture;
    uniform float interval, lines;
    varying vec3 outwards;
    varying vec2 onMap;
    varying float height, scar;
    void main() {
      float shade = clamp(dot(normalize(outwards), light), 0.0, 1.0);
      vec3 colour = mix(vec3(0.90, 0.88, 0.83), vec3(0.80, 0.70, 0.62), scar) * (0.32 + 0.80 * shade);
      // contours, a pixel wide; a little above their level, or a flat place at just that level would be one of them
      float level = height / interval - 0.002, step = fwidth(level) + 1e-6;
      float line = 1.0 - smoothstep(0.35 * step, 1.1 * step, abs(fract(level + 0.5) - 0.5));
      colour = mix(colour, vec3(0.25), 0.45 * lines * line * (1.0 - smoothstep(0.2, 0.5, step)));
      vec4 drawn = texture2D(picture, onMap);
      gl_FragColor = vec4(mix(colour, drawn.rgb, drawn.a), 1.0);
    }`;

  function groundOf(scene, centre) {
    const about = scene.ground;
    const base = heightsOf(about.base, about), before = heightsOf(about.before, about);
    const pictures = [overlay(scene, false), overlay(scene, true)];
    const uniforms = {light: {value: NORTH_WEST}, picture: {value: pictures[1]}, interval: {value: about.interval},
                      lines: {value: 1}};
    const material = new THREE.ShaderMaterial({uniforms, vertexShader: GROUND_VERTEX,
                                               fragmentShader: GROUND_FRAGMENT, side: THREE.DoubleSide});
    material.extensions = {derivatives: true};
    const geometry = surface(about, base, centre, (n) => !isNaN(base[n]));
    geometry.setAttribute('slip', new THREE.BufferAttribute(base.map((z, n) => before[n] - z > 0.01 ? 1 : 0), 1));
    const level = about.low - 0.04 * Math.max(about.box[2] - about.box[0], about.box[3] - about.box[1]);
    const removed = surface(about, before, centre, (n) => !isNaN(base[n]) && before[n] - base[n] > 0.01);
    const body = new THREE.Mesh(removed, new THREE.MeshBasicMaterial(
      {color: '#6f7f5a', transparent: true, opacity: 0.45, side: THREE.DoubleSide, depthWrite: false}));
    body.visible = false;
    return {parts: [new THREE.Mesh(geometry, material), walls(about, base, centre, level), body], body, uniforms,
            pictures};
  }

  // --- structures: each triangle in one tone, by how it faces the light from either side ---

  function structuresOf(scene, centre) {
    const parts = [];
    for (const about of scene.structures.filter((one) => one.triangles > 0)) {
      const places = new Float32Array(bytes(about.corners)), tones = new Float32Array(places.length);
      const colour = new THREE.Color(scene.colours.structure), triangle = new THREE.Triangle(), outwards = new THREE.Vector3();
      for (let n = 0; n < places.length; n += 3) {
        places[n] -= centre.x;
        places[n + 1] -= centre.y;
      }
      for (let n = 0; n < places.length; n += 9) {
        triangle.a.fromArray(places, n);
        triangle.b.fromArray(places, n + 3);
        triangle.c.fromArray(places, n + 6);
        triangle.getNormal(outwards);
        const tone = colour.clone().multiplyScalar(0.55 + 0.6 * Math.abs(outwards.dot(NORTH_WEST)));
        for (const k of [n, n + 3, n + 6]) tone.toArray(tones, k);
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
      geometry.setAttribute('color', new THREE.BufferAttribute(tones, 3));
      parts.push(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(
        {vertexColors: THREE.VertexColors || true, side: THREE.DoubleSide})));
      parts.push(new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 20), new THREE.LineBasicMaterial({color: '#39424d'})));
    }
    return parts;
  }

  // --- balls: points that are drawn as lit spheres, with the depth of a sphere ---

  const BALL_VERTEX = `
    attribute vec4 here, next;          // shares of the box x y z and of the fastest speed; 1: no ball
    attribute float size, start;
    uniform vec3 low, span;
    uniform float along, pixels, mode, slow;
    varying float radius, distance, tone, moving;
    void main() {
      bool there = here.x < 0.999995 && next.x < 0.999995;
      vec4 centre = modelViewMatrix * vec4(low + span * mix(here.xyz, next.xyz, along), 1.0);
      float speed = mix(here.w, next.w, along);
      radius = 0.5 * size;
      distance = centre.z;
      tone = mode < 0.5 ? speed : start;
      moving = mode > 0.5 || speed > slow ? 1.0 : 0.0;
      gl_Position = there ? projectionMatrix * centre : vec4(2.0, 2.0, 2.0, 1.0);
      gl_PointSize = max(1.5, pixels * size / max(0.001, -centre.z));
    }`;
  const BALL_FRAGMENT = `
    uniform vec3 light, resting;
    uniform vec2 depth;                 // the two entries of the projection that make the depth
    uniform sampler2D scale;
    varying float radius, distance, tone, moving;
    void main() {
      vec2 at = vec2(2.0, -2.0) * (gl_PointCoord - 0.5);
      float out2 = dot(at, at);
      if (out2 > 1.0) discard;
      vec3 outwards = vec3(at, sqrt(1.0 - out2));
      vec3 colour = mix(resting, texture2D(scale, vec2(clamp(tone, 0.01, 0.99), 0.5)).rgb, moving);
      float shade = 0.42 + 0.62 * clamp(dot(outwards, light), 0.0, 1.0);
      gl_FragColor = vec4(colour * shade * mix(0.62, 1.0, outwards.z), 1.0);
      #ifdef SPHERES
        float z = distance + radius * outwards.z;
        gl_FragDepthEXT = 0.5 + 0.5 * (depth.x * z + depth.y) / -z;
      #endif
    }`;

  function scaleOf(colours) {
    const canvas = document.createElement('canvas');
    canvas.width = 256;
    canvas.height = 2;
    const pen = canvas.getContext('2d'), gradient = pen.createLinearGradient(0, 0, 256, 0);
    colours.forEach((colour, k) => gradient.addColorStop(k / (colours.length - 1), colour));
    pen.fillStyle = gradient;
    pen.fillRect(0, 0, 256, 2);
    return new THREE.CanvasTexture(canvas);
  }

  function ballsOf(scene, centre, renderer) {
    const about = scene.balls, count = about.count, all = new Uint16Array(bytes(about.places));
    const frames = scene.times.map((_, k) => all.subarray(4 * count * k, 4 * count * (k + 1)));
    const attributes = frames.map((frame) => new THREE.BufferAttribute(frame, 4, true));
    const start = new Float32Array(count);
    for (let i = 0; i < count; i++) {
      const first = frames.find((frame) => frame[4 * i] !== NONE);
      const z = about.low[2] + about.span[2] * first[4 * i + 2] / (NONE - 1);
      start[i] = (z - scene.height.low) / Math.max(1e-6, scene.height.top - scene.height.low);
    }
    const sizes = typeof about.diameter === 'number' ? new Float32Array(count).fill(about.diameter) :
      new Float32Array(bytes(about.diameter));
    const scales = {speed: scaleOf(scene.speed.colours), height: scaleOf(scene.height.colours)};
    const uniforms = {
      low: {value: new THREE.Vector3(about.low[0] - centre.x, about.low[1] - centre.y, about.low[2])},
      span: {value: new THREE.Vector3(...about.span)}, along: {value: 0}, pixels: {value: 1}, mode: {value: 0},
      slow: {value: 0.1 / scene.speed.top}, light: {value: new THREE.Vector3()}, depth: {value: new THREE.Vector2()},
      resting: {value: new THREE.Color(AT_REST)}, scale: {value: scales.speed}};
    const spheres = Boolean(renderer.capabilities.isWebGL2 || renderer.getContext().getExtension('EXT_frag_depth'));
    const material = new THREE.ShaderMaterial({
      uniforms, vertexShader: BALL_VERTEX, fragmentShader: BALL_FRAGMENT, defines: spheres ? {SPHERES: 1} : {}});
    material.extensions = {fragDepth: spheres};
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', attributes[0]);       // tells how many there are; the shader has here and next
    geometry.setAttribute('start', new THREE.BufferAttribute(start, 1));
    geometry.setAttribute('size', new THREE.BufferAttribute(sizes, 1));
    const points = new THREE.Points(geometry, material);
    points.frustumCulled = false;       // the places in the buffers are shares, not metres
    return {points, uniforms, scales, show(frame, along) {
      const next = Math.min(frame + 1, attributes.length - 1);
      geometry.setAttribute('here', attributes[frame]);
      geometry.setAttribute('next', attributes[next]);
      uniforms.along.value = along;
    }};
  }

  return {groundOf, structuresOf, ballsOf, NORTH_WEST, AT_REST};
}());
