// The machine in three dimensions, on three.js: read from the same GLB that lies beside the report, turned with theta.
// It starts after the page's first paint; without WebGL the drawing stays.
(() => {
  const byId = id => document.getElementById(id), text = id => byId(id).textContent;
  const bytes = packed => Uint8Array.from(atob(packed), c => c.charCodeAt(0));
  const unpacked = id => new Response(new Blob([bytes(text(id))]).stream().pipeThrough(new DecompressionStream("gzip")));
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;

  async function start() {
    const canvas = byId("machine");
    const context = canvas && picture(canvas);  // at first: the browser makes it ready while the library is unpacked
    if (!context) return;
    const library = document.createElement("script"), machine = unpacked("glb").arrayBuffer();
    library.textContent = await unpacked("three").text();
    document.head.append(library);
    const renderer = new THREE.WebGLRenderer({ canvas, context });
    show(renderer, canvas, read(await machine), JSON.parse(text("lying")));
  }

  let slow = false;  // whether a processor draws: then edges are not smoothed
  function picture(canvas) {
    const asked = { alpha: true, stencil: true, depth: true, preserveDrawingBuffer: true };
    const fast = canvas.getContext("webgl2", { ...asked, antialias: true, failIfMajorPerformanceCaveat: true });
    slow = !fast;
    return fast || canvas.getContext("webgl2", { ...asked, antialias: false });
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
    return { parts, copies, bodies };
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
    solid.computeBoundingBox();
    solid.computeBoundingSphere();
    return { solid, edges };
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
  const ahead = () => new THREE.Vector3(0.55, -1, 0.9).normalize();  // the first view: from the front, above and right
  function look(camera, box) {  // so that a box just fits the picture
    const centre = box.getCenter(new THREE.Vector3()), up = Math.tan(camera.fov * Math.PI / 360), radius = box.getSize(new THREE.Vector3()).length() / 2;
    camera.up.set(0, 0, 1);
    camera.position.copy(centre).add(ahead());
    camera.lookAt(centre);
    const turned = camera.quaternion.clone().invert();
    let far = 0;
    for (let k = 0; k < 8; k++) {
      const corner = new THREE.Vector3(...["x", "y", "z"].map((axis, n) => (k >> n & 1 ? box.max : box.min)[axis]));
      corner.sub(centre).applyQuaternion(turned);
      far = Math.max(far, corner.z + Math.abs(corner.x) / (up * camera.aspect), corner.z + Math.abs(corner.y) / up);
    }
    far *= 1.02;
    camera.position.copy(centre).addScaledVector(ahead(), far);
    camera.near = far / 50;
    camera.far = far + 20 * radius;
    camera.updateProjectionMatrix();
    return new THREE.Sphere(centre, radius);
  }

  function show(renderer, canvas, machine, lying) {
    const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(28, 1, 1, 1000), sun = lit(scene);
    const { parts, copies, bodies } = machine;
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
      copy.step = lying.steps.findIndex(step => step.includes(k));
      copy.group.add(copy.shown);
    });
    const last = lying.steps.length, steps = [...new Set(copies.map(copy => copy.step < 0 ? last : copy.step))].sort((a, b) => a - b);
    copies.forEach(copy => { copy.rank = steps.indexOf(copy.step < 0 ? last : copy.step) - (steps.length - 1) / 2; });

    // -- where all is at an angle --
    const q = new THREE.Quaternion(), p = new THREE.Vector3();
    function turn(deg) {
      bodies.forEach(body => body.channels.forEach(({ path, values }) => {
        const wide = path === "rotation" ? 4 : 3, n = values.length / wide - 1, place = camgen.turned(deg) * n;
        const i = Math.min(n - 1, Math.floor(place)), share = place - i;
        if (path === "rotation") body.group.quaternion.fromArray(values, 4 * i).slerp(q.fromArray(values, 4 * i + 4), share);
        else body.group.position.fromArray(values, 3 * i).lerp(p.fromArray(values, 3 * i + 3), share);
      }));
    }
    // -- springs: flat bands that change their shape, at a height --
    const wide = 0.4;  // mm, half of a band
    const coils = Object.entries(camgen.heights).map(([k, z]) => {
      const pieces = camgen.courseAt(k).length / 2 - 1;
      const line = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ side: THREE.DoubleSide }));
      line.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(18 * pieces), 3));
      line.frustumCulled = false;
      scene.add(line);
      return { k, z, line };
    });
    let apart = false;  // exploded
    function strung() {
      coils.forEach(({ k, line }) => { line.visible = !apart && document.querySelector('.legend [data-body="' + k + '"]').checked; });
    }
    function stretch() {
      coils.forEach(({ k, z, line }) => {
        const at = camgen.courseAt(k), place = line.geometry.attributes.position;
        for (let n = 0; n + 3 < at.length; n += 2) {
          const x = at[n + 2] - at[n], y = at[n + 3] - at[n + 1], size = Math.hypot(x, y) || 1, u = -wide * y / size, v = wide * x / size;
          [[0, 1], [0, -1], [2, 1], [2, 1], [0, -1], [2, -1]].forEach(([end, side], corner) =>
            place.setXYZ(3 * n + corner, at[n + end] + side * u, at[n + end + 1] + side * v, z));
        }
        place.needsUpdate = true;
      });
    }
    function spread(share) {
      apart = share > 0;
      strung();
      const gap = steps.length > 1 ? share * 1.7 * ball.radius / (steps.length - 1) : 0;
      copies.forEach(copy => {
        copy.shown.matrix.makeTranslation(0, 0, copy.rank * gap).multiply(copy.home);
        copy.shown.matrixWorldNeedsUpdate = true;
      });
    }
    const box = new THREE.Box3();
    copies.forEach(copy => { copy.shown.matrix.copy(copy.home); });
    for (let deg = 0; deg < 360; deg += 30) {
      turn(deg);
      scene.updateMatrixWorld(true);
      copies.forEach(copy => box.union(copy.part.solid.boundingBox.clone().applyMatrix4(copy.shown.matrixWorld)));
    }
    let ball = box.getBoundingSphere(new THREE.Sphere());

    // -- section: of each copy its back faces less its front faces are where the plane lies inside; there a cap is drawn --
    const caps = new THREE.Group();
    scene.add(caps);
    function capped() {
      caps.clear();
      copies.forEach(copy => copy.shown.children.filter(child => child.userData.counts).forEach(child => copy.shown.remove(child)));
      const planes = cut.axis ? [plane] : [];
      parts.forEach(part => { Object.assign(part.material, { clippingPlanes: planes, needsUpdate: true }); });
      Object.assign(edge, { clippingPlanes: planes, needsUpdate: true });
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

    // -- what the page says of parts --
    function dress() {
      parts.forEach(part => {
        const checkbox = document.querySelector('.legend [data-body="' + part.number + '"]');
        part.material.color.copy(colour(part.number));
        copies.filter(copy => copy.part === part).forEach(copy => { copy.shown.visible = !checkbox || checkbox.checked; });
      });
      coils.forEach(({ k, line }) => line.material.color.copy(colour(k)));
      strung();
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
        canvas.dataset.drawn = Number(canvas.dataset.drawn || 0) + 1;
      });
    }
    function fit() {
      const { clientWidth: width, clientHeight: height } = canvas;
      if (!width || !height) return;
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      ask();
    }
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.enableDamping = false;
    function home() {
      camera.aspect = canvas.clientWidth / Math.max(1, canvas.clientHeight);
      ball = look(camera, box);
      controls.target.copy(ball.center);
      controls.update();
      ask();
    }
    controls.addEventListener("change", ask);
    canvas.addEventListener("keydown", event => {
      const round = new THREE.Vector3().subVectors(camera.position, controls.target);
      const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
      const zoom = { "+": 1 / 1.1, "=": 1 / 1.1, "-": 1.1 }[event.key];
      if (turns) {
        const flat = Math.hypot(round.x, round.y), height = Math.atan2(round.z, flat), far = round.length();
        const along = Math.atan2(round.y, round.x) + turns[0], up = Math.max(-1.55, Math.min(1.55, height + turns[1]));
        round.set(far * Math.cos(up) * Math.cos(along), far * Math.cos(up) * Math.sin(along), far * Math.sin(up));
      } else if (zoom) round.multiplyScalar(zoom);
      else if (event.key === "0" || event.key === "Home") { home(); return; }
      else return;
      event.preventDefault();
      camera.position.copy(controls.target).add(round);
      controls.update();
      ask();
    });

    // -- the tools --
    const svg = byId("mechanism"), flat = byId("flat");
    function plain(drawing) {
      canvas.hidden = drawing;
      svg.style.display = drawing ? "" : "none";
      camgen.solid = !drawing;
      flat.setAttribute("aria-pressed", drawing);
      if (drawing) camgen.draw(); else fit();
    }
    document.querySelector(".tools").hidden = false;
    flat.addEventListener("click", () => plain(!canvas.hidden));
    byId("home").addEventListener("click", home);
    byId("explode").addEventListener("input", event => { spread(Number(event.target.value)); ask(); });
    byId("section").addEventListener("change", event => { cut.axis = event.target.value; byId("cut").hidden = !cut.axis; capped(); ask(); });
    byId("cut").addEventListener("input", event => { cut.share = Number(event.target.value); ask(); });
    document.addEventListener("parts", () => { dress(); ask(); });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { dress(); ask(); smalls.forEach(paint); });

    dress();
    plain(false);
    home();
    camgen.follow(deg => { turn(deg); stretch(); ask(); });
    new ResizeObserver(fit).observe(canvas);

    // -- small views of parts, plates and steps: one renderer draws them one after the other as they come into sight --
    const smalls = [...document.querySelectorAll(".small")];
    let small;
    function paint(target) {
      if (!target.dataset.seen) return;
      small ||= new THREE.WebGLRenderer({ canvas: Object.assign(document.createElement("canvas"), { width: 320, height: 220 }), alpha: true, antialias: !slow });
      const [what, number] = target.dataset.view.split("-"), scene = new THREE.Scene(), sun = lit(scene);
      const line = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.6, color: variable("--ink") });
      const put = (part, matrix, faint) => {
        const more = faint ? { transparent: true, opacity: 0.25, depthWrite: false } : {};
        const item = object(part, surface({ color: colour(part.number), ...more }), line);
        item.matrix.copy(matrix);
        if (faint) item.remove(item.children[1]);
        scene.add(item);
      };
      if (what === "part") put(parts[number], new THREE.Matrix4(), false);
      if (what === "plate") lying.plates[number].forEach(([k, ...m]) => put(parts[k], new THREE.Matrix4().set(...m, 0, 0, 0, 1), false));
      if (what === "step") {
        turn(0);
        for (let step = 0; step <= number; step++) lying.steps[step].forEach(k => {
          const copy = copies[k], placed = new THREE.Matrix4().compose(copy.group.position, copy.group.quaternion, copy.group.scale);
          put(copy.part, placed.multiply(copy.home), step < number);
        });
        turn(Number(byId("theta").value));
      }
      const view = new THREE.PerspectiveCamera(28, 320 / 220, 1, 1000);
      scene.updateMatrixWorld(true);
      look(view, new THREE.Box3().setFromObject(scene));
      sun.position.copy(view.position).addScaledVector(view.up, 50);
      small.render(scene, view);
      const context = target.getContext("2d");
      context.clearRect(0, 0, target.width, target.height);
      context.drawImage(small.domElement, 0, 0);
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

  requestAnimationFrame(() => setTimeout(() => start().catch(error => console.error(error)), 0));
})();
