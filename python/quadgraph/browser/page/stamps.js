// Of the page of `quadgraph serve`: what the brush stamps, and what it does to coefficients. brush.js has the rest of it.
"use strict";

const COEFFICIENTS = { sigma_a: ["Absorption", 3], sigma_s_prime: ["Scattering", 1] };  // and by what at first
const SENDABLE = 4 << 20;  // bytes of an image, as the server takes them
const STAMPED = ["mask", "pattern"];

let images = [];  // that may be stamped
let fromShare = 0;  // of the depth, at which strokes begin
let takes = "mask";  // what an image that is opened becomes

function greetStamps(told) {
  images = [...told.images];
  if (!$("coefficients").querySelector(".rgb")) Object.keys(COEFFICIENTS).forEach(buildCoefficient);
  fillImages();
  takeCoefficients();
}

function fillImages() {
  for (const member of STAMPED) {
    fill($(member), ["", ...images], (name) => name || "none");
    $(member).value = brush[member] || "";
  }
}

function stampBy(member, name) {
  if (name) brush[member] = name;
  else delete brush[member];
  fillImages();
}

// A picture of this machine: the server says what it is called from now on.
async function sendImage(file) {
  if (file.size > SENDABLE) return trouble(`image: ${file.name} has more than ${SENDABLE >> 20} MiB`);
  const address = new URL("stamp", location.href);
  address.search = new URLSearchParams({ token, name: file.name });
  try {
    const answer = await (await fetch(address, { method: "POST", body: file })).json();
    if (answer.refused) return trouble(answer.refused);
    if (!images.includes(answer.image)) images.push(answer.image);
    stampBy(takes, answer.image);
    return trouble("");
  } catch {
    return trouble("image: the server has not taken it");
  }
}

// Whether the brush changes one coefficient, and by which three numbers.
function buildCoefficient(member) {
  const line = document.createElement("div"), [word, by] = COEFFICIENTS[member];
  line.className = "rgb";
  line.innerHTML = `<label><input type="checkbox" id="${member}"> ${word}</label>` + ["red", "green", "blue"]
    .map((channel) => `<input type="number" step="any" value="${by}" aria-label="${word}, ${channel}">`).join("");
  line.querySelector("[type=checkbox]").checked = member === "sigma_a";
  $("coefficients").append(line);
  line.addEventListener("input", takeCoefficients);
}

function takeCoefficients() {
  const on = $("by-coefficients").checked;
  $("coefficients").hidden = !on;
  $("by-colour").hidden = on;
  delete brush.coefficients;
  if (!on) return;
  brush.coefficients = { operation: $("operation").value };
  for (const member of Object.keys(COEFFICIENTS)) {
    const numbers = [...$(member).closest(".rgb").querySelectorAll("[type=number]")];
    numbers.forEach((number) => { number.disabled = !$(member).checked; });
    if ($(member).checked) brush.coefficients[member] = numbers.map((number) => number.valueAsNumber || 0);
  }
}

function showFrom() {
  brush.depth_from = fromShare * brush.depth;
  put("depth-from", fromShare, `${brush.depth_from.toPrecision(2)} mm`);
}

function showSaving(sent) {
  const file = sent.length ? "scene.zip" : "scene.json";  // with the images that were sent, or without
  $("save-scene").href = `${file}?token=${encodeURIComponent(token)}`;
  $("save-scene").download = file;
}

function listenStamps() {
  for (const member of STAMPED) {
    $(member).addEventListener("change", () => stampBy(member, $(member).value));
    $(`${member}-open`).addEventListener("click", () => {
      takes = member;
      $("image-file").click();
    });
  }
  $("image-file").addEventListener("change", async () => {
    const [file] = $("image-file").files;
    if (file) await sendImage(file);
    $("image-file").value = "";  // the same file may be opened again
  });
  $("depth-from").addEventListener("input", () => {
    fromShare = Number($("depth-from").value);
    showFrom();
  });
  for (const id of ["by-coefficients", "operation"]) $(id).addEventListener("change", takeCoefficients);
}
