/* The 3-D view of a report: camera, time, legend, and what the buttons do. Needs THREE, THREE.OrbitControls and
   SlopeWorld before it on the page, the elements of view.html.j2, and the scene as JSON in #scene.
   Nothing is drawn unless something has changed. */
(function () {
  'use strict';

  const element = (id) => document.getElementById(id);
  const FIELD_OF_VIEW = 32;         // degrees, upright

  function hasWebGL() {
    const canvas = document.createElement('canvas');
    return Boolean(canvas.getContext('webgl2') || canvas.getContext('webgl'));
  }

  function say(text) {
    const box = element('view-message');
    box.textContent = text;
    box.hidden = false;
    element('view-controls').hidden = true;
    element('view-overlay').hidden = true;
  }

  // --- legend, scale, north ---

  function swatch(style, text) {
    const row = document.createElement('div'), mark = document.createElement('i');
    mark.style.cssText = style;
    row.append(mark, text);
    return row;
  }

  function legend(scene, mode) {
    const box = element('view-legend'), about = scene[mode];
    const bar = document.createElement('b'), ends = document.createElement('div');
    bar.style.background = `linear-gradient(to right, ${about.colours.join(', ')})`;
    ends.className = 'ends';
    const values = mode === 'speed' ? [0, about.top / 2, about.top] : [about.low, (about.low + about.top) / 2, about.top];
    for (const value of values) ends.append(Object.assign(document.createElement('span'), {textContent: +value.toPrecision(3)}));
    const title = mode === 'speed' ? 'speed of the balls (m/s)' : 'height at release (m)';
    box.replaceChildren(Object.assign(document.createElement('div'), {textContent: title}), bar, ends);
    if (mode === 'speed') box.append(swatch(`background: ${SlopeWorld.AT_REST}`, 'slower than 0.1 m/s'));
    box.append(swatch('background: #c6ad9a', 'slip surface'));
    if (scene.road.length) box.append(swatch(`border: 2px solid ${scene.colours.road}; background: ${scene.colours.road}40`, 'road'));
    if (scene.release.length) box.append(swatch(`height: 0; border-top: 2px dashed ${scene.colours.release}`, 'released mass'));
    if (scene.structures.some((one) => one.triangles > 0)) box.append(swatch(`background: ${scene.colours.structure}`, 'structure'));
    box.append(swatch(`height: 0; border-top: 2px dotted ${scene.colours.section}`, "section A-A'"));
  }

  function nice(length) {
    const power = 10 ** Math.floor(Math.log10(length));
    return power * [5, 2, 1].find((step) => step * power <= length * 1.000001);
  }

  // --- the view ---

  function start(scene) {
    const stage = element('view-stage'), box = scene.ground.box;
    const centre = new THREE.Vector3((box[0] + box[2]) / 2, (box[1] + box[3]) / 2, 0);
    const renderer = new THREE.WebGLRenderer({antialias: true, canvas: element('view-canvas')});
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    const world = new THREE.Scene();
    world.background = new THREE.Color('#dfe7ee');
    const ground = SlopeWorld.groundOf(scene, centre), balls = SlopeWorld.ballsOf(scene, centre, renderer);
    world.add(...ground.parts, ...SlopeWorld.structuresOf(scene, centre), balls.points);

    const size = Math.hypot(box[2] - box[0], box[3] - box[1]);
    const camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1.6, size / 300, 12 * size);
    camera.up.set(0, 0, 1);
    const controls = new THREE.OrbitControls(camera, renderer.domElement);
    controls.screenSpacePanning = true;
    controls.enableZoom = false;        // the wheel scrolls the page until the view is clicked
    controls.enableKeys = false;
    const zoom = (on) => () => { controls.enableZoom = on; };
    for (const name of ['pointerdown', 'mousedown', 'touchstart']) stage.addEventListener(name, zoom(true), true);
    stage.addEventListener('mouseleave', zoom(false));

    let time = 0, playing = false, last = 0, waiting = false;
    const end = scene.times[scene.times.length - 1];

    function draw() {
      waiting = false;
      let frame = scene.times.findIndex((at) => at > time) - 1;
      if (frame < -1) frame = scene.times.length - 1;
      frame = Math.max(0, frame);
      const from = scene.times[frame], to = scene.times[Math.min(frame + 1, scene.times.length - 1)];
      balls.show(frame, to > from ? (time - from) / (to - from) : 0);
      camera.updateMatrixWorld();
      balls.uniforms.light.value.copy(SlopeWorld.NORTH_WEST).transformDirection(camera.matrixWorldInverse);
      balls.uniforms.pixels.value = renderer.domElement.height / (2 * Math.tan(FIELD_OF_VIEW * Math.PI / 360));
      balls.uniforms.depth.value.set(camera.projectionMatrix.elements[10], camera.projectionMatrix.elements[14]);
      renderer.render(world, camera);
      mark();
    }

    function change() {         // draw once, however much has changed until then
      if (!waiting) requestAnimationFrame(draw);
      waiting = true;
    }

    /* The north arrow and the scale bar, both as they are at the middle of the view. */
    function mark() {
      const width = stage.clientWidth, tall = stage.clientHeight;
      const onScreen = (place) => place.clone().project(camera).multiply(new THREE.Vector3(width / 2, tall / 2, 0));
      const middle = onScreen(controls.target), far = camera.position.distanceTo(controls.target);
      const north = onScreen(controls.target.clone().add(new THREE.Vector3(0, far / 100, 0))).sub(middle);
      element('view-north').style.transform = `rotate(${Math.atan2(north.x, north.y)}rad)`;
      const metres = 2 * far * Math.tan(FIELD_OF_VIEW * Math.PI / 360) / tall;      // of a pixel
      const length = nice(140 * metres);
      element('view-scale').style.width = `${length / metres}px`;
      element('view-scale').textContent = `${length} m`;
    }

    function setTime(value) {
      time = Math.min(end, Math.max(0, value));
      element('view-time').value = time;
      element('view-seconds').textContent = `${time.toFixed(1)} s`;
      change();
    }

    function play(on) {
      playing = on;
      element('view-play').textContent = on ? 'Pause' : 'Play';
      if (on && time >= end) setTime(scene.times[0]);
      last = performance.now();
      if (on) requestAnimationFrame(tick);
    }

    function tick(now) {
      if (!playing) return;
      const rate = Number(element('view-rate').value);
      setTime(time + Math.min(0.25, Math.max(0, now - last) / 1000) * rate);
      last = now;
      if (time >= end) play(false);
      else requestAnimationFrame(tick);
    }

    /* From where: azimuth (radians from east) and elevation of the camera as it is seen from the target. */
    function look(azimuth, elevation, share) {
      const far = share * size / (2 * Math.tan(FIELD_OF_VIEW * Math.PI / 360)) / Math.min(1, camera.aspect / 1.25);
      controls.target.set(0, 0, scene.ground.low + scene.ground.span / 4);
      camera.position.set(Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation),
                          Math.sin(elevation)).multiplyScalar(far).add(controls.target);
      controls.update();
      change();
    }

    /* Down the slope along the section, radians from east. */
    const [a, b] = [scene.section[0], scene.section[scene.section.length - 1]];
    const down = Math.atan2(b[1] - a[1], b[0] - a[0]) + (scene.falls ? 0 : Math.PI);
    const views = {oblique: () => look(down + 0.75, 0.5, 0.92), front: () => look(down, 0.3, 0.78),
                   side: () => look(down + Math.PI / 2, 0.15, 0.8), above: () => look(-Math.PI / 2, 1.5706, 0.9)};

    function resize() {
      renderer.setSize(stage.clientWidth, stage.clientHeight, false);
      camera.aspect = stage.clientWidth / stage.clientHeight;
      camera.updateProjectionMatrix();
      change();
    }

    function colour(mode) {
      balls.uniforms.mode.value = mode === 'speed' ? 0 : 1;
      balls.uniforms.scale.value = balls.scales[mode];
      legend(scene, mode);
      change();
    }

    const slider = element('view-time'), rate = element('view-rate');
    slider.max = end;
    slider.step = end / 1000;
    rate.value = [...rate.options].map((one) => one.value).find((one) => end / one <= 30) || rate.options[rate.length - 1].value;
    slider.addEventListener('input', () => { play(false); setTime(Number(slider.value)); });
    element('view-play').addEventListener('click', () => play(!playing));
    element('view-colour').addEventListener('change', (event) => colour(event.target.value));
    element('view-body').addEventListener('change', (event) => { ground.body.visible = event.target.checked; change(); });
    element('view-grid').addEventListener('change', (event) => {
      ground.uniforms.picture.value = ground.pictures[Number(event.target.checked)];
      ground.uniforms.lines.value = Number(event.target.checked);
      change();
    });
    for (const name of Object.keys(views)) element(`view-${name}`).addEventListener('click', views[name]);
    element('view-full').addEventListener('click', () => document.fullscreenElement ? document.exitFullscreen() :
      element('view-frame').requestFullscreen());
    controls.addEventListener('change', change);
    renderer.domElement.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      say('The graphics of this computer stopped. Load the page again to see the view.');
    });
    // paper: a still picture of the final state, for a canvas does not print everywhere
    let before = null;
    window.addEventListener('beforeprint', () => {
      before = time;
      play(false);
      setTime(end);
      draw();
      element('view-still').src = renderer.domElement.toDataURL('image/jpeg', 0.9);
    });
    window.addEventListener('afterprint', () => {
      if (before !== null) setTime(before);
      before = null;
    });
    new ResizeObserver(resize).observe(stage);
    resize();
    colour('speed');
    views.oblique();
    setTime(scene.times[0]);
    draw();
  }

  if (!hasWebGL()) {
    say('This browser shows no 3-D graphics (WebGL is missing or switched off). Everything else on this page works.');
  } else {
    try {
      start(JSON.parse(element('scene').textContent));
    } catch (error) {
      say(`The 3-D view could not start: ${error.message}. Everything else on this page works.`);
    }
  }
}());
