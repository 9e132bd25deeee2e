// Bodies in space on a report page: skins of meshes that the reader turns, with values at their nodes.
//
// The page holds one <figure class="space"> per view, with its data in a <script type="application/octet-stream">:
// base64 of gzip of
//
//   header length (4 bytes, little endian), header (JSON, UTF-8), arrays
//
// Arrays begin at the offset "at" behind the header and have "n" numbers of 16 or 32 bits. They are differences to the
// number that stands "stride" places before, modulo 2^16 or 2^32; first all highest bytes, last all lowest ones. Levels
// (16 bits) stand for low + level · (high − low) / 65534; the level 65535 says that there is no value. problems/figures/
// src/space.rs writes them. Nothing is loaded from elsewhere.

import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Mesh,
  OrthographicCamera,
  Raycaster,
  Scene,
  ShaderMaterial,
  Spherical,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

/// The level of nodes without a value.
const NONE = 65535;
/// Share of a node without a value, as the shader sees it: real ones are 0 … 1.
const NO_SHARE = -1;
/// Colour of what has no value.
const GREY = "#c9ced4";
/// Pixels that the pointer may move between press and release of a click.
const CLICK = 5;

// ---------------------------------------------------------------------------------------------------------------------
// Data

/// The bytes behind base64 and gzip.
async function unpacked(text) {
  const packed = Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// Header and arrays of a view.
class Data {
  constructor(bytes) {
    const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
    this.header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
    this.bytes = bytes.subarray(4 + length);
    this.known = new Map();
  }

  /// Whole numbers of an array, read once.
  integers({ at, n, stride, size }) {
    // An array without numbers begins where the next one does.
    if (n === 0) return new Uint32Array(0);
    let found = this.known.get(at);
    if (found === undefined) {
      found = size === 2 ? new Uint16Array(n) : new Uint32Array(n);
      for (let plane = 0; plane < size; plane++) {
        const [from, shift] = [at + plane * n, 8 * (size - 1 - plane)];
        for (let i = 0; i < n; i++) found[i] |= this.bytes[from + i] << shift;
      }
      for (let i = stride; i < n; i++) found[i] += found[i - stride];
      this.known.set(at, found);
    }
    return found;
  }

  /// Values of an array of levels; NaN where there is none.
  levels(array) {
    const step = stepOf(array);
    return Float64Array.from(this.integers(array), (level) => (level === NONE ? NaN : array.low + level * step));
  }
}

/// Distance of two levels.
const stepOf = ({ low, high }) => (high - low) / 65534;

/// A number with the digits that are true when it is known up to half a step.
function written(value, step) {
  if (Number.isNaN(value)) return "–";
  if (!(step > 0)) return String(Number(value.toPrecision(6)));
  const decimals = Math.floor(-Math.log10(step));
  const exponent = value === 0 ? 0 : Math.floor(Math.log10(Math.abs(value)));
  const digits = exponent + decimals;
  if (digits >= 0 && (exponent < -4 || exponent > 6)) return value.toExponential(Math.min(digits, 8));
  const rounded = decimals < 0 ? Math.round(value * 10 ** decimals) / 10 ** decimals : value;
  return rounded.toFixed(Math.min(Math.max(decimals, 0), 12)).replace(/^-(?=[0.]*$)/, "");
}

// ---------------------------------------------------------------------------------------------------------------------
// Drawing

const VERTEX = `
  attribute vec3 corner;   // 1 at one corner of the triangle
  attribute vec3 values;   // of its three corners
  attribute vec3 edges;    // 1 for sides that are edges of the mesh, by the corner opposite
  varying vec3 vCorner, vValues, vEdges, vPlace;
  void main() {
    vCorner = corner; vValues = values; vEdges = edges;
    vec4 place = modelViewMatrix * vec4(position, 1.0);
    vPlace = place.xyz;
    gl_Position = projectionMatrix * place;
  }`;

const FRAGMENT = `
  uniform vec3 scale[17];
  uniform vec3 grey;
  uniform bool classes, ghost, lines;
  varying vec3 vCorner, vValues, vEdges, vPlace;
  vec3 colour(float share) {
    float at = clamp(share, 0.0, 1.0) * 16.0;
    int low = int(min(at, 15.0));
    return mix(scale[low], scale[low + 1], at - float(low));
  }
  void main() {
    vec3 painted = grey;
    if (vValues.x > -0.5) {
      // Classes have the colour of the nearest corner.
      float most = max(vCorner.x, max(vCorner.y, vCorner.z));
      float nearest = vCorner.x == most ? vValues.x : vCorner.y == most ? vValues.y : vValues.z;
      painted = classes ? scale[int(nearest + 0.5)] : colour(dot(vCorner, vValues));
    }
    vec3 normal = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
    painted *= 0.78 + 0.22 * abs(normal.z);
    vec3 width = fwidth(vCorner);
    vec3 inside = mix(vec3(1.0), smoothstep(vec3(0.0), 1.3 * width, vCorner), vEdges);
    float line = 1.0 - min(inside.x, min(inside.y, inside.z));
    // Cells of a few pixels have no lines: they would hide everything.
    line *= lines ? 0.55 * clamp(1.3 - 4.0 * max(width.x, max(width.y, width.z)), 0.0, 1.0) : 0.0;
    gl_FragColor = ghost ? vec4(mix(grey, vec3(0.2), line), 0.1 + 0.3 * line) : vec4(mix(painted, vec3(0.1), line), 1.0);
  }`;

const rgb = (hex) => new Vector3(...[1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255));

/// The skin of a body: its triangles by nodes, quadrilaterals halved, and the mesh that is drawn.
class Skin {
  constructor(data, body, uniforms) {
    this.name = body.name;
    this.apart = body.apart;
    this.numbers = data.integers(body.numbers);
    const [quads, triangles] = [data.integers(body.quads), data.integers(body.triangles)];
    const count = quads.length / 2 + triangles.length / 3;
    // The first triangles are pairs, the halves of quadrilaterals.
    this.halves = quads.length / 2;
    this.corners = new Uint32Array(3 * count);
    const edges = new Float32Array(9 * count);
    let at = 0;
    const add = (a, b, c, sides) => {
      this.corners.set([a, b, c], 3 * at);
      for (let vertex = 0; vertex < 3; vertex++) edges.set(sides, 9 * at + 3 * vertex);
      at++;
    };
    for (let i = 0; i < quads.length; i += 4) {
      const [a, b, c, d] = quads.subarray(i, i + 4);
      add(a, b, c, [1, 0, 1]);
      add(a, c, d, [1, 1, 0]);
    }
    for (let i = 0; i < triangles.length; i += 3) add(...triangles.subarray(i, i + 3), [1, 1, 1]);
    const corner = new Float32Array(9 * count);
    for (let i = 0; i < 3 * count; i++) corner[3 * i + (i % 3)] = 1;
    this.geometry = new BufferGeometry();
    const attribute = (name, array) => this.geometry.setAttribute(name, new BufferAttribute(array, 3));
    attribute("position", new Float32Array(9 * count));
    attribute("values", new Float32Array(9 * count));
    attribute("corner", corner);
    attribute("edges", edges);
    const own = { ...uniforms, ghost: { value: false } };
    // What may be glass is drawn in the order of renderOrder, glass first.
    this.material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: own,
      side: DoubleSide,
      transparent: true,
    });
    this.mesh = new Mesh(this.geometry, this.material);
  }

  /// Moves the nodes to some places, by axes.
  place(places) {
    this.places = places;
    const position = this.geometry.getAttribute("position");
    this.corners.forEach((node, i) => position.setXYZ(i, places[0][node], places[1][node], places[2][node]));
    position.needsUpdate = true;
    this.geometry.computeBoundingSphere();
    this.geometry.computeBoundingBox();
  }

  /// Colours the nodes by shares 0 … 1 or numbers of classes: the faces whose corners all have one. A body without any
  /// is drawn as glass behind the others, so that their colours are true.
  paint(shares) {
    const values = this.geometry.getAttribute("values");
    const isWithout = (i) => [0, 1, 2].some((vertex) => shares[this.corners[i + vertex]] === NO_SHARE);
    for (let i = 0; i < this.corners.length; i += 3) {
      const other = i >= 3 * this.halves ? i : i % 6 === 0 ? i + 3 : i - 3;
      const isGrey = isWithout(i) || isWithout(other);
      const [a, b, c] = [0, 1, 2].map((vertex) => (isGrey ? NO_SHARE : shares[this.corners[i + vertex]]));
      for (let vertex = 0; vertex < 3; vertex++) values.setXYZ(i + vertex, a, b, c);
    }
    values.needsUpdate = true;
    this.isGhost = shares.every((share) => share === NO_SHARE);
    this.material.uniforms.ghost.value = this.isGhost;
    this.material.depthWrite = !this.isGhost;
    this.mesh.renderOrder = this.isGhost ? -1 : 0;
  }

  /// The place of a node as it is drawn.
  drawn(node) {
    return new Vector3(...this.places.map((axis) => axis[node]));
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// The view with its controls

/// An element with attributes and children.
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && key !== "style") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/// A choice among texts, hidden where there is only one.
function choice(label, texts, changed) {
  const select = element("select", {}, ...texts.map((text, value) => element("option", { value }, text)));
  select.addEventListener("change", changed);
  return { select, label: element("label", { hidden: texts.length < 2 }, `${label} `, select) };
}

class View {
  constructor(figure, data) {
    [this.figure, this.data, this.header] = [figure, data, data.header];
    // A scene before any solve has no displacements.
    const isMoved = ({ low, high }) => low !== 0 || high !== 0;
    this.moves = this.header.states.some((state) => state.displacement.some((axes) => axes.some(isMoved)));
    // Displacements have three parts; their length is the last field.
    const length = { name: "displacement", unit: this.header.length, classes: [], length: true };
    this.fields = this.moves ? [...this.header.fields, length] : this.header.fields;
    this.uniforms = {
      scale: { value: this.header.scale.map(rgb) },
      grey: { value: rgb(GREY) },
      classes: { value: false },
      lines: { value: true },
    };
    this.skins = this.header.bodies.map((body) => new Skin(data, body, this.uniforms));
    this.scene = new Scene();
    this.scene.add(...this.skins.map((skin) => skin.mesh));
    this.buildPage();
    this.buildCamera();
    this.update();
    this.fit();
  }

  // -- page

  buildPage() {
    const update = () => this.update();
    const { shapes, cases, bodies } = this.header;
    this.shape = choice(
      "Shape",
      shapes.map((shape) => shape.name),
      update,
    );
    // The last shape is the one found.
    this.shape.select.selectedIndex = shapes.length - 1;
    this.case = choice("Load case", cases, update);
    this.field = choice(
      "Colours",
      this.fields.map((field) => field.name),
      update,
    );
    this.times = element("input", { type: "number", min: "0", step: "any", value: String(this.header.times) });
    this.times.addEventListener("input", update);
    const magnify = (value) => {
      const button = element("button", { type: "button" }, `× ${value}`);
      button.addEventListener("click", () => {
        this.times.value = String(value);
        this.update();
      });
      return button;
    };
    const factors = [...new Set([0, 1, this.header.times])].map(magnify);
    this.apart = element("input", { type: "range", min: "0", max: "3", step: "0.05", value: "0" });
    this.apart.addEventListener("input", update);
    this.common = element("input", { type: "checkbox", checked: true });
    this.common.addEventListener("change", update);
    this.lines = element("input", { type: "checkbox", checked: true });
    this.lines.addEventListener("change", update);
    this.shown = bodies.map(() => element("input", { type: "checkbox", checked: true }));
    this.shown.forEach((box) => box.addEventListener("change", update));
    const boxes = bodies.map((body, index) =>
      element("label", { hidden: bodies.length < 2 }, this.shown[index], ` ${body.name}`),
    );
    const several = this.header.states.length > 1;
    const apart = bodies.some((body) => body.apart.some((part) => part !== 0));
    this.reset = element("button", { type: "button" }, "Whole view");
    this.reset.addEventListener("click", () => this.fit());
    this.bar = element("div", { className: "space-bar" });
    this.told = element("output", { className: "space-told" });
    this.told.setAttribute("aria-live", "polite");
    this.canvas = element("canvas", { tabIndex: 0 });
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "Bodies in space. Arrow keys turn them, plus and minus zoom.");
    this.marker = element("span", { className: "space-marker", hidden: true });
    this.axes = element("div", { className: "space-axes" });
    this.stage = element("div", { className: "card space-stage" }, this.canvas, this.marker, this.axes);
    const line = (...children) => element("div", { className: "space-line" }, ...children);
    this.figure
      .querySelector(".space-view")
      .replaceChildren(
        line(
          this.shape.label,
          this.case.label,
          this.field.label,
          element("label", { hidden: !several }, this.common, " one scale for all"),
        ),
        line(
          element("label", { hidden: !this.moves }, "Displacements × ", this.times),
          ...(this.moves ? factors : []),
          element("label", { hidden: !apart }, "Bodies apart ", this.apart),
        ),
        line(...boxes, element("label", {}, this.lines, " mesh lines"), this.reset),
        this.stage,
        this.bar,
        this.nodeForm(line),
        this.told,
      );
    this.told.textContent = "Click a node for its number, place and values.";
  }

  /// Nodes by number, and the one of the largest value: picking without a mouse.
  nodeForm(line) {
    this.body = choice(
      "Body",
      this.header.bodies.map((body) => body.name),
      () => {},
    );
    this.number = element("input", { type: "number", min: "0", step: "1", value: "0" });
    const show = element("button", { type: "submit" }, "Show node");
    const largest = element("button", { type: "button" }, "Largest value");
    largest.addEventListener("click", () => this.tell(this.largest()));
    const form = element("form", {}, line(this.body.label, element("label", {}, "Node ", this.number), show, largest));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const body = this.body.select.selectedIndex;
      const node = this.skins[body].numbers.indexOf(Number(this.number.value));
      if (node >= 0) this.tell({ body, node });
      else this.told.textContent = `Node ${this.number.value} of ${this.skins[body].name} is not on its skin.`;
    });
    return form;
  }

  buildCamera() {
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setClearColor(0xffffff, 1);
    this.camera = new OrthographicCamera();
    this.camera.up.set(0, 0, 1);
    // The wheel scrolls the page until the view has been clicked.
    const wheel = (event) => document.activeElement === this.canvas || event.stopImmediatePropagation();
    this.canvas.addEventListener("wheel", wheel, { capture: true, passive: true });
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.canvas.addEventListener("webglcontextrestored", () => this.draw());
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    let pressed = [0, 0];
    this.canvas.addEventListener("pointerdown", (event) => {
      pressed = [event.clientX, event.clientY];
      this.canvas.focus({ preventScroll: true });
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > CLICK || event.button !== 0) return;
      this.tell(this.pick(event.clientX, event.clientY));
    });
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  // -- what is shown

  get state() {
    const [shape, load] = [this.shape.select.selectedIndex, this.case.select.selectedIndex];
    return this.header.states.find((state) => state.shape === shape && state.case === load);
  }

  /// Values of a field at the nodes of a body, with the distance of their levels; nothing where it has none.
  values(state, field, body) {
    if (!this.fields[field].length) {
      const array = state.values[field][body];
      return array && { values: this.data.levels(array), low: array.low, high: array.high, step: stepOf(array) };
    }
    const parts = state.displacement[body].map((array) => this.data.levels(array));
    const values = parts[0].map((_, node) => Math.hypot(...parts.map((part) => part[node])));
    const step = Math.max(...state.displacement[body].map(stepOf));
    return {
      values,
      low: values.reduce((a, b) => Math.min(a, b)),
      high: values.reduce((a, b) => Math.max(a, b)),
      step,
    };
  }

  /// Least and largest value of a field, in one state or in all.
  range(field) {
    const states = this.common.checked ? this.header.states : [this.state];
    const found = states.flatMap((state) =>
      this.skins.map((_, body) => this.values(state, field, body)).filter(Boolean),
    );
    if (found.length === 0) return [0, 1];
    return [Math.min(...found.map((own) => own.low)), Math.max(...found.map((own) => own.high))];
  }

  /// Shows the chosen shape, load case, field and displacements.
  update() {
    const [state, field] = [this.state, this.field.select.selectedIndex];
    if (!state) return;
    const { classes } = this.fields[field];
    const isClass = classes.length > 0;
    const [low, high] = isClass ? [0, 1] : this.range(field);
    const times = Math.max(Number(this.times.value) || 0, 0);
    this.skins.forEach((skin, body) => {
      const places = this.header.shapes[state.shape].places[body].map((array) => this.data.levels(array));
      const moves = state.displacement[body].map((array) => this.data.levels(array));
      const apart = skin.apart.map((part) => Number(this.apart.value) * part);
      skin.place(places.map((axis, i) => axis.map((x, node) => x + times * moves[i][node] + apart[i])));
      const own = this.values(state, field, body);
      const share = (value) =>
        Number.isNaN(value) ? NO_SHARE : isClass ? value : high > low ? (value - low) / (high - low) : 0.5;
      skin.paint(own ? Float32Array.from(own.values, share) : new Float32Array(skin.numbers.length).fill(NO_SHARE));
      skin.mesh.visible = this.shown[body].checked;
    });
    const colours = isClass ? this.header.classColours : this.header.scale;
    this.uniforms.scale.value = Array.from({ length: 17 }, (_, i) => rgb(colours[i % colours.length]));
    this.uniforms.classes.value = isClass;
    this.uniforms.lines.value = this.lines.checked;
    this.legend(this.fields[field], [low, high]);
    if (this.picked) this.tell(this.picked);
    this.draw();
  }

  legend({ name, unit, classes }, [low, high]) {
    const swatch = (colour) => element("span", { className: "space-swatch", style: `background:${colour}` });
    const without = this.skins.some((skin) => skin.isGhost)
      ? "Bodies that have no such values are drawn as glass behind the others."
      : "";
    if (classes.length > 0) {
      const { classColours } = this.header;
      this.bar.replaceChildren(
        ...classes.flatMap((label, i) => [swatch(classColours[i % classColours.length]), label]),
        ". ",
        without,
      );
      return;
    }
    const step = (high - low) / 1000;
    const gradient = element("span", {
      className: "space-gradient",
      style: `background:linear-gradient(90deg,${this.header.scale.join(",")})`,
    });
    this.bar.replaceChildren(`${name}: `, written(low, step), gradient, `${written(high, step)} ${unit}. `, without);
  }

  // -- camera

  /// Everything in the middle, seen as in the pictures of the report.
  fit() {
    const [low, high] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
    for (const { geometry } of this.skins) {
      low.min(geometry.boundingBox.min);
      high.max(geometry.boundingBox.max);
    }
    const centre = low.clone().add(high).multiplyScalar(0.5);
    this.radius = Math.max(0.5 * low.distanceTo(high), 1e-9);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(new Vector3(...this.header.towards), 4 * this.radius);
    [this.camera.near, this.camera.far, this.camera.zoom] = [0, 12 * this.radius, 1];
    this.resize();
    this.controls.update();
  }

  resize() {
    const [width, height] = [this.stage.clientWidth, this.stage.clientHeight];
    if (width === 0 || height === 0) return;
    const half = (1.02 * this.radius) / Math.min(1, width / height);
    Object.assign(this.camera, {
      top: half,
      bottom: -half,
      right: (half * width) / height,
      left: (-half * width) / height,
    });
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(width, height, false);
    this.draw();
  }

  /// Turns by angles around the third axis and above the horizon.
  turn(around, above) {
    // The third axis points upwards; Spherical has the second one there.
    const offset = this.camera.position.clone().sub(this.controls.target);
    const place = new Spherical().setFromCartesianCoords(offset.y, offset.z, offset.x);
    place.theta += around;
    place.phi = Math.min(Math.max(place.phi - above, 0.01), Math.PI - 0.01);
    const turned = new Vector3().setFromSpherical(place);
    this.camera.position.copy(this.controls.target).add(new Vector3(turned.z, turned.x, turned.y));
    this.controls.update();
    this.draw();
  }

  key(event) {
    const angle = Math.PI / 36;
    const turns = { ArrowLeft: [-angle, 0], ArrowRight: [angle, 0], ArrowUp: [0, angle], ArrowDown: [0, -angle] };
    const zooms = { "+": 1.1, "=": 1.1, "-": 1 / 1.1 };
    if (event.key in turns) this.turn(...turns[event.key]);
    else if (event.key in zooms) {
      this.camera.zoom *= zooms[event.key];
      this.camera.updateProjectionMatrix();
      this.draw();
    } else return;
    event.preventDefault();
  }

  draw() {
    if (this.radius === undefined) return;
    this.renderer.render(this.scene, this.camera);
    this.mark();
    this.drawAxes();
  }

  drawAxes() {
    const ends = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
    const arrow = (end, index) => {
      const { x, y } = end.transformDirection(this.camera.matrixWorldInverse);
      const [to, text] = [26, 36].map((length) => [40 + length * x, 40 - length * y].map((part) => part.toFixed(1)));
      return `<path d="M40 40L${to.join(" ")}" stroke="#222"/><text x="${text[0]}" y="${text[1]}">x${"₁₂₃"[index]}</text>`;
    };
    const style = 'font-size="11" text-anchor="middle" dominant-baseline="middle" fill="#222"';
    this.axes.innerHTML = `<svg width="80" height="80" aria-hidden="true" ${style}>${ends.map(arrow).join("")}</svg>`;
  }

  // -- nodes

  /// Where a node is drawn, in pixels from the left and top of the canvas.
  project({ body, node }) {
    const place = this.skins[body].drawn(node).project(this.camera);
    return [0.5 * (place.x + 1) * this.stage.clientWidth, 0.5 * (1 - place.y) * this.stage.clientHeight];
  }

  /// The node nearest to a place of the window, of the face that is seen there; nothing beside the bodies.
  pick(x, y) {
    const frame = this.canvas.getBoundingClientRect();
    const [left, top] = [x - frame.left, y - frame.top];
    const pointer = new Vector2((2 * left) / frame.width - 1, 1 - (2 * top) / frame.height);
    const caster = new Raycaster();
    caster.setFromCamera(pointer, this.camera);
    const solid = this.skins.filter((skin) => skin.mesh.visible && !skin.isGhost);
    const [hit] = caster.intersectObjects(
      solid.map((skin) => skin.mesh),
      false,
    );
    if (!hit) return undefined;
    const body = this.skins.findIndex((skin) => skin.mesh === hit.object);
    const corners = [...this.skins[body].corners.subarray(3 * hit.faceIndex, 3 * hit.faceIndex + 3)];
    const distance = (node) => {
      const [u, v] = this.project({ body, node });
      return Math.hypot(u - left, v - top);
    };
    const node = corners.reduce((best, other) => (distance(other) < distance(best) ? other : best));
    return { body, node };
  }

  /// The node of the largest value of the chosen field on the bodies that are shown.
  largest() {
    let best;
    this.skins.forEach((skin, body) => {
      const own = skin.mesh.visible && this.values(this.state, this.field.select.selectedIndex, body);
      if (own)
        own.values.forEach(
          (value, node) =>
            (best === undefined || value > best.value) && !Number.isNaN(value) && (best = { body, node, value }),
        );
    });
    return best;
  }

  /// Number, place and values of a node.
  facts({ body, node }) {
    const state = this.state;
    const places = this.header.shapes[state.shape].places[body];
    const place = places.map((array) => ({ value: this.data.levels(array)[node], step: stepOf(array) }));
    const values = this.fields.map(({ name, unit, classes }, field) => {
      const own = this.values(state, field, body);
      return { name, unit, classes, value: own ? own.values[node] : NaN, step: own ? own.step : 0 };
    });
    return { body: this.skins[body].name, number: this.skins[body].numbers[node], place, values };
  }

  /// Says what is known of a node, and marks it.
  tell(picked) {
    this.picked = picked;
    if (!picked) {
      this.told.textContent = "There is no node with values. Click a coloured face.";
    } else {
      const { body, number, place, values } = this.facts(picked);
      const at = place.map(({ value, step }) => written(value, step)).join(", ");
      const known = values.filter(({ value }) => !Number.isNaN(value));
      const words = ({ name, unit, classes, value, step }) =>
        classes.length > 0 ? `${name} ${classes[Math.round(value)]}` : `${name} ${written(value, step)} ${unit}`;
      this.told.textContent = `${body}, node ${number} at (${at}) ${this.header.length}: ${known.map(words).join(", ")}`;
    }
    this.draw();
  }

  mark() {
    this.marker.hidden = !this.picked;
    if (this.picked) {
      const [x, y] = this.project(this.picked);
      this.marker.style.transform = `translate(${x}px, ${y}px)`;
    }
  }
}

/// Builds the view of a figure; a browser that cannot says so.
async function open(figure) {
  const note = figure.querySelector(".space-view");
  try {
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("it needs WebGL 2");
    const data = new Data(await unpacked(figure.querySelector("script").textContent));
    // For tests, and for the console of a curious reader.
    figure.view = new View(figure, data);
    figure.dataset.ready = String(Math.round(performance.now()));
  } catch (error) {
    const why = `This browser cannot show the view in three dimensions: ${error.message}.`;
    note.textContent = `${why} The pictures of the report show the same fields.`;
  }
}

// A view is built when it comes near the window.
const watch = new IntersectionObserver(
  (entries) => {
    for (const { target } of entries.filter((entry) => entry.isIntersecting)) {
      watch.unobserve(target);
      open(target);
    }
  },
  { rootMargin: "600px" },
);
for (const figure of document.querySelectorAll("figure.space")) {
  figure.hidden = false;
  watch.observe(figure);
}
