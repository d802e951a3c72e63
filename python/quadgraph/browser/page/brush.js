// Of the page of `quadgraph serve`: several bodies, the brush and its layers, cuts. page.js has the rest.
"use strict";

const CLICK_PIXELS = 5;  // that a click may move
const MOST_PLACES = 64;  // of a stroke in one message
const PATIENCE_MS = 500;  // with an answer about rings
const RADIUS_STEPS = { least: -3, most: 3 };  // powers of two of what it is at first
const POWERS = ["radius", "depth", "distance"];

const EYE = '<svg viewBox="0 0 20 20"><path d="M2 10q8 9 16 0"/><g class="open"><path d="M2 10q8-9 16 0"/><circle cx="10" cy="10" r="2.4"/></g></svg>';

let hello = {};
let body = "";  // whose material is changed; empty: that of all
let layer = 0;  // the active one
let paints = false;
let brush = { tool: "paint" };
let pointed = null;  // where the pointer is that may paint
let asked = -Infinity;  // when rings were asked for that have not come
let asksAgain = false;
let stroke = null;  // that is being led, or whose beginning has not been answered

// Where the picture lies in the view, pixels.
function pictureBox() {
  const box = $("view").getBoundingClientRect(), { width, height } = said.scene.picture;
  const scale = Math.min(box.width / width, box.height / height), wide = width * scale, high = height * scale;
  return { box, left: (box.width - wide) / 2, top: (box.height - high) / 2, wide, high };
}

// Where a pointer is in the picture: shares of its width and height, right and down.
function place(event) {
  const { box, left, top, wide, high } = pictureBox();
  return [(event.clientX - box.left - left) / wide, (event.clientY - box.top - top) / high];
}

function greetBrush(told) {
  hello = told;
  $("body-part").hidden = told.bodies.length < 2;
  fill($("body"), ["", ...told.bodies], (name) => name || "All");
  brush = { ...told.brush, tool: "paint" };
  greetStamps(told);
  $("brush-colour").value = hex(brush.colour);
  if (!$("placement").children.length) buildPlacement();
  fill($("mirror"), Object.keys(told.mirrors), (name) => told.mirrors[name]);
  fill($("method"), told.methods, (name) => name);
  fill($("model"), told.models, (name) => name);
  showBrush();
}

// Bodies

function choose(name, at) {
  body = name || "";
  $("body").value = body;
  if (said) controls(said);
  if (!at) return;
  const badge = $("badge");
  badge.textContent = body ? `Body: ${body}` : "All bodies";
  badge.style.left = `${at[0]}px`;
  badge.style.top = `${at[1]}px`;
  badge.hidden = false;
  clearTimeout(badge.timer);
  badge.timer = setTimeout(() => { badge.hidden = true; }, 1500);
}

const materialOf = (scene) => String((body && (scene.materials || {})[body]) || scene.material);
const materialPlace = () => (body ? `/materials/${body}` : "/material");

// Where the chosen body is put: three sliders each of "position", mm, and "rotation", degrees.
function buildPlacement() {
  const [low, high] = hello.box, reach = Math.hypot(...[0, 1, 2].map((k) => high[k] - low[k]));
  const fine = 10 ** Math.floor(Math.log10(reach / 200));  // a tenth of a mm on bodies of some centimetres
  for (const [member, word, most, step] of [["position", "Move", reach, fine], ["rotation", "Turn", 180, 1]]) {
    for (let k = 0; k < 3; ++k) {
      const line = document.createElement("label"), id = `${member}-${k}`;
      line.innerHTML = `${word} ${"XYZ"[k]} <input id="${id}" type="range" min="${-Math.ceil(most)}" max="${Math.ceil(most)}" step="${step}"><output></output>`;
      $("placement").append(line);
      slider(id, (value) => set(`/placements/${body}/${member}`, poseOf(said.scene)[member].map((x, i) => (i === k ? value : x))));
    }
  }
}

const poseOf = (scene) => ({ position: [0, 0, 0], rotation: [0, 0, 0], ...((scene.placements || {})[body] || {}) });

function showPlacement(scene) {
  $("placement").hidden = !body || body in hello.hosts;  // what lies within another moves with it
  const pose = poseOf(scene);
  for (let k = 0; k < 3 && body; ++k) {
    put(`position-${k}`, pose.position[k], `${pose.position[k].toFixed(1)} mm`);
    put(`rotation-${k}`, pose.rotation[k], `${Math.round(pose.rotation[k])}°`);
  }
}

// The brush

function showBrush() {
  const millimetres = (value) => `${value.toPrecision(2)} mm`;
  for (const id of POWERS) {
    $(id).value = Math.log2(brush[id] / hello.brush[id]);
    $(id).parentElement.querySelector("output").textContent = millimetres(brush[id]);
  }
  $("falloff").value = brush.falloff / brush.radius;
  $("falloff").parentElement.querySelector("output").textContent = millimetres(brush.falloff);
  showFrom();
  $("strength").value = brush.strength;
  $("strength").parentElement.querySelector("output").textContent = `${Math.round(100 * brush.strength)}%`;
  $("mirror").value = brush.mirror;
  $("paints").checked = paints;
  for (const radio of document.getElementsByName("tool")) radio.checked = radio.value === brush.tool;
  $("view").classList.toggle("paints", paints);
}

function take(on) {
  paints = on;
  showBrush();
  askRings();
}

// Rings on the body, as far as the brush reaches; one question at a time.

function point(event) {
  pointed = event && said && (!drag || drag.paint) ? place(event) : null;
  askRings();
}

function askRings() {
  if (!paints || !pointed) return drawRings([]);
  const now = performance.now();
  asksAgain = now - asked < PATIENCE_MS;
  if (asksAgain) return;
  asked = now;
  send({ ring: { ...brush, layer }, at: pointed });
}

function hearRings(found) {
  asked = -Infinity;
  drawRings(paints && pointed ? found : []);
  if (asksAgain) askRings();
}

function drawRings(found) {
  const { left, top, wide, high } = found.length ? pictureBox() : {};
  $("rings").replaceChildren(...found.flatMap((ring) => {
    const points = ring.map(([x, y]) => `${left + x * wide},${top + y * high}`).join(" ");
    return ["edge", "colour", "line"].map((part) => {
      const made = document.createElementNS("http://www.w3.org/2000/svg", "polygon");
      made.setAttribute("class", part);
      made.setAttribute("points", points);
      if (part === "colour") made.setAttribute("stroke", hex(brush.colour));
      return made;
    });
  }));
}

function paint(at, begins) {
  send({ paint: { ...brush, layer }, at, begins });
}

// What the server says of a stroke that begins: only then it is known whether that is on a body.
function painted(state) {
  layered(state);
  if (!stroke) return;
  const here = stroke;
  here.waits = false;
  if (state.touched && here.tool === "pick") {
    Object.assign(brush, { tool: "paint", colour: state.colour, distance: state.distance });
    $("brush-colour").value = hex(state.colour);
    showBrush();
  }
  if (state.touched && here.tool !== "pick") return flush();
  stroke = null;
  if (!state.touched) turnInstead(here);
}

// A drag that began beside the bodies turns them, by what it has moved meanwhile, and from there on.
function turnInstead(here) {
  const [x, y] = here.last;
  if (here.drag.x !== x || here.drag.y !== y) orbit(x - here.drag.x, here.drag.y - y);
  Object.assign(here.drag, { paint: false, x, y });
  if (here.ended) send({ do: "end" });
}

function flush() {
  while (stroke.places.length) paint(stroke.places.splice(0, MOST_PLACES), false);
  if (!stroke.ended) return;
  send({ do: "end" });
  stroke = null;
}

function beginStroke(event) {
  drag.paint = true;
  stroke = { waits: true, ended: false, tool: brush.tool, places: [], drag, last: [drag.x, drag.y] };
  paint([place(event)], true);
}

function leadStroke(event) {
  if (!stroke) return;
  stroke.places.push(place(event));
  stroke.last = [event.clientX, event.clientY];
  if (!stroke.waits) flush();
}

// Whether the end of it is said later, with what is still to be said.
function endStroke() {
  if (!stroke) return false;
  stroke.ended = true;
  if (!stroke.waits) flush();
  return true;
}

// Layers, the topmost first

function layered(state) {
  layer = state.layer;
  said.layers = state.layers;
  layers(said.layers);
}

function layers(all) {
  layer = Math.min(layer, Math.max(all.length - 1, 0));
  const list = $("layers"), state = JSON.stringify([all, layer]);
  if (list.dataset.state !== state && !list.contains(document.activeElement)) {
    list.dataset.state = state;
    list.replaceChildren(...all.map(layerRow).reverse());
  }
  $("no-layers").hidden = all.length > 0;
  const active = all[layer];
  $("opacity").disabled = !active;
  put("opacity", active ? active.opacity : 1, active ? `${Math.round(100 * active.opacity)}%` : "");
  $("remove-layer").disabled = !active;
  $("layer-up").disabled = !active || layer + 1 >= all.length;
  $("layer-down").disabled = !active || layer === 0;
}

function change(what, value, of = layer) {
  send({ layers: value === undefined ? { layer: of, change: what } : { layer: of, change: what, value } });
}

function layerRow(each, i) {
  const made = document.createElement("li");
  made.innerHTML = `<div class="line"><button class="eye">${EYE}</button><input type="text" maxlength="64" aria-label="Name"><span></span></div>`;
  made.classList.toggle("selected", i === layer);
  const eye = made.querySelector(".eye"), name = made.querySelector("input");
  eye.setAttribute("aria-label", each.visible ? "Hide the layer" : "Show the layer");
  eye.setAttribute("aria-pressed", String(each.visible));
  eye.addEventListener("click", () => { eye.blur(); change("visible", !each.visible, i); });
  name.value = each.name;
  name.addEventListener("change", () => { name.blur(); change("name", name.value, i); });
  name.addEventListener("keydown", (event) => event.key === "Enter" && name.blur());
  made.querySelector("span").textContent = each.strokes;
  made.querySelector("span").title = "Strokes";
  made.addEventListener("pointerdown", (event) => {
    if (event.target === eye) return;
    layer = i;
    [...$("layers").children].forEach((row) => row.classList.toggle("selected", row === made));
    layers(said.layers);
  });
  return made;
}

// Cuts: one plane across an axis

function cutOf(scene) {
  const plane = scene.cuts.length === 1 && scene.cuts[0].type === "plane" ? scene.cuts[0] : null;
  const axis = plane ? plane.normal.findIndex((part) => part !== 0) : -1;
  if (!plane || plane.normal.filter((part) => part !== 0).length !== 1) return null;
  const sign = Math.sign(plane.normal[axis]), length = Math.abs(plane.normal[axis]);
  return { axis, sign, offset: (sign * plane.offset) / length };
}

function showCut(scene) {
  const cut = cutOf(scene), axis = cut ? cut.axis : Number($("cut-axis").value);
  put("cut", scene.cuts.length > 0);
  const low = hello.box[0][axis], high = hello.box[1][axis], slide = $("cut-offset");
  if (slide !== document.activeElement) Object.assign(slide, { min: low, max: high, step: (high - low) / 200 });
  for (const id of ["cut-axis", "cut-offset", "cut-flip"]) $(id).disabled = !cut;
  if (!cut) return;
  put("cut-axis", String(axis));
  put("cut-offset", cut.offset, `${cut.offset.toFixed(1)} mm`);
  put("cut-flip", cut.sign < 0);
}

function setCut() {
  const axis = Number($("cut-axis").value), sign = $("cut-flip").checked ? -1 : 1;
  const low = hello.box[0][axis], high = hello.box[1][axis], cut = cutOf(said.scene);
  const moved = !cut || cut.axis !== axis ? (low + high) / 2 : Number($("cut-offset").value);
  const normal = [0, 1, 2].map((k) => (k === axis ? sign : 0));
  set("/cuts", [{ type: "plane", normal, offset: sign * moved }]);
}

function controlsOfBrush(frame) {
  layers(frame.layers);
  showSaving(frame.sent);
  showCut(frame.scene);
  showPlacement(frame.scene);
  put("method", frame.scene.solver.method);
  $("method").disabled = frame.scene.cuts.length > 0;
  put("model", frame.scene.solver.model);
  put("correction", frame.scene.solver.correction);
  $("redo").disabled = !frame.redo;
}

function listenBrush() {
  $("body").addEventListener("change", () => choose($("body").value));
  $("paints").addEventListener("change", () => take($("paints").checked));
  for (const radio of document.getElementsByName("tool")) {
    radio.addEventListener("change", () => { brush.tool = radio.value; });
  }
  $("brush-colour").addEventListener("input", (event) => { brush.colour = linear(event.target.value); });
  const slide = (id, took) => $(id).addEventListener("input", () => { took(Number($(id).value)); showBrush(); });
  for (const id of POWERS) {
    Object.assign($(id), { min: RADIUS_STEPS.least, max: RADIUS_STEPS.most, step: 0.1 });
    slide(id, (power) => {
      const share = brush.falloff / brush.radius;
      brush[id] = hello.brush[id] * 2 ** power;
      brush.falloff = share * brush.radius;
    });
  }
  slide("falloff", (share) => { brush.falloff = share * brush.radius; });
  slide("strength", (share) => { brush.strength = share; });
  listenStamps();
  $("mirror").addEventListener("change", () => { brush.mirror = $("mirror").value; });
  slider("opacity", (share) => change("opacity", share));
  $("add-layer").addEventListener("click", () => change("add"));
  $("remove-layer").addEventListener("click", () => change("remove"));
  $("layer-up").addEventListener("click", () => change("up"));
  $("layer-down").addEventListener("click", () => change("down"));
  $("cut").addEventListener("change", () => ($("cut").checked ? setCut() : set("/cuts", [])));
  $("cut-axis").addEventListener("change", setCut);
  $("cut-flip").addEventListener("change", setCut);
  slider("cut-offset", setCut);
  $("method").addEventListener("change", () => set("/solver/method", $("method").value));
  $("model").addEventListener("change", () => set("/solver/model", $("model").value));
  $("correction").addEventListener("change", () => set("/solver/correction", $("correction").checked));
  $("redo").addEventListener("click", () => send({ do: "redo" }));
}
