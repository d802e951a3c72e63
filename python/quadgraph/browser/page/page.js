// The page of `quadgraph serve`: shows frames as they come, and says what a hand did.
"use strict";

const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get("token") || "";
const STRENGTHS = ["irradiance", "power", "radiance"];
const ROUGHNESS = 0.3;  // where neither picture nor material says one
const PIXELS_LEAST = 64, PIXELS_MOST = 2048;
const DEGREES_PER_PIXEL = 0.4;

let socket = null, waits = 500;
let said = null;  // of the last frame
let selected = 0;  // light
let drag = null;
let url = null;  // of the picture
const picks = [];  // where the clicks were whose body is asked for, pixels

function send(message) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

function set(pointer, value) {
  send({ set: pointer, value });
}

function connect() {
  const address = new URL("live", location.href);
  address.protocol = address.protocol.replace("http", "ws");
  address.searchParams.set("token", token);
  socket = new WebSocket(address);
  socket.binaryType = "blob";
  socket.onopen = () => { waits = 500; sendSize(); };
  socket.onmessage = (event) => (typeof event.data === "string" ? hear(JSON.parse(event.data)) : show(event.data));
  socket.onclose = (event) => {
    $("status").textContent = event.code === 1001 ? "the server has ended" : "no connection; trying again …";
    document.body.dataset.state = "away";
    setTimeout(connect, waits);
    waits = Math.min(2 * waits, 8000);
  };
}

function hear(message) {
  if (message.hello) greet(message.hello);
  if (message.frame) tell(message.frame);
  if ("picked" in message) choose(message.picked, picks.shift());
  if (message.rings) hearRings(message.rings);
  if (message.painted) painted(message.painted);
  if (message.layered) layered(message.layered);
  if (message.film) hearFilm(message.film);
  if (message.refused) {
    stroke = null;
    trouble(message.refused);
    if (said) controls(said);
  }
}

function greet(hello) {
  document.title = $("file").textContent = hello.file;
  fill($("material"), ["", ...hello.materials], (name) => name || "(as text)");
  fill($("tone"), hello.tones, (name) => name);
  greetBrush(hello);
  greetFilm(hello);
}

function fill(select, values, label) {
  select.replaceChildren(...values.map((value) => new Option(label(value), value)));
}

function trouble(text) {
  $("trouble").textContent = text;
  $("trouble").hidden = !text;
}

function tell(frame) {
  said = frame;
  const size = frame.width ? `${frame.width} × ${frame.height}` : "";
  $("status").textContent = frame.rest ? `at rest: ${size}, ${(frame.ms / 1000).toFixed(1)} s`
    : `in motion: ${size}, ${frame.ms.toFixed(0)} ms …`;
  $("error").textContent = frame.error || "";
  if (frame.rest) trouble(frame.trouble || "");
  if (frame.rest && frame.notes) {
    $("notes").replaceChildren(...frame.notes.map((note) => item(note)));
  }
  document.body.dataset.state = frame.rest ? "rest" : "motion";
  document.body.dataset.serial = frame.serial;
  if (!frame.width) send({ shown: frame.serial });
  controls(frame);
  askRings();
}

function item(text) {
  const made = document.createElement("li");
  made.textContent = text;
  return made;
}

function show(blob) {
  const serial = said.serial, before = url;
  url = URL.createObjectURL(blob);
  const image = $("picture");
  image.onload = () => {
    if (before) URL.revokeObjectURL(before);
    document.body.dataset.shown = serial;
    send({ shown: serial });
  };
  image.src = url;
}

// What the controls show, except one that a hand is on.
function put(id, value, text) {
  const element = $(id);
  if (element !== document.activeElement || element.type !== "text") {
    if (element.type === "checkbox") element.checked = value;
    else if (document.activeElement !== element || element.tagName === "SELECT") element.value = value;
  }
  const output = element.parentElement.querySelector("output");
  if (output) output.textContent = text === undefined ? String(element.value) : text;
}

// What a material's text says of a coat, and all else that it says.
const coatPart = (part) => /^coat(_eta|_roughness)?=/.test(part);
const withoutCoat = (text) => text.split(",").filter((part) => !coatPart(part)).join(",");
const coatOf = (text) => (text.split(",").find((part) => part.startsWith("coat=")) || "coat=").slice(5);

function controls(frame) {
  const scene = frame.scene, picture = scene.picture, material = materialOf(scene);
  const bare = withoutCoat(material), named = [...$("material").options].some((option) => option.value === bare);
  put("material", named ? bare : "");
  put("coat", coatOf(material));
  put("material-text", material);
  const roughness = frame.roughness ?? ROUGHNESS;
  put("roughness", roughness, roughness.toFixed(2));
  const twist = scene.deformation.find((step) => step.type === "twist");
  put("twist", twist ? twist.degrees : 0, `${twist ? Math.round(twist.degrees) : 0}°`);
  const auto = picture.exposure === "auto";
  put("auto-exposure", auto);
  $("exposure").disabled = auto;
  put("exposure", auto ? 0 : picture.exposure, auto ? "auto" : picture.exposure.toFixed(1));
  put("tone", picture.tone);
  put("ground", picture.ground);
  $("undo").disabled = !frame.undo;
  lights(scene.lights);
  controlsOfBrush(frame);
}

function strength(light) {
  return STRENGTHS.find((name) => name in light);
}

// Built anew where lights come and go; else only what they show, so that a slider stays under the hand.
function lights(all) {
  const list = $("lights");
  selected = Math.min(selected, Math.max(all.length - 1, 0));
  if (list.children.length !== all.length || [...list.children].some((row, i) => row.dataset.type !== all[i].type)) {
    list.replaceChildren(...all.map(row));
  }
  all.forEach((light, i) => {
    const made = list.children[i], name = strength(light);
    made.classList.toggle("selected", i === selected);
    if (!name) return;
    const rgb = [].concat(light[name]), all_channels = rgb.length === 3 ? rgb : [rgb[0], rgb[0], rgb[0]];
    const most = Math.max(...all_channels);
    if (made.dataset.most === undefined && most > 0) made.dataset.most = most;
    const slider = made.querySelector("[type=range]"), colour = made.querySelector("[type=color]");
    if (slider !== document.activeElement && made.dataset.most) {
      slider.value = most > 0 ? Math.log2(most / made.dataset.most) : slider.min;
    }
    if (colour !== document.activeElement && most > 0) colour.value = hex(all_channels.map((c) => c / most));
  });
}

function row(light, i) {
  const made = document.createElement("li");
  made.dataset.type = light.type;
  made.innerHTML = `<div class="line"><span></span><input type="color" aria-label="Colour"><button aria-label="Remove">✕</button></div>
    <input type="range" min="-6" max="6" step="0.1" aria-label="Brightness, stops">`;
  made.querySelector("span").textContent = light.type[0].toUpperCase() + light.type.slice(1);
  made.addEventListener("pointerdown", () => {
    selected = i;
    [...$("lights").children].forEach((each, k) => each.classList.toggle("selected", k === i));
  });
  made.querySelector("[type=range]").addEventListener("input", (event) => brightness(i, made, Number(event.target.value)));
  made.querySelector("[type=color]").addEventListener("input", (event) => colour(i, event.target.value));
  made.querySelector("button").addEventListener("click", () => set("/lights", said.scene.lights.filter((_, k) => k !== i)));
  return made;
}

function channels(light) {
  const rgb = [].concat(light[strength(light)]);
  return rgb.length === 3 ? rgb : [rgb[0], rgb[0], rgb[0]];
}

function brightness(i, made, stops) {
  const light = said.scene.lights[i], rgb = channels(light), most = Math.max(...rgb);
  const wanted = Number(made.dataset.most || 1) * 2 ** stops;
  set(`/lights/${i}/${strength(light)}`, most > 0 ? rgb.map((c) => (c / most) * wanted) : [wanted, wanted, wanted]);
}

function colour(i, text) {
  const light = said.scene.lights[i], most = Math.max(...channels(light)) || 1;
  const rgb = linear(text), top = Math.max(...rgb) || 1;
  set(`/lights/${i}/${strength(light)}`, rgb.map((c) => (c / top) * most));
}

const fromSrgb = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const linear = (text) => [1, 3, 5].map((k) => fromSrgb(parseInt(text.slice(k, k + 2), 16) / 255));
const toSrgb = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
const hex = (rgb) => "#" + rgb.map((c) => Math.round(255 * toSrgb(c)).toString(16).padStart(2, "0")).join("");

function sendSize() {
  const box = $("view").getBoundingClientRect(), scale = Math.min(devicePixelRatio || 1, 2);
  const fit = (side) => Math.max(PIXELS_LEAST, Math.min(PIXELS_MOST, Math.round(side * scale)));
  set("/picture/width", fit(box.width));
  set("/picture/height", fit(box.height));
}

// By pixels.
function orbit(right, up) {
  send({ gesture: "orbit", right: DEGREES_PER_PIXEL * right, up: DEGREES_PER_PIXEL * up });
}

function gestures() {
  const view = $("view");
  view.addEventListener("contextmenu", (event) => event.preventDefault());
  view.addEventListener("pointerdown", (event) => {
    view.focus();
    view.setPointerCapture(event.pointerId);
    const light = event.shiftKey || event.ctrlKey;
    drag = { x: event.clientX, y: event.clientY, pan: event.button !== 0, light };
    if (!said || drag.pan || light) return;
    if (paints) beginStroke(event);
    else drag.clicks = hello.bodies.length > 1;
  });
  view.addEventListener("pointerleave", () => point(null));
  view.addEventListener("pointermove", (event) => {
    point(event);
    if (!drag) return;
    if (drag.paint) return leadStroke(event);
    const right = event.clientX - drag.x, up = drag.y - event.clientY;
    if (drag.clicks && Math.hypot(right, up) < CLICK_PIXELS) return;
    drag.clicks = false;
    Object.assign(drag, { x: event.clientX, y: event.clientY });
    if (drag.pan) {
      const height = view.clientHeight;
      send({ gesture: "pan", right: right / height, up: up / height });
    } else if (drag.light) {
      send({ gesture: "turn", light: selected, right: DEGREES_PER_PIXEL * right, up: DEGREES_PER_PIXEL * up });
    } else orbit(right, up);
  });
  const end = () => {
    if (drag && !endStroke()) send({ do: "end" });
    drag = null;
  };
  view.addEventListener("pointerup", (event) => {
    if (drag && drag.clicks) {
      const box = view.getBoundingClientRect();
      picks.push([event.clientX - box.left, event.clientY - box.top]);
      send({ pick: place(event) });
    }
    end();
  });
  view.addEventListener("pointercancel", end);
  view.addEventListener("wheel", (event) => {
    event.preventDefault();
    send({ gesture: "zoom", up: -event.deltaY / 100 });
  }, { passive: false });
  view.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-7.5, 0], ArrowRight: [7.5, 0], ArrowUp: [0, 7.5], ArrowDown: [0, -7.5] }[event.key];
    const steps = { "+": 1, "=": 1, "-": -1, PageUp: 1, PageDown: -1 }[event.key];
    if (turn) send({ gesture: "orbit", right: turn[0], up: turn[1] });
    else if (steps) send({ gesture: "zoom", up: steps });
    else if (event.key === "p" && !event.ctrlKey && !event.metaKey) take(!paints);
    else return;
    event.preventDefault();
  });
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.target.type === "text") return;
    if (event.key === "z") send({ do: "undo" });
    if (event.key === "y") send({ do: "redo" });
  });
}

function slider(id, change) {
  $(id).addEventListener("input", () => change(Number($(id).value)));
  $(id).addEventListener("change", () => {
    $(id).blur();
    send({ do: "end" });
  });
}

function listen() {
  $("material").addEventListener("change", () => $("material").value && set(materialPlace(), $("material").value));
  $("material-text").addEventListener("change", () => set(materialPlace(), $("material-text").value));
  $("coat").addEventListener("change", () => {
    const bare = withoutCoat(materialOf(said.scene)), coat = $("coat").value;
    set(materialPlace(), coat ? `${bare},coat=${coat}` : bare);
  });
  slider("roughness", (value) => set("/picture/roughness", value));
  slider("twist", (degrees) => {
    const others = said.scene.deformation.filter((step) => step.type !== "twist");
    set("/deformation", degrees ? [...others, { type: "twist", degrees }] : others);
  });
  $("auto-exposure").addEventListener("change", () => set("/picture/exposure", $("auto-exposure").checked ? "auto" : said.exposure));
  slider("exposure", (stops) => set("/picture/exposure", stops));
  $("tone").addEventListener("change", () => set("/picture/tone", $("tone").value));
  $("ground").addEventListener("change", () => set("/picture/ground", $("ground").checked));
  $("add-light").addEventListener("click", () => send({ add: $("new-light").value }));
  listenBrush();
  $("undo").addEventListener("click", () => send({ do: "undo" }));
  $("restore").addEventListener("click", () => send({ do: "restore" }));
  $("save-image").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = `picture.png?token=${encodeURIComponent(token)}`;
    link.click();
  });
  showSaving([]);
  listenFilm();
  let resized = 0;
  addEventListener("resize", () => {
    clearTimeout(resized);
    resized = setTimeout(sendSize, 200);
  });
}

// Once the other scripts are there, too.
addEventListener("DOMContentLoaded", () => {
  gestures();
  listen();
  connect();
});
