'use strict';
// The 3D view of the report. Reads the scene from <script id="scene"> and three.js from <script id="three"> (gzip,
// base64), draws on demand, and never needs a network. Where WebGL is missing, the still picture stays.
(function () {
  const host = document.getElementById('view');
  const scene = JSON.parse(document.getElementById('scene').textContent);
  const report = (name, value) => document.body.setAttribute('data-canvas-' + name, value);

  const bytes = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  async function loadThree() {
    const packed = bytes(document.getElementById('three').textContent.trim());
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
    const script = document.createElement('script');
    script.textContent = await new Response(stream).text();
    document.head.append(script);
  }

  // ------------------------------------------------------------------------------------------------ what is drawn
  const FIELD_OF_VIEW = 32;                        // degrees, vertical
  const PAPER = '#f3f5f7';                         // what is printed is light whatever the screen's theme is
  const background = () => getComputedStyle(host).backgroundColor;
  const hidden = new Set((/hide=([a-z,]*)/.exec(location.hash) || ['', ''])[1].split(','));
  const uniforms = { pixel: { value: 1 } };        // height of a screen pixel at unit distance from the camera

  // Points as small discs lit from beside the camera; so large that they close the gaps
  // which random thinning leaves.
  function pointCloud(cloud) {
    const geometry = new THREE.BufferGeometry();
    const positions = new Uint16Array(bytes(cloud.positions).buffer);
    const normals = new Int8Array(bytes(cloud.normals).buffer);
    geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3, true));
    geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3, true));
    const material = new THREE.ShaderMaterial({
      uniforms: { pixel: uniforms.pixel, disc: { value: 2.5 * cloud.spacing } },
      vertexShader: `
        uniform float pixel, disc;
        varying float shade;
        void main() {
          vec4 eye = modelViewMatrix * vec4(position, 1.0);
          float slope = abs(dot((viewMatrix * vec4(normal, 0.0)).xyz, normalize(vec3(0.35, 0.55, 1.0))));
          shade = dot(normal, normal) < 0.25 ? 0.72 : 0.42 + 0.5 * slope;
          gl_PointSize = clamp(disc / (pixel * -eye.z), 1.6, 22.0);
          gl_Position = projectionMatrix * eye;
        }`,
      fragmentShader: `
        varying float shade;
        void main() {
          vec2 from = gl_PointCoord - 0.5;
          if (dot(from, from) > 0.25) discard;
          gl_FragColor = vec4(shade * vec3(0.93, 0.955, 0.98), 1.0);
        }`
    });
    const points = new THREE.Points(geometry, material);
    points.position.fromArray(cloud.low);
    points.scale.fromArray(cloud.size);
    return points;
  }

  // Round lines: rings of vertices that the shader pushes out by `width` screen pixels, so that a seam is as easy to see
  // from afar as from near. `rings` are {p, along, colour, width, dash}; a ring whose `start` is set begins a new line.
  const SIDES = 10;
  function tubeGeometry(rings) {
    const centre = [], side = [], colour = [], width = [], dash = [], index = [];
    rings.forEach((ring, k) => {
      const u = new THREE.Vector3().crossVectors(ring.along,
        Math.abs(ring.along.x) < 0.7 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, 1, 0)).normalize();
      const v = new THREE.Vector3().crossVectors(ring.along, u).normalize();
      for (let s = 0; s < SIDES; ++s) {
        const turn = 2 * Math.PI * s / SIDES;
        const out = u.clone().multiplyScalar(Math.cos(turn)).addScaledVector(v, Math.sin(turn));
        centre.push(ring.p.x, ring.p.y, ring.p.z);
        side.push(out.x, out.y, out.z);
        colour.push(ring.colour.r, ring.colour.g, ring.colour.b);
        width.push(ring.width);
        dash.push(ring.dash);
        if (k > 0 && !ring.start) {
          const a = (k - 1) * SIDES, b = k * SIDES, t = (s + 1) % SIDES;
          index.push(a + s, a + t, b + s, a + t, b + t, b + s);
        }
      }
    });
    const geometry = new THREE.BufferGeometry();
    const add = (name, values, size) =>
      geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(values), size));
    add('position', centre, 3);
    add('side', side, 3);
    add('tint', colour, 3);
    add('width', width, 1);
    add('dash', dash, 1);
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(index), 1));
    return geometry;
  }

  // `margin` widens the tube for its dark outline; `ghost` draws what lies behind the scan, faintly.
  function tubeMaterial(margin, ghost) {
    return new THREE.ShaderMaterial({
      uniforms: { pixel: uniforms.pixel, margin: { value: margin } },
      side: margin > 0 ? THREE.BackSide : THREE.FrontSide,
      transparent: ghost, depthWrite: !ghost, depthFunc: ghost ? THREE.GreaterDepth : THREE.LessEqualDepth,
      vertexShader: `
        uniform float pixel, margin;
        attribute vec3 side, tint;
        attribute float width, dash;
        varying vec3 colour, outward;
        varying float along;
        void main() {
          vec4 eye = modelViewMatrix * vec4(position, 1.0);
          outward = (viewMatrix * vec4(side, 0.0)).xyz;
          eye.xyz += outward * (width > 0.0 ? width + margin : 0.0) * pixel * -eye.z;
          eye.xyz *= 0.988;                       // nearer to the eye: the noise of the scan does not swallow the line
          colour = tint;
          along = dash;
          gl_Position = projectionMatrix * eye;
        }`,
      fragmentShader: `
        uniform float margin;
        varying vec3 colour, outward;
        varying float along;
        void main() {
          if (along >= 0.0 && fract(along) > 0.55) discard;
          float shade = 0.72 + 0.28 * normalize(outward).z;
          gl_FragColor = ${ghost ? 'vec4(colour, 0.22)' : 'margin > 0.0 ? vec4(0.13, 0.16, 0.2, 1.0) : vec4(colour * shade, 1.0)'};
        }`
    });
  }

  function tubes(rings, outlined) {
    const group = new THREE.Group();
    if (rings.length === 0) return group;
    const geometry = tubeGeometry(rings);
    group.add(new THREE.Mesh(geometry, tubeMaterial(0, false)));
    if (outlined) {
      group.add(new THREE.Mesh(geometry, tubeMaterial(1.1, false)));
      group.add(new THREE.Mesh(geometry, tubeMaterial(0, true)));
    }
    return group;
  }

  const vector = (a) => new THREE.Vector3(a[0], a[1], a[2]);
  // Colour at a share of a map whose colours are in equal steps.
  function mapColour(colours, share) {
    const place = Math.min(1, Math.max(0, share)) * (colours.length - 1);
    const k = Math.min(colours.length - 2, Math.floor(place));
    return new THREE.Color(colours[k]).lerp(new THREE.Color(colours[k + 1]), place - k);
  }
  // `colours` is "distance", "flank1" or "flank2".
  function deviationColour(seam, sample, colours) {
    const [distance, modelled] = [sample[4], sample[6]];
    if (distance === null || modelled) return new THREE.Color(scene.unchecked);
    const scale = Math.max(scene.scale, 1e-9);
    if (colours !== 'distance') {
      return mapColour(scene.signedColours, 0.5 + 0.5 * sample[colours === 'flank1' ? 7 : 8] / scale);
    }
    return distance > seam.tolerance ? new THREE.Color(scene.outOfTolerance) : mapColour(scene.colours, distance / scale);
  }

  function seamRings(seam, colours) {
    const dashLength = scene.radius / 40;
    const last = seam.samples.length - 1;
    return seam.samples.map((sample, i) => {
      const along = vector(seam.samples[Math.min(i + 1, last)]).sub(vector(seam.samples[Math.max(i - 1, 0)]));
      const unchecked = sample[4] === null || sample[6];
      const beyond = !unchecked && sample[4] > seam.tolerance;
      return { p: vector(sample), along: along.normalize(), colour: deviationColour(seam, sample, colours),
        start: i === 0, width: beyond ? 4.6 : 3.2, dash: unchecked ? sample[3] / dashLength : -1 };
    });
  }

  function torchRings(length) {
    const colour = new THREE.Color('#3d5068');
    return scene.torch.flatMap(([p, axis]) => {
      const tip = vector(p), along = vector(axis);
      const back = (share) => tip.clone().addScaledVector(along, -share * length);
      const ring = (share, width, start) => ({ p: back(share), along, colour, width, start, dash: -1 });
      return [ring(1, 1, true), ring(0.3, 1, false), ring(0.3, 3.4, true), ring(0.03, 0, false)];
    });
  }

  const GOOD = '#2f7cc4', BAD = '#e3122f';
  // From each mark as far as its arrow reaches; the head takes a third.
  function arrowRings(marks) {
    return marks.filter((mark) => vector(mark.arrow).length() > 1e-3).flatMap((mark) => {
      const from = vector(mark.p), arrow = vector(mark.arrow), along = arrow.clone().normalize();
      const colour = new THREE.Color(mark.good ? GOOD : BAD);
      const ring = (share, width, start) =>
        ({ p: from.clone().addScaledVector(arrow, share), along, colour, width, start, dash: -1 });
      return [ring(0, 2, true), ring(0.67, 2, false), ring(0.67, 6, true), ring(1, 0, false)];
    });
  }

  // Half transparent, darker where they are seen edge on.
  function ellipsoid(shape) {
    const mesh = new THREE.Mesh(new THREE.SphereGeometry(1, 40, 24), new THREE.ShaderMaterial({
      transparent: true, depthWrite: false,
      uniforms: { tint: { value: new THREE.Color(shape.good ? GOOD : BAD) } },
      vertexShader: `
        varying vec3 out_;
        void main() {
          out_ = normalMatrix * normal;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        }`,
      fragmentShader: `
        uniform vec3 tint;
        varying vec3 out_;
        void main() {
          float rim = 1.0 - abs(normalize(out_).z);
          gl_FragColor = vec4(tint, 0.3 + 0.6 * rim * rim);
        }`
    }));
    mesh.matrixAutoUpdate = false;
    mesh.matrix.makeBasis(...shape.axes.map(vector)).setPosition(vector(shape.p));
    return mesh;
  }

  // White balls with a dark rim, `size` CSS pixels wide.
  function balls(positions, size) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
    return new THREE.Points(geometry, new THREE.ShaderMaterial({
      vertexShader: `
        void main() {
          vec4 eye = modelViewMatrix * vec4(position, 1.0);
          eye.xyz *= 0.984;
          gl_PointSize = ${(size * devicePixelRatio).toFixed(1)};
          gl_Position = projectionMatrix * eye;
        }`,
      fragmentShader: `
        void main() {
          vec2 from = 2.0 * gl_PointCoord - 1.0;
          float square = dot(from, from);
          if (square > 1.0) discard;
          float shade = 0.8 + 0.2 * sqrt(1.0 - square);
          gl_FragColor = square > 0.5 ? vec4(0.13, 0.16, 0.2, 1.0) : vec4(vec3(shade), 1.0);
        }`
    }));
  }

  // ------------------------------------------------------------------------------------------------ the camera
  // Turns freely about its target, for a part has no upright of its own.
  function makeCamera(redraw) {
    const lens = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 1000);
    const state = { target: new THREE.Vector3(), turn: new THREE.Quaternion(), distance: 1 };

    function apply(width, height) {
      lens.aspect = width / height;
      lens.position.copy(new THREE.Vector3(0, 0, state.distance).applyQuaternion(state.turn)).add(state.target);
      lens.quaternion.copy(state.turn);
      const far = state.distance + state.target.length() + 60 * scene.radius;
      lens.near = Math.max(state.distance / 200, far / 50000);
      lens.far = far;
      lens.updateProjectionMatrix();
      uniforms.pixel.value = 2 * Math.tan(FIELD_OF_VIEW * Math.PI / 360) / height;
    }

    function orbit(dx, dy) {
      const step = new THREE.Quaternion().setFromEuler(new THREE.Euler(-dy * 0.006, -dx * 0.006, 0, 'YXZ'));
      state.turn.multiply(step).normalize();
    }
    function pan(dx, dy) {
      const scale = uniforms.pixel.value * devicePixelRatio * state.distance;
      state.target.add(new THREE.Vector3(-dx * scale, dy * scale, 0).applyQuaternion(state.turn));
    }
    function zoom(factor) {
      state.distance = Math.min(40 * scene.radius, Math.max(scene.radius / 2000, state.distance * factor));
    }

    // Where these points fill the picture, seen from `view`.
    function pose(view, points, aspect) {
      const toward = vector(view.toward), up = vector(view.up);
      const right = new THREE.Vector3().crossVectors(up, toward).normalize();
      const turn = new THREE.Quaternion().setFromRotationMatrix(
        new THREE.Matrix4().makeBasis(right, new THREE.Vector3().crossVectors(toward, right), toward));
      const box = new THREE.Box3().setFromPoints(points.map((p) =>
        new THREE.Vector3(p.dot(right), p.dot(up), p.dot(toward))));
      const middle = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
      const half = Math.max(size.y, size.x / aspect, scene.radius / 200) / 2 / 0.68;
      return { target: right.clone().multiplyScalar(middle.x).addScaledVector(up, middle.y).addScaledVector(toward, middle.z),
        turn, distance: half / Math.tan(FIELD_OF_VIEW * Math.PI / 360) + size.z / 2 };
    }

    function jump(to) {
      state.target.copy(to.target);
      state.turn.copy(to.turn);
      state.distance = to.distance;
    }
    function fly(to) {
      const from = { target: state.target.clone(), turn: state.turn.clone(), distance: state.distance };
      const began = performance.now();
      const frame = (now) => {
        const share = Math.min(1, Math.max(0, (now - began) / 600)), eased = share * share * (3 - 2 * share);
        state.target.lerpVectors(from.target, to.target, eased);
        THREE.Quaternion.slerp(from.turn, to.turn, state.turn, eased);
        state.distance = from.distance * Math.pow(to.distance / from.distance, eased);
        redraw();
        if (share < 1) requestAnimationFrame(frame);
      };
      requestAnimationFrame(frame);
    }
    return { lens, state, apply, orbit, pan, zoom, pose, jump, fly };
  }

  // Left button or one finger turns; right or middle button, Shift, or two fingers move; wheel or pinch zooms.
  function steer(canvas, camera, redraw) {
    const fingers = new Map();
    const spread = () => {
      const [a, b] = [...fingers.values()];
      return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, gap: Math.hypot(a.x - b.x, a.y - b.y) };
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener('pointermove', (event) => {
      const finger = fingers.get(event.pointerId);
      if (!finger) return;
      const before = fingers.size === 2 ? spread() : null;
      const dx = event.clientX - finger.x, dy = event.clientY - finger.y;
      finger.x = event.clientX;
      finger.y = event.clientY;
      if (before) {
        const after = spread();
        camera.pan(after.x - before.x, after.y - before.y);
        camera.zoom(before.gap / Math.max(1, after.gap));
      } else if (event.shiftKey || (event.buttons & 6)) {
        camera.pan(dx, dy);
      } else {
        camera.orbit(dx, dy);
      }
      redraw();
    });
    const release = (event) => fingers.delete(event.pointerId);
    canvas.addEventListener('pointerup', release);
    canvas.addEventListener('pointercancel', release);
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(Math.max(-100, Math.min(100, event.deltaY)) * 0.0015));
      redraw();
    }, { passive: false });
  }

  // ------------------------------------------------------------------------------------------------ the page around it
  // Says station and deviation of the seam sample under the mouse.
  function readOut(canvas, camera) {
    const tip = document.getElementById('tip');
    const samples = scene.seams.flatMap((seam, k) => seam.samples.map((sample) => ({ k, sample, p: vector(sample) })))
      .concat([...scene.marks, ...scene.ellipsoids].map((mark) => ({ text: mark.text, p: vector(mark.p) })));
    const nearest = (event) => {
      const box = canvas.getBoundingClientRect();
      const x = event.clientX - box.left, y = event.clientY - box.top;
      let best = null, least = 12;
      for (const candidate of samples) {
        const p = candidate.p.clone().project(camera.lens);
        const gap = Math.hypot((p.x + 1) / 2 * box.width - x, (1 - p.y) / 2 * box.height - y);
        if (gap < least) { least = gap; best = { ...candidate, x, y }; }
      }
      return best;
    };
    canvas.addEventListener('pointermove', (event) => {
      const best = event.buttons ? null : nearest(event);
      tip.hidden = best === null;
      if (best === null) return;
      const [station, distance, sigma, modelled] = best.text ? [] : best.sample.slice(3);
      tip.textContent = best.text || `Seam ${best.k} · station ${station.toFixed(1)} mm · ` + (distance === null ? 'not checked' :
        `deviation ${distance.toFixed(3)} ± ${sigma.toFixed(3)} mm`) + (modelled ? ' · bridged' : '');
      tip.style.left = Math.min(best.x + 14, canvas.clientWidth - 300) + 'px';
      tip.style.top = (best.y + 16) + 'px';
    });
    canvas.addEventListener('pointerleave', () => { tip.hidden = true; });
    // A click that turned nothing asks for the section there.
    let pressed = null;
    canvas.addEventListener('pointerdown', (event) => { pressed = [event.clientX, event.clientY]; });
    canvas.addEventListener('pointerup', (event) => {
      const hit = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4 ? nearest(event) : null;
      if (hit && hit.sample) document.dispatchEvent(new CustomEvent('seampath-pick', { detail: { seam: hit.k, station: hit.sample[3] } }));
    });
  }

  // Arrow keys turn, + and - zoom, 0 shows all.
  function keys(canvas, camera, redraw, all) {
    const acts = { ArrowLeft: () => camera.orbit(-30, 0), ArrowRight: () => camera.orbit(30, 0),
      ArrowUp: () => camera.orbit(0, -30), ArrowDown: () => camera.orbit(0, 30),
      '+': () => camera.zoom(1 / 1.2), '-': () => camera.zoom(1.2), 0: all };
    canvas.addEventListener('keydown', (event) => {
      const act = acts[event.key];
      if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      act();
      redraw();
    });
  }

  // A bar of 1, 2 or 5 times a power of ten millimetres at the distance of the target.
  function scaleBar(camera) {
    const millimetres = 140 * uniforms.pixel.value * devicePixelRatio * camera.state.distance;
    const power = Math.pow(10, Math.floor(Math.log10(millimetres)));
    const length = power * (millimetres / power >= 5 ? 5 : millimetres / power >= 2 ? 2 : 1);
    const bar = document.getElementById('scale-bar');
    bar.style.width = (140 * length / millimetres) + 'px';
    bar.textContent = `${+length.toPrecision(1)} mm`;
  }

  // The scan's axes as seen now.
  function axisCross(camera) {
    const inverse = camera.state.turn.clone().inverse();
    for (const [name, direction] of [['x', [1, 0, 0]], ['y', [0, 1, 0]], ['z', [0, 0, 1]]]) {
      const seen = vector(direction).applyQuaternion(inverse);
      const line = document.getElementById('axis-' + name), letter = document.getElementById('letter-' + name);
      line.setAttribute('x2', 26 * seen.x);
      line.setAttribute('y2', -26 * seen.y);
      letter.setAttribute('x', 34 * seen.x);
      letter.setAttribute('y', -34 * seen.y + 3.5);
    }
  }

  // Share of the pixels that something was drawn on; a test, and a worried user, can tell a blank picture by it.
  function measure(renderer) {
    const gl = renderer.getContext();
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const ground = new THREE.Color(background()).toArray().map((c) => Math.round(255 * c));
    let drawn = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      drawn += ground.some((c, k) => Math.abs(pixels[i + k] - c) > 4) ? 1 : 0;
    }
    report('coverage', (drawn / (width * height)).toFixed(5));
  }

  function start() {
    const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    renderer.setPixelRatio(devicePixelRatio);
    renderer.setClearColor(background());
    const canvas = renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', (scene.marks.length > 0 ? '3D view of the features and of the uncertainty; all ' :
      '3D view of the scan with its seams, coloured by their deviation from it; all ') +
      'numbers are in the tables below. Arrow keys turn it, plus and minus zoom, 0 shows all.');
    const world = new THREE.Scene();
    const layers = {
      scan: scene.clouds.filter((cloud) => cloud.count > 0).map(pointCloud),
      seam: [new THREE.Group()],
      nodes: [balls(scene.seams.flatMap((seam) => seam.nodes.flat()), 11)],
      torch: [tubes(torchRings(0.16 * scene.radius), false)],
      marks: [balls(scene.marks.flatMap((mark) => mark.p), 11), tubes(arrowRings(scene.marks), false)],
      ellipsoids: scene.ellipsoids.map(ellipsoid)
    };
    const unculled = (object) => object.traverse((part) => { part.frustumCulled = false; });
    const place = new THREE.Group();                // the station whose section is shown
    layers.seam[0].add(place);
    function paint(colours) {
      layers.seam[0].children.slice().forEach((child) => { if (child !== place) layers.seam[0].remove(child); });
      layers.seam[0].add(tubes(scene.seams.flatMap((seam) => seamRings(seam, colours)), true));
      unculled(layers.seam[0]);
      for (const legend of document.querySelectorAll('[data-colours]')) {
        legend.hidden = legend.dataset.colours !== (colours === 'distance' ? 'distance' : 'signed');
      }
    }
    const chosen = document.getElementById('colours');
    paint(chosen ? chosen.value : 'distance');
    const objects = Object.values(layers).flat();
    objects.forEach(unculled);
    world.add(...objects);

    let waiting = false;
    const redraw = () => {
      if (!waiting) requestAnimationFrame(draw);
      waiting = true;
    };
    const camera = makeCamera(redraw);
    function draw() {
      waiting = false;
      camera.apply(canvas.width, canvas.height);
      renderer.render(world, camera.lens);
      scaleBar(camera);
      axisCross(camera);
    }
    function resize() {
      renderer.setSize(host.clientWidth, host.clientHeight);
      redraw();
    }

    for (const box of document.querySelectorAll('[data-layer]')) {
      const show = () => layers[box.dataset.layer].forEach((object) => { object.visible = box.checked; });
      box.checked = !hidden.has(box.dataset.layer) && box.checked;
      box.addEventListener('change', () => { show(); draw(); measure(renderer); });
      show();
    }
    chosen?.addEventListener('change', () => { paint(chosen.value); draw(); measure(renderer); });
    document.addEventListener('seampath-station', (event) => {
      const { seam, station } = event.detail;
      const gaps = scene.seams[seam].samples.map((sample) => Math.abs(sample[3] - station));
      const ball = balls(scene.seams[seam].samples[gaps.indexOf(Math.min(...gaps))].slice(0, 3), 19);
      place.children.slice().forEach((child) => place.remove(child));
      place.add(ball);
      unculled(place);
      redraw();
    });
    const ground = (colour) => { renderer.setClearColor(colour); draw(); };
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => ground(background()));
    addEventListener('beforeprint', () => ground(PAPER));
    addEventListener('afterprint', () => ground(background()));
    const points = (seams) => seams.flatMap((seam) => seam.samples.map(vector));
    const aspect = () => host.clientWidth / host.clientHeight;
    const everything = () => {
      const reach = scene.ellipsoids.flatMap((e) => e.axes.flatMap((axis) =>
        [1, -1].map((side) => vector(e.p).addScaledVector(vector(axis), side))));
      const all = points(scene.seams).concat(scene.marks.map((mark) => vector(mark.p)), reach);
      const r = 0.5 * scene.radius;
      return camera.pose(scene.camera, all.length > 1 ? all : [vector([-r, -r, -r]), vector([r, r, r])], aspect());
    };
    document.getElementById('fit').addEventListener('click', () => camera.fly(everything()));
    for (const row of document.querySelectorAll('[data-seam]')) {
      const seam = scene.seams[+row.dataset.seam];
      row.addEventListener('click', () => {
        if (seam.samples.length < 2) return;
        camera.fly(camera.pose(seam.camera, points([seam]), aspect()));
        host.scrollIntoView({ block: 'nearest', behavior: 'smooth' });
      });
    }
    host.append(canvas);
    host.classList.add('live');
    steer(canvas, camera, redraw);
    keys(canvas, camera, redraw, () => camera.jump(everything()));
    readOut(canvas, camera);
    addEventListener('resize', resize);
    renderer.setSize(host.clientWidth, host.clientHeight);
    camera.jump(everything());
    draw();
    measure(renderer);
    report('milliseconds', Math.round(performance.now()));
  }

  loadThree().then(start).catch((error) => {
    report('error', String(error));
    document.getElementById('view-note').textContent = 'This browser shows no 3D view (WebGL is off or too old); this is a still picture.';
  });
})();
