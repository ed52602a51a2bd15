// The machine in three dimensions, on three.js: read from the same GLB that lies beside the report, turned with theta.
// It starts after the page's first paint; without WebGL the drawing stays, and pictures of parts and steps are painted here.
(() => {
  const byId = id => document.getElementById(id), text = id => byId(id).textContent;
  const bytes = packed => Uint8Array.from(atob(packed), c => c.charCodeAt(0));
  const unpacked = id => new Response(new Blob([bytes(text(id))]).stream().pipeThrough(new DecompressionStream("gzip")));
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;

  async function start() {
    const canvas = byId("machine");
    const context = canvas && picture(canvas);  // at first: the browser makes it ready while the library is unpacked
    if (!canvas) return;
    if (!context) {
      const flat = "This browser has WebGL 2 switched off: the machine is drawn flat, and pictures of parts and steps are drawn slowly.";
      const say = () => Object.assign(document.createElement("p"), { className: "flat", textContent: flat });
      document.querySelector(".legend").append(say());
      byId("bench")?.closest(".bench").before(say());
    }
    const library = document.createElement("script"), machine = unpacked("glb").arrayBuffer();
    library.textContent = await unpacked("three").text();
    document.head.append(library);
    if (context) drawing = asked => new THREE.WebGLRenderer(asked);
    show(drawing({ canvas, context }), canvas, read(await machine), JSON.parse(text("lying")), Boolean(context));
  }
  let drawing = painter;  // what makes a renderer for a canvas

  let slow = false;  // whether a processor draws: then edges are not smoothed
  function picture(canvas) {
    const asked = { alpha: true, stencil: true, depth: true, preserveDrawingBuffer: true };
    const fast = canvas.getContext("webgl2", { ...asked, antialias: true, failIfMajorPerformanceCaveat: true });
    slow = !fast;
    return fast || canvas.getContext("webgl2", { ...asked, antialias: false });
  }

  // ---- without WebGL: triangles and lines with their depths, of pixels ----

  function painter({ canvas }) {
    let frame = null;  // left, top, width and height of what is painted
    const size = (width, height) => { Object.assign(canvas, { width, height }); frame = [0, 0, width, height]; };
    size(canvas.width, canvas.height);
    return {
      domElement: canvas, setPixelRatio() {}, setSize: size, setScissor() {}, setScissorTest() {},
      setViewport(left, low, width, height) { frame = [left, canvas.height - low - height, width, height].map(Math.round); },
      render(scene, camera) {
        scene.updateMatrixWorld();
        camera.updateMatrixWorld();
        const [left, top, width, height] = frame, picture = new ImageData(width, height), depths = new Float32Array(width * height).fill(1);
        const all = [];
        scene.traverse(thing => { if (thing.geometry?.attributes.position) all.push(thing); });
        const late = ({ material }) => 2 * (material.depthTest === false) + material.transparent;  // what is seen through comes last
        all.sort((a, b) => late(a) - late(b)).forEach(thing => paintThing(thing, camera, picture, depths));
        canvas.getContext("2d").putImageData(picture, left, top);
      },
    };
  }
  function paintThing({ geometry, material, matrixWorld, isLineSegments }, camera, { data, width, height }, depths) {
    const { array, count } = geometry.attributes.position, m = camera.matrixWorldInverse.clone().multiply(matrixWorld).elements, p = camera.projectionMatrix.elements;
    const seen = new Float32Array(3 * count), screen = new Float32Array(3 * count);
    for (let k = 0; k < 3 * count; k += 3) {
      const [x, y, z] = [0, 1, 2].map(n => m[n] * array[k] + m[n + 4] * array[k + 1] + m[n + 8] * array[k + 2] + m[n + 12]);
      seen.set([x, y, z], k);
      screen.set([(1 - p[0] * x / z) * width / 2, (1 + p[5] * y / z) * height / 2, -(p[10] * z + p[14]) / z], k);
    }
    const hex = material.color.getHex(), tone = [hex >> 16, hex >> 8 & 255, hex & 255], opaque = material.opacity, tested = material.depthTest !== false;
    const dot = (x, y, z, light) => {
      if (x < 0 || y < 0 || x >= width || y >= height) return;
      const at = y * width + x;
      if (tested && z > depths[at]) return;
      if (tested && material.depthWrite !== false) depths[at] = z;
      const own = opaque, under = (1 - own) * data[4 * at + 3] / 255, cover = own + under;
      tone.forEach((value, n) => { data[4 * at + n] = (own * Math.min(255, light * value) + under * data[4 * at + n]) / cover; });
      data[4 * at + 3] = 255 * cover;
    };
    const point = k => screen.subarray(3 * k, 3 * k + 3);
    if (isLineSegments) {
      for (let k = 0; k < count; k += 2) {
        const [ax, ay, az] = point(k), [bx, by, bz] = point(k + 1), steps = Math.ceil(Math.max(Math.abs(bx - ax), Math.abs(by - ay))) || 1;
        for (let n = 0; n <= steps; n++) dot(Math.floor(ax + (bx - ax) * n / steps), Math.floor(ay + (by - ay) * n / steps), az + (bz - az) * n / steps - 1e-4, 1);
      }
      return;
    }
    const lit = material.isMeshLambertMaterial;
    for (let k = 0; k < count; k += 3) {
      const [ax, ay, az] = point(k), [bx, by, bz] = point(k + 1), [cx, cy, cz] = point(k + 2), area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      if (!area || (area > 0 && material.side === THREE.FrontSide)) continue;  // y runs down
      const side = (n, j) => seen[3 * (k + n) + j] - seen[3 * k + j];
      const normal = [0, 1, 2].map(j => side(1, (j + 1) % 3) * side(2, (j + 2) % 3) - side(1, (j + 2) % 3) * side(2, (j + 1) % 3));
      const light = lit ? 0.55 + 0.5 * Math.max(0, (0.5 * normal[1] + 0.86 * normal[2]) / Math.hypot(...normal)) : 1;
      const high = Math.min(height - 1, Math.floor(Math.max(ay, by, cy))), right = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx)));
      for (let y = Math.max(0, Math.floor(Math.min(ay, by, cy))); y <= high; y++) for (let x = Math.max(0, Math.floor(Math.min(ax, bx, cx))); x <= right; x++) {
        const u = x + 0.5, v = y + 0.5;
        const b = ((u - ax) * (cy - ay) - (v - ay) * (cx - ax)) / area, c = ((bx - ax) * (v - ay) - (by - ay) * (u - ax)) / area;
        if (b >= 0 && c >= 0 && b + c <= 1) dot(x, y, az + b * (bz - az) + c * (cz - az), light);
      }
    }
  }

  // ---- reading the GLB ----

  function read(buffer) {
    const view = new DataView(buffer), size = view.getUint32(12, true);
    const file = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 20, size)));
    const kinds = { 5126: Float32Array, 5123: Uint16Array, 5125: Uint32Array }, wide = { SCALAR: 1, VEC3: 3, VEC4: 4 };
    const array = number => {
      const accessor = file.accessors[number], Kind = kinds[accessor.componentType];
      return new Kind(buffer, 28 + size + file.bufferViews[accessor.bufferView].byteOffset, accessor.count * wide[accessor.type]);
    };
    const parts = file.meshes.map((mesh, k) => {
      const { attributes, indices } = mesh.primitives[0];
      return { name: mesh.name, number: k, ...surfaces(array(attributes.POSITION), array(indices)) };
    });
    const channels = (file.animations || []).flatMap(turn => turn.channels.map(channel => ({
      node: channel.target.node, path: channel.target.path, values: array(turn.samplers[channel.sampler].output),
    })));
    const copies = [];
    const bodies = file.nodes[0].children.map(number => {
      const node = file.nodes[number], group = new THREE.Group();
      group.quaternion.fromArray(node.rotation);
      group.position.fromArray(node.translation);
      node.children.forEach(child => copies.push({ part: parts[file.nodes[child].mesh], matrix: file.nodes[child].matrix || [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], group }));
      return { group, channels: channels.filter(channel => channel.node === number) };
    });
    // The file's root says what is up: it turns the machine so that up is y and its front z.
    return { parts, copies, bodies, stands: new THREE.Quaternion().fromArray(file.nodes[0].rotation).invert() };
  }

  // Corners with normals that are shared over edges of less than 30 deg, and the sharper edges as lines.
  function surfaces(places, faces) {
    const wide = faces.length, count = wide / 3, limit = Math.cos(Math.PI / 6);
    const corners = new Float32Array(3 * wide), flat = new Float32Array(wide), normals = new Float32Array(3 * wide), lines = [];
    for (let i = 0; i < wide; i++) for (let n = 0; n < 3; n++) corners[3 * i + n] = places[3 * faces[i] + n];
    for (let f = 0; f < wide; f += 3) {
      const c = 3 * f, side = (k, n) => corners[c + 3 * k + n] - corners[c + n];
      const cross = [0, 1, 2].map(n => side(1, (n + 1) % 3) * side(2, (n + 2) % 3) - side(1, (n + 2) % 3) * side(2, (n + 1) % 3));
      const size = Math.hypot(...cross) || 1;
      for (let n = 0; n < 3; n++) flat[f + n] = cross[n] / size;
    }
    // of each point its corners, one after the other: those of point v are used[begin[v]] to used[begin[v + 1]]
    const begin = new Uint32Array(places.length / 3 + 1), used = new Uint32Array(wide);
    faces.forEach(v => begin[v + 1]++);
    for (let v = 1; v < begin.length; v++) begin[v] += begin[v - 1];
    const next = begin.slice();
    faces.forEach((v, i) => { used[next[v]++] = i; });
    const after = i => i % 3 === 2 ? i - 2 : i + 1;
    for (let i = 0; i < wide; i++) {
      const f = i - i % 3, here = faces[i], there = faces[after(i)];
      let x = 0, y = 0, z = 0;
      for (let k = begin[here]; k < begin[here + 1]; k++) {
        const j = used[k], g = j - j % 3;
        const alike = flat[f] * flat[g] + flat[f + 1] * flat[g + 1] + flat[f + 2] * flat[g + 2] > limit;
        if (alike) { x += flat[g]; y += flat[g + 1]; z += flat[g + 2]; }
        else if (f < g && faces[after(after(j))] === there) for (const end of [here, there]) lines.push(places[3 * end], places[3 * end + 1], places[3 * end + 2]);
      }
      const size = Math.hypot(x, y, z) || 1;
      normals.set([x / size, y / size, z / size], 3 * i);
    }
    const solid = new THREE.BufferGeometry(), edges = new THREE.BufferGeometry();
    solid.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    solid.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    edges.setAttribute("position", new THREE.BufferAttribute(new Float32Array(lines), 3));
    solid.computeBoundingSphere();
    return { solid, edges, ends: extremes(places) };
  }
  // Of points, x, y and z by turns, those that are farthest in 16 directions round z, each at these slopes: the last finds the rim
  // of what stands highest, however slender it is.
  const slopes = [0, 1, -1, 3, -3, 1000, -1000];
  function extremes(places) {
    const found = new Set();
    for (let k = 0; k < 16 * slopes.length; k++) {
      const angle = (k % 16) * Math.PI / 8, x = Math.cos(angle), y = Math.sin(angle), z = slopes[Math.floor(k / 16)];
      let far = -Infinity, at = 0;
      for (let i = 0; i < places.length; i += 3) {
        const reach = x * places[i] + y * places[i + 1] + z * places[i + 2];
        if (reach > far) { far = reach; at = i; }
      }
      found.add(at);
    }
    return [...found].map(i => new THREE.Vector3(places[i], places[i + 1], places[i + 2]));
  }

  // ---- scenes ----

  function lit(scene) {
    scene.add(new THREE.HemisphereLight(0xffffff, 0x8090a0, 1.6));
    const sun = new THREE.DirectionalLight(0xffffff, 1.9);
    scene.add(sun);
    return sun;
  }
  function object(part, material, edge) {
    const group = new THREE.Group();
    group.add(new THREE.Mesh(part.solid, material), new THREE.LineSegments(part.edges, edge));
    group.matrixAutoUpdate = false;
    return group;
  }
  const surface = more => new THREE.MeshLambertMaterial({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...more });
  const variable = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const colour = k => new THREE.Color(variable("--p" + k) || "#888888");
  // The first view: from the front, above and right. stands: turns y up and z forward into the machine's axes.
  const ahead = stands => new THREE.Vector3(0.55, 0.9, 1).normalize().applyQuaternion(stands);
  // A step: in which direction a thing comes, and from where it is seen, which is from below where it comes from there.
  const direction = ({ way, along }) => new THREE.Vector3(...(along || [0, 0, way]));
  const seen = step => step.laid ? new THREE.Vector3(0.1, -0.7, 1).normalize() : ahead(lain()).multiply(new THREE.Vector3(1, 1, direction(step).z > 0 ? -1 : 1));
  const lain = () => new THREE.Quaternion(Math.SQRT1_2, 0, 0, Math.SQRT1_2);  // z is up: parts by themselves, and what is on the bench
  function eye(stands) {
    const camera = new THREE.PerspectiveCamera(28, 1, 1, 1000);
    camera.up.set(0, 1, 0).applyQuaternion(stands);
    return camera;
  }
  const fill = 0.94;  // share of the picture
  function look(camera, points, from) {  // from a direction, so that the points just fit the picture
    const up = fill * Math.tan(camera.fov * Math.PI / 360), across = up * camera.aspect, place = new THREE.Vector3();
    camera.position.copy(from);
    camera.lookAt(place);
    const turned = camera.quaternion.clone().invert();
    let right = -Infinity, left = -Infinity, top = -Infinity, low = -Infinity, near = -Infinity, far = Infinity;
    points.forEach(point => {
      place.copy(point).applyQuaternion(turned);
      right = Math.max(right, place.x + place.z * across);
      left = Math.max(left, place.z * across - place.x);
      top = Math.max(top, place.y + place.z * up);
      low = Math.max(low, place.z * up - place.y);
      near = Math.max(near, place.z);
      far = Math.min(far, place.z);
    });
    const away = Math.max((right + left) / (2 * across), (top + low) / (2 * up)), middle = (near + far) / 2;
    const centre = new THREE.Vector3((right - left) / 2, (top - low) / 2, middle).applyQuaternion(camera.quaternion);
    const radius = new THREE.Box3().setFromPoints(points).getSize(place).length() / 2;
    camera.position.copy(centre).addScaledVector(from, away - middle);
    camera.near = (away - middle) / 50;
    camera.far = away - middle + 20 * radius;
    camera.updateProjectionMatrix();
    return new THREE.Sphere(centre, radius);
  }

  // Corners of triangles: bands of half a width along lines, and discs, from a height to another one.
  function walled(ring, low, high, out) {  // a prism, or what it stands on where it has no height; out: its corners
    ring.forEach(([x, y], k) => {
      const [u, v] = ring[(k + 1) % ring.length];
      if (k > 1) out.push(...ring[0], high, ...ring[k - 1], high, x, y, high);
      if (k > 1 && high > low) out.push(...ring[0], low, x, y, low, ...ring[k - 1], low);
      if (high > low) out.push(x, y, low, u, v, low, u, v, high, x, y, low, u, v, high, x, y, high);
    });
    return out;
  }
  function bands(lines, discs, half, low, high) {
    const out = [], prism = ring => walled(ring, low, high, out);
    lines.forEach(line => line.slice(1).forEach(([u, v], k) => {
      const [x, y] = line[k], size = Math.hypot(u - x, v - y) || 1, a = half * (y - v) / size, b = half * (u - x) / size;
      prism([[x - a, y - b], [u - a, v - b], [u + a, v + b], [x + a, y + b]]);
    }));
    discs.forEach(([x, y, radius]) => prism([...Array(48).keys()].map(k => [x + radius * Math.cos(k * Math.PI / 24), y + radius * Math.sin(k * Math.PI / 24)])));
    return new THREE.BufferAttribute(new Float32Array(out), 3);
  }

  // A camera that a person steers: by a pointer, and while its canvas has the focus by the wheel and by keys.
  // moved: something is to be drawn; home: the first view is wanted; tap: a click or a touch at a place of the window.
  function steered(canvas, camera, { moved, home, tap }) {
    const focused = () => document.activeElement === canvas;
    let pressed = null;
    canvas.addEventListener("pointerdown", event => {
      pressed = event.isPrimary ? event : null;
      if (event.pointerType === "touch" && !focused()) event.stopImmediatePropagation();
    });
    canvas.addEventListener("pointerup", event => {
      if (!pressed || Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > 8) return;
      canvas.focus({ preventScroll: true });
      tap(event.clientX, event.clientY);
    });
    // The wheel and a finger move the page until the view has the focus.
    canvas.addEventListener("wheel", event => { if (!focused()) event.stopImmediatePropagation(); }, { passive: true });
    const touched = () => { canvas.style.touchAction = focused() ? "none" : "auto"; };
    const controls = new THREE.OrbitControls(camera, canvas), before = new THREE.Vector3();
    const upright = new THREE.Quaternion().setFromUnitVectors(camera.up, new THREE.Vector3(0, 1, 0));
    const hand = { held: false, aim, target: controls.target };  // held: whether a person has turned or moved the view
    controls.enableDamping = false;
    ["focus", "blur"].forEach(name => canvas.addEventListener(name, touched));
    touched();
    controls.addEventListener("start", () => before.copy(camera.position));
    controls.addEventListener("end", () => { hand.held ||= !before.equals(camera.position); });
    controls.addEventListener("change", moved);
    canvas.addEventListener("keydown", event => {
      const round = new THREE.Vector3().subVectors(camera.position, controls.target);
      const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
      const zoom = { "+": 1 / 1.1, "=": 1 / 1.1, "-": 1.1 }[event.key];
      if (turns) {
        round.applyQuaternion(upright);  // y is up
        const flat = Math.hypot(round.x, round.z), height = Math.atan2(round.y, flat), far = round.length();
        const along = Math.atan2(round.x, round.z) + turns[0], up = Math.max(-1.55, Math.min(1.55, height + turns[1]));
        round.set(far * Math.cos(up) * Math.sin(along), far * Math.sin(up), far * Math.cos(up) * Math.cos(along));
        round.applyQuaternion(upright.clone().invert());
      } else if (zoom) round.multiplyScalar(zoom);
      else if (event.key === "0" || event.key === "Home") { home(); return; }
      else return;
      event.preventDefault();
      hand.held = true;
      camera.position.copy(controls.target).add(round);
      controls.update();
      moved();
    });
    function aim(points, from) {  // at what is to fill the picture; from where it is now unless said
      from ||= new THREE.Vector3().subVectors(camera.position, controls.target).normalize();
      const ball = look(camera, points, from);
      controls.target.copy(ball.center);
      controls.update();
      moved();
      return ball;
    }
    return hand;
  }

  function show(renderer, canvas, machine, lying, solid) {
    const { parts, copies, bodies, stands } = machine;
    const scene = new THREE.Scene(), camera = eye(stands), sun = lit(scene);
    const plane = new THREE.Plane(), cut = { axis: "", share: 0.5 };
    const edge = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 });
    renderer.localClippingEnabled = true;
    renderer.autoClearStencil = true;
    renderer.setPixelRatio(slow ? 1 : Math.min(2, devicePixelRatio));
    parts.forEach(part => { part.material = surface(); });
    bodies.forEach(body => scene.add(body.group));
    copies.forEach((copy, k) => {
      copy.shown = object(copy.part, copy.part.material, edge);
      copy.home = new THREE.Matrix4().fromArray(copy.matrix);
      // exploded by steps, those of what is built apart the other way round, for it is turned over; within a step by height
      const last = lying.steps.length, step = lying.steps.findIndex(step => step.copies.includes(k));
      const place = step < 0 ? last : lying.steps[step].up?.[2] < 0 ? 2 * last - step : step;
      copy.order = 1e9 * place + Math.round(1e3 * copy.matrix[14]);
      copy.group.add(copy.shown);
    });
    const steps = [...new Set(copies.map(copy => copy.order))].sort((a, b) => a - b);
    copies.forEach(copy => { copy.rank = steps.indexOf(copy.order) - (steps.length - 1) / 2; });

    // -- where all is at an angle --
    const q = new THREE.Quaternion(), p = new THREE.Vector3();
    let apart = false;  // exploded
    function turn(turned) {
      bodies.forEach(body => body.channels.forEach(({ path, values }) => {
        const wide = path === "rotation" ? 4 : 3, n = values.length / wide - 1, place = turned * n;
        const i = Math.min(n - 1, Math.floor(place)), share = place - i;
        if (path === "rotation") body.group.quaternion.fromArray(values, 4 * i).slerp(q.fromArray(values, 4 * i + 4), share);
        else body.group.position.fromArray(values, 3 * i).lerp(p.fromArray(values, 3 * i + 3), share);
      }));
      sketches.forEach(({ k, copy, course, swell, mesh, half, low }) => {
        const pose = camgen.poseAt(copy, turned);
        mesh.visible = Boolean(pose) && !apart && shown(k);
        if (course && mesh.visible) {
          const flat = camgen.courseAt(k, turned), line = [];
          for (let n = 0; n < flat.length; n += 2) line.push([flat[n], flat[n + 1], low + (swell ? swell[n / 2] : 0)]);
          mesh.geometry.setAttribute("position", swell ? tube(line).getAttribute("position") : bands([line], [], half, low, low));
        } else if (pose) {
          mesh.rotation.z = pose[0] * Math.PI / 180;
          mesh.position.set(pose[1], pose[2], 0);
        }
        mesh.updateMatrixWorld();
      });
    }
    const shown = k => document.querySelector('.legend [data-body="' + k + '"]')?.checked ?? true;

    // -- what is no part: paths, threads, springs, the follower of a cam alone; the drawing has their shapes --
    const uses = [...document.querySelectorAll("#mechanism use")];
    const sketches = Object.entries(camgen.heights).map(([k, [low, high]]) => {
      const symbol = byId("body-" + k), copy = uses.findIndex(use => use.getAttribute("href") === "#body-" + k);
      const discs = [...symbol.querySelectorAll("circle")].map(disc => ["cx", "cy", "r"].map(name => Number(disc.getAttribute(name))));
      const lines = [...symbol.querySelectorAll("path")].flatMap(path => path.getAttribute("d").split("M").slice(1))
        .map(line => line.split("L").map(place => place.split(" ").map(Number)));
      const half = Math.max(0.4, 0.4 * Math.min(...discs.map(disc => disc[2]), 10)), side = THREE.DoubleSide;
      const mesh = new THREE.Mesh(new THREE.BufferGeometry(), high > low
        ? new THREE.MeshLambertMaterial({ side, transparent: true, opacity: 0.45, depthWrite: false }) : new THREE.MeshBasicMaterial({ side }));
      mesh.geometry.setAttribute("position", bands(lines, discs, discs.length ? half : 0.4, low, high));
      mesh.geometry.computeVertexNormals();
      mesh.frustumCulled = false;
      const stands = new THREE.Group();
      if (camgen.upright.includes(k)) stands.quaternion.set(0.5, -0.5, -0.5, 0.5);  // its x is -y, its y is z
      stands.updateMatrixWorld();
      stands.add(mesh);
      scene.add(stands);
      return { k, copy, course: Boolean(camgen.courseAt(k, 0)), swell: camgen.swells[k], mesh, half: 0.4, low, ends: extremes(mesh.geometry.attributes.position.array) };
    });

    // -- all places where something comes, with the copy that comes there; apart, copies are lifted --
    const reach = [], moments = 24;
    copies.forEach(copy => { copy.shown.matrix.copy(copy.home); copy.lift = 0; });
    for (let moment = 0; moment < moments; moment++) {
      turn(moment / moments);
      scene.updateMatrixWorld(true);
      copies.forEach(copy => copy.part.ends.forEach(end => reach.push([end.clone().applyMatrix4(copy.shown.matrixWorld), copy])));
      sketches.forEach(({ mesh, ends }) => ends.forEach(end => reach.push([end.clone().applyMatrix4(mesh.matrixWorld), null])));
    }
    const box = new THREE.Box3().setFromPoints(reach.filter(([, copy]) => copy).map(([place]) => place));
    const radius = box.getBoundingSphere(new THREE.Sphere()).radius;
    let ball = new THREE.Sphere();
    function spread(share) {
      apart = share > 0 && steps.length > 1;
      const gap = steps.length > 1 ? share * 1.7 * radius / (steps.length - 1) : 0;
      copies.forEach(copy => {
        copy.lift = copy.rank * gap;
        copy.shown.matrix.makeTranslation(0, 0, copy.lift).multiply(copy.home);
        copy.shown.matrixWorldNeedsUpdate = true;
      });
      turn(now());
    }
    const now = () => camgen.turned(Number(byId("theta").value));

    // -- section: of each copy its back faces less its front faces are where the plane lies inside; there a cap is drawn --
    const caps = new THREE.Group();
    scene.add(caps);
    function capped() {
      caps.clear();
      copies.forEach(copy => copy.shown.children.filter(child => child.userData.counts).forEach(child => copy.shown.remove(child)));
      const planes = cut.axis ? [plane] : [];
      parts.forEach(part => { Object.assign(part.material, { clippingPlanes: planes, needsUpdate: true }); });
      Object.assign(edge, { clippingPlanes: planes, needsUpdate: true });
      pick(picked);
      if (!cut.axis) return;
      const whole = new THREE.PlaneGeometry(8 * ball.radius, 8 * ball.radius);
      copies.forEach((copy, k) => {
        for (const [side, change] of [[THREE.BackSide, THREE.IncrementWrapStencilOp], [THREE.FrontSide, THREE.DecrementWrapStencilOp]]) {
          const counts = new THREE.Mesh(copy.part.solid, new THREE.MeshBasicMaterial({
            side, clippingPlanes: planes, depthWrite: false, depthTest: false, colorWrite: false, stencilWrite: true,
            stencilFunc: THREE.AlwaysStencilFunc, stencilFail: change, stencilZFail: change, stencilZPass: change,
          }));
          counts.userData.counts = true;
          counts.renderOrder = k + 1.1;
          copy.shown.add(counts);
        }
        const cap = new THREE.Mesh(whole, new THREE.MeshBasicMaterial({
          color: copy.part.material.color.clone().multiplyScalar(0.8), side: THREE.DoubleSide, stencilWrite: true, stencilRef: 0,
          stencilFunc: THREE.NotEqualStencilFunc, stencilFail: THREE.ZeroStencilOp, stencilZFail: THREE.ZeroStencilOp,
          stencilZPass: THREE.ZeroStencilOp,
        }));
        cap.visible = copy.shown.visible;
        cap.renderOrder = k + 1.2;
        cap.onAfterRender = () => renderer.clearStencil();
        caps.add(cap);
      });
    }
    function aim() {  // the plane, what is cut off towards the camera, and the caps on it
      if (!cut.axis) return;
      const axis = cut.axis, normal = new THREE.Vector3(+(axis === "x"), +(axis === "y"), +(axis === "z"));
      const where = box.min[axis] + cut.share * (box.max[axis] - box.min[axis]);
      const side = camera.position[axis] > where ? -1 : 1;
      plane.normal.copy(normal).multiplyScalar(side);
      plane.constant = -side * where;
      caps.children.forEach(cap => {
        cap.position.copy(ball.center);
        cap.position[axis] = where;
        cap.lookAt(p.copy(cap.position).add(normal));
      });
    }

    // -- one part is named, with its holes as its drawing calls them --
    let picked = -1;  // number of its copy
    const name = byId("part"), labels = byId("holes");
    function pick(k) {
      copies.forEach(copy => { copy.shown.children[0].material = copy.part.material; });
      picked = k;
      name.hidden = k < 0;
      labels.replaceChildren();
      if (k < 0) return;
      const { part, shown } = copies[k], [title, holes] = lying.parts[part.number] || ["", []];
      const bright = shown.children[0].material = part.material.clone();
      bright.clippingPlanes = part.material.clippingPlanes;
      bright.emissive.copy(part.material.color).lerp(new THREE.Color(1, 1, 1), 0.35).multiplyScalar(0.6);
      const called = part.name.replaceAll("_", " "), kinds = new Map(holes.map(([, shape]) => [shape, []]));
      holes.forEach(([label, shape]) => kinds.get(shape).push(label));
      const said = [...kinds].slice(0, 6).map(([shape, alike]) => alike.join(", ") + " (" + shape + ")");
      name.textContent = (title.toLowerCase().includes(called) ? title : called + ": " + title) +
        (holes.length ? "; holes " + said.join("; ") + (kinds.size > 6 ? "; and others" : "") : "");
      labels.append(...holes.map(([label]) => Object.assign(document.createElement("b"), { textContent: label })));
    }
    function placed() {  // the labels, and where they are in the picture, px
      const { clientWidth: width, clientHeight: height } = canvas;
      return [...labels.children].map((label, n) => {
        const { part, shown } = copies[picked], at = p.set(...lying.parts[part.number][1][n][2]).applyMatrix4(shown.matrixWorld).project(camera);
        return [label, (at.x + 1) / 2 * width, (1 - at.y) / 2 * height];
      });
    }
    const ray = new THREE.Raycaster();
    function under(x, y) {  // number of the copy that is seen there, -1 of none
      const frame = canvas.getBoundingClientRect();
      ray.setFromCamera({ x: 2 * (x - frame.left) / frame.width - 1, y: 1 - 2 * (y - frame.top) / frame.height }, camera);
      const seen = copies.filter(copy => copy.shown.visible).map(copy => copy.shown.children[0]);
      const hit = ray.intersectObjects(seen, false).find(({ point }) => !cut.axis || plane.distanceToPoint(point) >= 0);
      return hit ? copies.findIndex(copy => copy.shown.children[0] === hit.object) : -1;
    }
    canvas.title = "Drag to turn; click a part for its name, then the wheel zooms";

    // -- what the page says of parts --
    function dress() {
      parts.forEach(part => {
        part.material.color.copy(colour(part.number));
        copies.filter(copy => copy.part === part).forEach(copy => { copy.shown.visible = shown(part.number); });
      });
      sketches.forEach(({ k, mesh }) => mesh.material.color.copy(colour(k)));
      if (picked >= 0 && !copies[picked].shown.visible) picked = -1;
      turn(now());
      edge.color.set(variable("--ink"));
      capped();
    }

    // -- drawing, only when something has changed --
    let wanted = false;
    function ask() {
      if (wanted || canvas.hidden) return;
      wanted = true;
      requestAnimationFrame(() => {
        wanted = false;
        sun.position.copy(camera.position).addScaledVector(camera.up, ball.radius);
        aim();
        renderer.render(scene, camera);
        placed().forEach(([label, x, y]) => { label.style.transform = "translate(" + x + "px, " + y + "px) translate(-50%, -50%)"; });
        canvas.dataset.drawn = Number(canvas.dataset.drawn || 0) + 1;
      });
    }
    function fit() {
      const { clientWidth: width, clientHeight: height } = canvas;
      if (!width || !height) return;
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      if (!hand.held) frame(ahead(stands));
      ask();
    }
    function frame(from) {  // all that comes into sight over a turn
      const lifted = ([place, copy]) => copy ? p.copy(place).setZ(place.z + copy.lift).clone() : place;
      ball = hand.aim(reach.filter(([, copy]) => copy || !apart).map(lifted), from);
    }
    function home() {  // as at first
      hand.held = false;
      byId("explode").value = 0;
      byId("section").value = cut.axis = "";
      byId("cut").hidden = true;
      pick(-1);
      capped();
      spread(0);
      frame(ahead(stands));
    }
    canvas.addEventListener("keydown", event => {
      if (event.key === " ") byId("play").click();
      else if (event.key === "Enter" || event.key === "Escape") {
        const seen = [...copies.keys()].filter(k => copies[k].shown.visible);
        pick(event.key === "Enter" ? seen.find(k => k > picked) ?? -1 : -1);
        if (event.key === "Escape") canvas.blur();
        ask();
      }
      if (event.key === " ") event.preventDefault();
    });
    const hand = steered(canvas, camera, { moved: ask, home, tap: (x, y) => { pick(under(x, y)); ask(); } });

    // -- the tools --
    const svg = byId("mechanism"), flat = byId("flat");
    function plain(drawing) {
      canvas.hidden = drawing;
      svg.style.display = drawing ? "" : "none";
      camgen.solid = !drawing;
      labels.hidden = byId("save").hidden = drawing;
      if (drawing) pick(-1);
      flat.setAttribute("aria-pressed", drawing);
      if (drawing) camgen.draw(); else fit();
    }
    document.querySelector(".tools").hidden = !solid;
    flat.addEventListener("click", () => plain(!canvas.hidden));
    byId("home").addEventListener("click", home);
    const player = document.querySelector(".player"), full = byId("full");
    full.hidden = !document.fullscreenEnabled;
    full.addEventListener("click", () => document.fullscreenElement ? document.exitFullscreen() : player.requestFullscreen());
    document.addEventListener("fullscreenchange", () => { full.textContent = document.fullscreenElement ? "Leave full screen" : "Full screen"; });
    byId("save").addEventListener("click", () => {  // 1600 pixels wide or more, on the page's ground, with the names of holes
      const sheet = document.createElement("canvas"), ratio = renderer.getPixelRatio(), picture = sheet.getContext("2d");
      const fine = Math.max(2, 1600 / canvas.clientWidth);
      renderer.setPixelRatio(fine);
      renderer.render(scene, camera);
      Object.assign(sheet, { width: canvas.width, height: canvas.height });
      picture.fillStyle = variable("--card");
      picture.fillRect(0, 0, sheet.width, sheet.height);
      picture.drawImage(canvas, 0, 0);
      Object.assign(picture, { fillStyle: variable("--ink"), font: "bold " + 12 * fine + "px sans-serif", textAlign: "center", textBaseline: "middle", strokeStyle: variable("--card"), lineWidth: 4 * fine, lineJoin: "round" });
      placed().forEach(([label, x, y]) => ["strokeText", "fillText"].forEach(write => picture[write](label.textContent, fine * x, fine * y)));
      renderer.setPixelRatio(ratio);
      ask();
      sheet.toBlob(file => {
        const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(file), download: document.querySelector("h1").textContent + ".png" });
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 1000);
      });
    });
    byId("explode").closest("label").hidden = steps.length < 2;
    byId("explode").addEventListener("input", event => {
      spread(Number(event.target.value));
      frame();
    });
    byId("section").addEventListener("change", event => { cut.axis = event.target.value; byId("cut").hidden = !cut.axis; capped(); ask(); });
    byId("cut").addEventListener("input", event => { cut.share = Number(event.target.value); ask(); });
    document.addEventListener("parts", () => { dress(); ask(); });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { dress(); ask(); smalls.forEach(paint); built.dress(); });

    turn(0);
    const standing = copies.map(({ group, home }) => new THREE.Matrix4().compose(group.position, group.quaternion, group.scale).multiply(home));
    const built = bench(copies, standing, lying);
    dress();
    plain(!solid);
    spread(0);
    frame(ahead(stands));
    if (solid && matchMedia("(pointer: coarse)").matches) {
      name.textContent = "Tap, then turn and zoom";
      name.hidden = false;
    }
    camgen.follow(deg => { turn(camgen.turned(deg)); ask(); });
    new ResizeObserver(fit).observe(canvas);

    // -- small views of parts, plates and steps: one renderer draws them one after the other as they come into sight --
    const pale = { transparent: true, opacity: 0.4, depthWrite: false };
    const smalls = [...document.querySelectorAll(".small")];
    let small;
    function paint(target) {
      if (!target.dataset.seen) return;
      small ||= drawing({ canvas: Object.assign(document.createElement("canvas"), { width: 320, height: 220 }), alpha: true, antialias: !slow });
      const [what, number] = target.dataset.view.split("-"), scene = new THREE.Scene(), sun = lit(scene);
      const line = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.6, color: variable("--ink") }), reach = [];
      const put = (part, matrix, faint, tone) => {
        const item = object(part, surface({ color: tone ? variable(tone) : colour(part.number), ...(faint ? pale : {}) }), line);
        item.matrix.copy(matrix);
        reach.push(...part.ends.map(end => end.clone().applyMatrix4(matrix)));
        if (faint) item.remove(item.children[1]);
        scene.add(item);
      };
      if (what === "part") put(parts[number], new THREE.Matrix4(), false);
      if (what === "plate") lying.plates[number].forEach(([k, ...m]) => put(parts[k], new THREE.Matrix4().set(...m, 0, 0, 0, 1), false));
      // words, as of a gauge's holes, find no room here
      const brief = what === "part" ? letters(lying.parts[number]).filter(([label]) => label.length < 4) : [];
      const own = brief.map(([label, , at]) => [label, new THREE.Vector3(...at)]);
      if (what === "step") own.push(...step(scene, lying.steps, Number(number), put, reach));
      const view = Object.assign(eye(lain()), { aspect: 320 / 220 });
      look(view, reach, seen(what === "step" ? lying.steps[number] : { way: -1 }));
      sun.position.copy(view.position).addScaledVector(view.up, 50);
      small.render(scene, view);
      const context = target.getContext("2d");
      context.clearRect(0, 0, target.width, target.height);
      context.drawImage(small.domElement, 0, 0);
      write(context, own.map(([label, at]) => [label, at.project(view)]));
    }
    // A step in a small picture, in the colours of the large one: what comes, where there is glue and where none; its letters.
    function step(scene, steps, number, put, reach) {
      const glued = ({ how, place, diameter, height }) => {
        if (!diameter) return;
        const wide = diameter / 2 + 0.05, ring = turned([wide, -height / 2], [wide, height / 2]);
        const mesh = new THREE.Mesh(ring, seenThrough(how === "free" ? "--free" : "--glue"));
        mesh.position.set(...place);
        scene.add(mesh);
      };
      const named = items => items.flatMap(({ k, matrix }) => letters(lying.parts[copies[k].part.number]).map(([label, , at]) => [label, new THREE.Vector3(...at).applyMatrix4(matrix)]));
      if (steps[number].laid) {
        const { items, mates, names } = laidOut(steps[number].laid, copies, standing);
        items.forEach(({ k, matrix, first }) => put(copies[k].part, matrix, false, first ? "--plain" : "--new"));
        mates.forEach(glued);
        reach.push(...names.map(({ at }) => at.clone()));
        return [...names.map(({ label, at }) => [label, at]), ...named(items)];
      }
      const { coming, there, own, spring, springs, shapes, bought, screws, lies } = onBench(steps, number), placed = k => lies.clone().multiply(standing[k]);
      there.forEach(k => put(copies[k].part, placed(k), true, "--plain"));
      coming.forEach(k => put(copies[k].part, placed(k), false, "--new"));
      if (spring.length || springs.length) [spring, ...springs].forEach((wire, k) => {
        scene.add(new THREE.Mesh(tube(wire), surface({ color: variable(k ? "--plain" : "--new") })));
        reach.push(...points(wire));
      });
      [...shapes, ...bought].forEach((shape, k) => {
        const more = k < shapes.length ? { color: variable("--new") } : { color: variable("--plain"), ...pale };
        scene.add(new THREE.Mesh(block(shape, lies), surface(more)));
      });
      screws.forEach(screw => scene.add(new THREE.Mesh(block(screw, lies), seenThrough("--screw"))));
      reach.push(...prismEnds([...shapes, ...bought]).map(end => end.applyMatrix4(lies)));
      const box = new THREE.Box3().setFromPoints(coming.flatMap(k => copies[k].part.ends.map(end => end.clone().applyMatrix4(placed(k))))), size = new THREE.Vector3();
      const all = new THREE.Box3().setFromPoints(reach).getSize(size).length(), part = coming.length ? box.getSize(size).length() : all;
      if (part < 0.4 * all) reach.splice(0, reach.length, ...boxCorners(box.expandByScalar(0.1 * all + 0.2 * part)));  // closer, where it is small
      steps[number].mates.forEach(mate => glued({ ...mate, place: new THREE.Vector3(...mate.place).applyMatrix4(lies).toArray() }));
      return named(own.map(k => ({ k, matrix: placed(k) })));
    }
    // Letters of holes in a small picture, clear of each other; few enough to be read.
    function write(context, own) {
      const { width, height } = context.canvas, taken = [];
      Object.assign(context, { font: "bold 20px sans-serif", textAlign: "center", textBaseline: "middle", lineWidth: 4, lineJoin: "round" });
      own.slice(0, 12).forEach(([label, { x, y }]) => {
        const wide = context.measureText(label).width + 3, [u, v] = clear([(x + 1) / 2 * width - wide / 2, (1 - y) / 2 * height - 11, wide, 22], taken);
        context.strokeStyle = variable("--card");
        context.strokeText(label, u + wide / 2, v + 11);
        context.fillStyle = variable("--ink");
        context.fillText(label, u + wide / 2, v + 11);
      });
    }
    document.body.classList.add("solid");
    const watch = new IntersectionObserver(entries => entries.filter(entry => entry.isIntersecting && !entry.target.dataset.seen).forEach(entry => {
      entry.target.dataset.seen = "1";
      paint(entry.target);
    }), { rootMargin: "200px" });
    smalls.forEach(target => watch.observe(target));
    addEventListener("beforeprint", () => smalls.filter(target => !target.dataset.seen).forEach(target => {
      target.dataset.seen = "1";
      paint(target);
    }));
  }

  // Lettered holes of a part: several, by their letters; what its drawing numbers alone has none.
  const letters = ([, holes] = ["", []]) => {
    const own = holes.filter(([, , , lettered]) => lettered);
    return own.length > 1 ? own : [];
  };
  // Where a label, [left, top, width, height], lies on none that is taken: as near as can be above or below; it is taken then.
  function clear([left, top, wide, high], taken) {
    const free = y => taken.every(([u, v, w, h]) => left >= u + w || left + wide <= u || y >= v + h || y + high <= v);
    const tries = [...Array(15).keys()].map(n => top + (n % 2 ? -1 : 1) * Math.ceil(n / 2) * high), y = tries.find(free) ?? top;
    taken.push([left, y, wide, high]);
    return [left, y];
  }

  // ---- on the bench: one step of assembly after the other ----

  // Copies that come in a step, and those that are there, with the wires of springs: of what is built by itself its own alone,
  // turned as it lies on the bench. own: copies that come and were not built apart before.
  function onBench(steps, number) {
    const { copies, things = copies.map(k => [k]), apart = "", up, joins, wire, shapes = [], screws = [] } = steps[number], past = steps.slice(0, number);
    const later = steps.slice(number).map(step => step.joins);  // what comes again was only tried
    const whole = new Map(past.filter(step => step.joins && !later.includes(step.joins)).map(step => [step.joins, step.apart || ""]));  // of what it is by now
    const built = name => past.filter(step => {
      let own = step.apart || "";
      while (whole.has(own)) own = whole.get(own);
      return own === name;
    });
    const before = built(apart), taken = joins ? [...new Set(built(joins).flatMap(step => step.copies))] : [], coming = [...taken, ...copies];
    const begun = coming.length || wire.length || shapes.length || screws.length || before.some(step => step.copies.length);
    const there = [...new Set(before.flatMap(step => step.copies))].filter(k => !coming.includes(k));
    const inside = joins ? built(joins).flatMap(step => [...(step.shapes || []), ...(step.screws || [])]) : [];  // such as batteries
    const bought = before.flatMap(step => [...(step.shapes || []), ...(step.screws || [])]), springs = before.map(step => step.wire).filter(wire => wire.length);
    const lies = turning(up), laid = line => line.map(place => new THREE.Vector3(...place).applyMatrix4(lies).toArray());
    return { coming, taken, own: copies, things, there, spring: laid(wire), springs: springs.map(laid), shapes: [...inside, ...shapes], bought, screws, begun, lies };
  }
  // What is put together on the bench: each group by itself, as its first part is drawn, in rows; where each copy and mate is.
  function laidOut(groups, copies, standing) {
    const found = { items: [], mates: [], names: [] }, size = new THREE.Vector3();
    const sized = groups.map(([label, own, mates]) => {
      const frame = standing[own[0]].clone().invert(), items = own.map(k => ({ k, first: k === own[0], matrix: frame.clone().multiply(standing[k]) }));
      const box = new THREE.Box3().setFromPoints(items.flatMap(({ k, matrix }) => copies[k].part.ends.map(end => end.clone().applyMatrix4(matrix))));
      return { label, items, mates, frame, box };
    });
    const area = sized.reduce((sum, { box }) => sum + box.getSize(size).x * size.y, 0), gap = 0.12 * Math.sqrt(area), wide = 1.9 * Math.sqrt(area);
    let left = 0, top = 0, deep = 0;
    sized.forEach(({ label, items, mates, frame, box }) => {
      box.getSize(size);
      if (left && left + size.x > wide) { left = 0; top -= deep + gap; deep = 0; }
      const shift = new THREE.Matrix4().makeTranslation(left - box.min.x, top - box.max.y, -box.min.z), whole = shift.clone().multiply(frame);
      found.items.push(...items.map(item => ({ ...item, matrix: shift.clone().multiply(item.matrix) })));
      found.mates.push(...mates.map(mate => ({ ...mate, within: true, place: new THREE.Vector3(...mate.place).applyMatrix4(whole).toArray() })));
      found.names.push({ label, at: new THREE.Vector3(left + size.x / 2, top - size.y - 0.35 * gap, 0) });
      left += size.x + gap;
      deep = Math.max(deep, size.y);
    });
    return found;
  }
  // A turn of the machine by which a direction in it comes up on the bench.
  function turning(up) {
    const turn = new THREE.Matrix4();
    if (!up) return turn;
    const z = new THREE.Vector3(...up), x = Math.abs(z.x) < 0.5 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, -1, 0);
    return turn.makeBasis(x, new THREE.Vector3().crossVectors(z, x), z).transpose();
  }

  // A body about z: triangles between rings of a radius and a height each.
  function turned(...rings) {
    const out = [], sides = 40, at = ([radius, z], k) => [radius * Math.cos(k * 2 * Math.PI / sides), radius * Math.sin(k * 2 * Math.PI / sides), z];
    rings.slice(1).forEach((ring, n) => {
      for (let k = 0; k < sides; k++) out.push(...at(rings[n], k), ...at(ring, k), ...at(ring, k + 1), ...at(rings[n], k), ...at(ring, k + 1), ...at(rings[n], k + 1));
    });
    const body = new THREE.BufferGeometry();
    body.setAttribute("position", new THREE.BufferAttribute(new Float32Array(out), 3));
    return body;
  }

  const boxCorners = box => [0, 1, 2, 3, 4, 5, 6, 7].map(k => new THREE.Vector3(...["x", "y", "z"].map((axis, n) => box[k >> n & 1 ? "max" : "min"][axis])));
  const prismEnds = shapes => shapes.flatMap(([ring, low, high]) => ring.flatMap(([x, y]) => [new THREE.Vector3(x, y, low), new THREE.Vector3(x, y, high)]));
  function block([ring, low, high], lies) {  // what is bought, such as a motor
    const body = new THREE.BufferGeometry();
    body.setAttribute("position", new THREE.BufferAttribute(new Float32Array(walled(ring, low, high, [])), 3));
    body.computeVertexNormals();
    return body.applyMatrix4(lies);
  }
  const seenThrough = tone => new THREE.MeshBasicMaterial({ color: variable(tone), side: THREE.DoubleSide, transparent: true, opacity: 0.75, depthTest: false });
  const points = wire => wire.map(place => new THREE.Vector3(...place));
  // The wire of a spring: rings of six corners along its line, each turned as little against the one before as can be.
  function tube(wire) {
    const line = points(wire), half = 0.5, out = [], aside = new THREE.Vector3(0, 0, 1);
    const rings = line.map((at, k) => {
      const way = new THREE.Vector3().subVectors(line[Math.min(k + 1, line.length - 1)], line[Math.max(k - 1, 0)]).normalize();
      aside.addScaledVector(way, -aside.dot(way));
      if (aside.length() < 0.01) aside.set(way.y, way.z, way.x).addScaledVector(way, -way.dot(aside));
      aside.normalize();
      const turn = new THREE.Quaternion().setFromAxisAngle(way, Math.PI / 3), ring = [aside.clone()];
      while (ring.length < 6) ring.push(ring[ring.length - 1].clone().applyQuaternion(turn));
      return ring.map(corner => corner.multiplyScalar(half).add(at).toArray());
    });
    rings.slice(1).forEach((ring, n) => ring.forEach((corner, k) => {
      const last = rings[n], after = (k + 1) % 6;
      out.push(...last[k], ...last[after], ...ring[after], ...last[k], ...ring[after], ...corner);
    }));
    const body = new THREE.BufferGeometry();
    body.setAttribute("position", new THREE.BufferAttribute(new Float32Array(out), 3));
    body.computeVertexNormals();
    return body;
  }

  function bench(copies, standing, lying) {
    const canvas = byId("bench"), cards = [...document.querySelectorAll(".steps .cards li")], steps = lying.steps;
    if (!canvas) return { dress() {} };
    const frame = canvas.closest(".bench"), marks = byId("marks"), back = byId("back"), next = byId("next"), seek = byId("seek");
    const inset = byId("whole"), over = eye(lain());  // where what comes is small: the whole in a corner of the picture
    const scene = new THREE.Scene(), camera = eye(lain()), sun = lit(scene);
    const ends = shapes => prismEnds(shapes).map(end => end.applyMatrix4(lies));
    const plain = surface(), fresh = surface(), edge = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.5 }), coming = new THREE.Group(), there = new THREE.Group();
    const wait = 700, way = 1500;  // ms, before a part moves, and until it is in
    let lies = new THREE.Matrix4();  // how what is shown is turned
    const stand = k => lies.clone().multiply(standing[k]);
    const corners = (numbers, more = new THREE.Vector3()) => numbers.flatMap(k => copies[k].part.ends.map(end => end.clone().applyMatrix4(stand(k)).add(more)));
    const least = 0.03 * new THREE.Box3().setFromPoints(corners([...copies.keys()])).getSize(new THREE.Vector3()).length();
    let renderer, number = 0, begun = 0, lift = new THREE.Vector3(), radius = 1, near = [], whole = [], tags = [], wanted = false;
    seek.max = steps.length;
    scene.add(there, coming);
    frame.hidden = false;
    document.querySelector(".steps details").open = false;

    function put(group, k, material, matrix = stand(k)) {
      const item = object(copies[k].part, material, edge);
      item.matrix.copy(matrix);
      group.add(item);
    }
    function mark(group, body, where, tone, more) {
      const mesh = new THREE.Mesh(body, new THREE.MeshBasicMaterial({ color: variable(tone), side: THREE.DoubleSide, ...more }));
      mesh.position.set(...where);
      group.add(mesh);
    }
    function go(to) {
      number = Math.max(0, Math.min(steps.length - 1, to));
      byId("count").value = "Step " + (number + 1) + " of " + steps.length;
      byId("said").textContent = cards[number].querySelector("p").textContent;
      seek.value = number + 1;
      back.disabled = !number;
      next.disabled = number === steps.length - 1;
      dress();
      aim(hand.held ? undefined : first());
      again();
    }
    function turnTo(to) {  // by hand: the address says which
      go(to);
      history.replaceState(null, "", "#step=" + (number + 1));
    }
    function aim(from) {
      if (renderer && near.length) hand.aim(near, from);
    }
    // What fills the picture: what comes with some of its surroundings, or all where that is not much more.
    function focus({ coming, there, spring, springs, shapes, bought, screws }, mates) {
      whole = [...corners([...there, ...coming]), ...[spring, ...springs].flatMap(points), ...ends([...shapes, ...bought])];
      const all = new THREE.Box3().setFromPoints(whole.length ? whole : corners([0])), size = new THREE.Vector3();
      const close = new THREE.Box3().setFromPoints([...corners(coming), ...points(spring), ...ends(shapes), ...ends(screws), ...mates.map(({ place }) => new THREE.Vector3(...place))]);
      close.expandByScalar(Math.max(least, close.getSize(size).length() / 4));
      inset.hidden = !(coming.length || spring.length || shapes.length || screws.length) || close.getSize(size).length() > 0.5 * all.getSize(size).length();
      const shown = inset.hidden ? all.expandByScalar(Math.max(0, least - all.getSize(size).length() / 4)) : close;
      radius = shown.getSize(size).length() / 2;
      return shown;
    }
    function dress() {  // what is seen of this step, in the colours of the page
      plain.color.set(variable("--plain"));
      fresh.color.set(variable("--new"));
      edge.color.set(variable("--ink"));
      [there, coming].forEach(group => group.clear());
      const groups = steps[number].laid;
      if (groups) lay(laidOut(groups, copies, standing)); else build();
      ask();
    }
    function lay({ items, mates, names }) {  // what is put together on the bench before it goes into the machine
      canvas.parentElement.hidden = false;
      inset.hidden = true;
      lift.set(0, 0, 0);
      near = items.flatMap(({ k, matrix }) => copies[k].part.ends.map(end => end.clone().applyMatrix4(matrix)));
      near.push(...names.map(({ at }) => at));  // they lie below what they name
      radius = new THREE.Box3().setFromPoints(near).getSize(new THREE.Vector3()).length() / 2;
      items.forEach(({ k, matrix, first }) => put(there, k, first ? plain : fresh, matrix));
      mates.forEach(mate => glued(there, mate));
      tags = [...names.map(({ label, at }) => ({ label, how: "name", at })), ...lettered(items)];
      name(mates);
    }
    const lettered = items => items.flatMap(({ k, matrix }) => letters(lying.parts[copies[k].part.number]).map(([label, , at]) => ({
      label, how: "", moves: true, at: new THREE.Vector3(...at).applyMatrix4(matrix),
    })));
    function glued(group, { how, place, diameter, height }) {  // a band where there is glue, or where none may be
      const wide = diameter / 2 + 0.05, half = height / 2;
      if (diameter) mark(group, turned([wide, -half], [wide, half]), place, how === "free" ? "--free" : "--glue", { transparent: true, opacity: 0.75, depthTest: false });
    }
    function build() {  // what comes, and what is there
      const now = onBench(steps, number), comes = now.coming.length || now.spring.length || now.shapes.length || now.screws.length;
      lies = now.lies;
      canvas.parentElement.hidden = !now.begun;  // nothing is there yet
      const into = direction(steps[number]);
      const mates = steps[number].mates.map(({ place, ...mate }) => ({ ...mate, place: new THREE.Vector3(...place).applyMatrix4(lies).toArray() }));
      const shown = focus(now, mates), box = new THREE.Box3().setFromPoints([...corners(now.coming), ...points(now.spring), ...ends(now.shapes)]), high = comes ? Math.abs(box.getSize(new THREE.Vector3()).dot(into)) : 0;
      lift.copy(into).multiplyScalar(comes && now.there.length ? -Math.max(1.3 * high, 0.45 * radius) : 0);
      near = inset.hidden ? [...whole, shown.min, shown.max] : boxCorners(shown);
      const before = lift.clone().addScaledVector(into, -0.2 * radius);  // with the arrows
      near.push(...corners(now.coming, comes && now.there.length ? before : lift), ...[...points(now.spring), ...ends(now.shapes)].map(place => place.add(lift)));
      now.there.forEach(k => put(there, k, comes ? plain : surface({ color: colour(copies[k].part.number) })));
      now.coming.forEach(k => put(coming, k, fresh));
      now.springs.forEach(wire => there.add(new THREE.Mesh(tube(wire), plain)));
      coming.add(new THREE.Mesh(tube(now.spring), fresh));
      now.bought.forEach(shape => there.add(new THREE.Mesh(block(shape, lies), plain)));
      now.screws.forEach(screw => there.add(new THREE.Mesh(block(screw, lies), seenThrough("--screw"))));
      now.shapes.forEach(shape => coming.add(new THREE.Mesh(block(shape, lies), fresh)));
      frame.querySelector(".bench-keys .screw").hidden = !now.screws.length;
      const loose = [...unmet(now.things, mates), ...(now.taken.length ? unmet([now.taken], mates) : [])];
      if (lift.length()) arrows(box, into, now.spring.length ? [] : [...mates.filter(({ within }) => !within), ...loose]);
      mates.forEach(mate => glued(mate.comes || mate.within ? coming : there, mate));
      tags = lettered(now.own.map(k => ({ k, matrix: stand(k) })));
      name(mates, called(now.taken.length > 6 ? now.own : now.coming));  // not all of a whole side
    }
    function unmet(things, mates) {  // middles of what comes and is nowhere fixed on or loose against another; things: by their copies
      const boxes = things.map(numbers => new THREE.Box3().setFromPoints(corners(numbers)));
      const meets = box => mates.some(({ place: [x, y] }) => x > box.min.x && x < box.max.x && y > box.min.y && y < box.max.y);
      return boxes.filter(box => !meets(box)).map(box => ({ diameter: 1, place: box.getCenter(new THREE.Vector3()).toArray() }));
    }
    function arrows(box, into, mates) {  // before what it goes on or through, else before its middle
      const far = [box.min, box.max].map(corner => -corner.dot(into)), back = Math.max(...far) + 0.04 * radius, long = 0.16 * radius, wide = 0.025 * radius;
      const places = mates.filter(({ diameter }) => diameter).map(({ place }) => new THREE.Vector3(...place));
      const body = turned([0, 0], [2.2 * wide, 0.4 * long], [wide, 0.4 * long], [wide, long], [0, long]);
      body.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), into.clone().negate()));
      (places.length ? places : [box.getCenter(new THREE.Vector3())]).forEach(place => {
        const tip = place.clone().addScaledVector(into, -back - place.dot(into));
        mark(coming, body, tip.toArray(), "--link", { transparent: true, depthTest: false });
      });
    }
    function called(numbers) {  // names of what comes: each copy has its own where they are few, else alike ones one together
      const alike = new Map();
      numbers.forEach(k => {
        const key = numbers.length > 6 ? copies[k].part.name : k;
        alike.set(key, [...(alike.get(key) || []), k]);
      });
      return [...alike.values()].map(own => ({
        label: copies[own[0]].part.name + (own.length > 1 ? " × " + own.length : ""), how: "part", moves: true, ends: corners([own[0]]),
      }));
    }
    const most = 24;  // labels in one picture: of more, those of glue alone
    function name(mates, parts = []) {  // letters of the holes that come, and of those that they go on or through
      const words = { glue: "glue", press: "pressed, no glue", free: "no glue" };
      mates.forEach(({ how, label, place, comes, within }) => {
        const at = new THREE.Vector3(...place);
        const same = comes && !within ? null : tags.find(tag => !tag.how && Math.hypot(tag.at.x - at.x, tag.at.y - at.y) < 0.01);
        if (same) Object.assign(same, { how, label: label || same.label });  // by the joint where the hole has no name
        else tags.push({ label, how, moves: within || !comes, at });
      });
      if (tags.length > most) tags = tags.filter(tag => tag.how && tag.how !== "free");
      tags.push(...parts);
      marks.replaceChildren(...tags.map(({ label, how }) => {
        const text = [label, words[how]].filter(Boolean).join(": "), mark = Object.assign(document.createElement("b"), { textContent: text, className: how });
        if (how === "part") mark.append(document.createElement("i"));  // its leader
        return mark;
      }));
      ["glue", "free"].forEach(how => { frame.querySelector(".bench-keys ." + how).hidden = !mates.some(mate => mate.how === how); });
      frame.querySelector(".below").hidden = direction(steps[number]).z <= 0;
    }
    function again() { begun = performance.now(); ask(); }
    function ask() {
      if (wanted || !renderer) return;
      wanted = true;
      requestAnimationFrame(draw);
    }
    function draw(time) {
      wanted = false;
      const share = calm ? 0 : Math.max(0, Math.min(1, (time - begun - wait) / way)), left = (1 - share) ** 2;
      const { clientWidth: width, clientHeight: height } = canvas, place = new THREE.Vector3();
      coming.position.copy(lift).multiplyScalar(left);
      sun.position.copy(camera.position).addScaledVector(camera.up, radius);
      renderer.render(scene, camera);
      if (!inset.hidden) {
        const { offsetLeft: left, offsetTop: top, clientWidth: wide, clientHeight: high } = inset;
        over.aspect = wide / high;
        look(over, whole, place.subVectors(camera.position, hand.target).normalize().clone());
        renderer.setScissorTest(true);
        [[left, height - top - high, wide, high], [0, 0, width, height]].forEach((window, last) => {
          renderer.setViewport(...window);
          renderer.setScissor(...window);
          if (!last) renderer.render(scene, over);
        });
        renderer.setScissorTest(false);
      }
      const taken = inset.hidden ? [] : [[inset.offsetLeft, inset.offsetTop, inset.offsetWidth, inset.offsetHeight]], origin = new THREE.Vector3();
      tags.forEach((tag, k) => {
        const { at, moves, how, ends } = tag, label = marks.children[k], { wide, high } = tag.size ||= { wide: label.offsetWidth, high: label.offsetHeight };
        if (ends) return lead(label, ends.map(end => {
          place.copy(end).add(coming.position).project(camera);
          return [(place.x + 1) / 2 * width, (1 - place.y) / 2 * height];
        }), [wide, high], width, taken);
        place.copy(at).add(moves ? coming.position : origin).project(camera);
        const aside = { glue: -1.04, press: -1.04, free: 0.04 }[how] || -0.5;
        const [x, y] = clear([(place.x + 1) / 2 * width + aside * wide, (1 - place.y) / 2 * height - high / 2, wide, high], taken);
        label.style.transform = "translate(" + x + "px, " + y + "px)";
      });
      canvas.dataset.drawn = Number(canvas.dataset.drawn || 0) + 1;
      if (!calm && share < 1 && lift.length()) ask();
    }
    // A part's name beside it, on the side on which it is nearer to the picture's edge, and a line to its end there.
    function lead(label, ends, [wide, high], width, taken) {
      const right = ends.reduce((sum, [x]) => sum + x, 0) > width / 2 * ends.length, along = right ? 1 : -1;
      const [px, py] = ends.reduce((best, end) => (end[0] - best[0]) * along > 0 ? end : best);
      const left = Math.max(2, Math.min(width - wide - 2, right ? px + 24 : px - 24 - wide));
      const [x, y] = clear([left, py - high / 2, wide, high], taken), from = right ? x : x + wide, line = label.lastChild;
      label.style.transform = "translate(" + x + "px, " + y + "px)";
      line.style.left = from - x + "px";
      line.style.width = Math.hypot(px - from, py - y - high / 2) + "px";
      line.style.transform = "rotate(" + Math.atan2(py - y - high / 2, px - from) + "rad)";
    }
    const turns = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity };
    canvas.addEventListener("keydown", event => {
      const turn = { ...turns, PageUp: -1, PageDown: 1 }[event.key];
      if (!turn || event.shiftKey) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      turnTo(number + turn);
    });
    frame.addEventListener("keydown", event => {
      const turn = turns[event.key];
      if (!turn || event.target === canvas) return;
      event.preventDefault();
      turnTo(number + turn);
    });
    // Anywhere on the page while the steps are in its middle; elsewhere the same keys turn the machine.
    document.addEventListener("keydown", event => {
      const turn = turns[event.key], { top, bottom } = frame.getBoundingClientRect(), middle = innerHeight / 2;
      if (!turn || top > middle || bottom < middle || event.shiftKey || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.target.closest?.("input, select, button, summary, a, canvas, .bench")) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      turnTo(number + turn);
    }, true);
    function addressed() {  // the step of the address
      const asked = /^#step=(\d+)$/.exec(location.hash);
      if (!asked) return;
      number = asked[1] - 1;
      if (renderer) go(number);
      frame.scrollIntoView();
    }
    addEventListener("hashchange", addressed);
    const first = () => seen(steps[number]), home = () => { hand.held = false; aim(first()); };
    const hand = steered(canvas, camera, { moved: ask, home, tap() {} });
    back.addEventListener("click", () => turnTo(number - 1));
    next.addEventListener("click", () => turnTo(number + 1));
    seek.addEventListener("input", () => turnTo(seek.value - 1));
    byId("again").addEventListener("click", again);
    cards.forEach((card, k) => card.addEventListener("click", () => { turnTo(k); frame.scrollIntoView({ block: "nearest" }); }));
    new ResizeObserver(() => {
      const { clientWidth: width, clientHeight: height } = canvas;
      if (!renderer || !width) return;
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      aim(hand.held ? undefined : first());
    }).observe(canvas);
    new IntersectionObserver((entries, watch) => {  // made when it comes into sight
      if (!entries.some(entry => entry.isIntersecting)) return;
      watch.disconnect();
      renderer = drawing({ canvas, alpha: true, antialias: !slow });
      renderer.setPixelRatio(slow ? 1 : Math.min(2, devicePixelRatio));
      renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
      camera.aspect = canvas.clientWidth / canvas.clientHeight || 1;
      camera.updateProjectionMatrix();
      go(number);
      home();
    }, { rootMargin: "100px" }).observe(frame);
    addressed();
    return { dress };
  }

  requestAnimationFrame(() => setTimeout(() => start().catch(error => console.error(error)), 0));
})();
