// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
"use strict";

// Last state from the server: {file, overview: {image, width, height} | null, photos: [{image, x, y, guess}], undo}
let state = null;
let chosen = null;  // image that the next click places
let map = null;  // Leaflet map
let dots = L.layerGroup();

const $ = (id) => document.getElementById(id);
const imageUrl = (image, small) => `/image?image=${encodeURIComponent(image)}${small ? "&small=1" : ""}`;
// L.CRS.Simple has y up, the overview y down.
const toLatLng = (x, y) => L.latLng(state.overview.height - y, x);
const toPixel = (at) => ({ x: at.lng, y: state.overview.height - at.lat });
const placed = (photo) => photo.x !== null;
const photoOf = (image) => state.photos.find((photo) => photo.image === image);

async function ask(path, options) {
  try {
    const answer = await fetch(path, options);
    const body = await answer.json();
    $("error").hidden = answer.ok;
    if (!answer.ok) $("error").textContent = body.error;
    return answer.ok ? body : null;
  } catch (error) {
    $("error").hidden = false;
    $("error").textContent = `place_map_maker does not respond: ${error.message}`;
    return null;
  }
}

async function post(path, values) {
  const body = await ask(path, {
    method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(values),
  });
  if (body) state = body;
  draw();
  return body !== null;
}

function next(after) {
  const from = state.photos.findIndex((photo) => photo.image === after) + 1;
  const order = [...state.photos.slice(from), ...state.photos.slice(0, from)];
  const open = order.find((photo) => !placed(photo));
  return open ? open.image : null;
}

async function place(image, x, y) {
  const isNew = !placed(photoOf(image));
  if (await post("/place", { image, x, y }) && isNew) choose(next(image));
}

function choose(image) {
  chosen = image;
  draw();
  const line = document.querySelector("#photos li.chosen");
  if (line) line.scrollIntoView({ block: "nearest" });
}

function step(direction) {
  const at = state.photos.findIndex((photo) => photo.image === chosen);
  const to = Math.max(0, Math.min(state.photos.length - 1, at + direction));
  if (state.photos.length) choose(state.photos[to].image);
}

function drawList() {
  const lines = state.photos.map((photo) => {
    const line = document.createElement("li");
    const picture = document.createElement("img");
    const words = document.createElement("span");
    const where = document.createElement("small");
    picture.loading = "lazy";
    picture.src = imageUrl(photo.image, true);
    words.textContent = photo.image;
    where.textContent = placed(photo) ? `${photo.id}: ${photo.x.toFixed(0)}, ${photo.y.toFixed(0)}` :
      photo.guess ? "has a GPS position" : "not placed";
    words.append(where);
    line.append(picture, words);
    line.dataset.image = photo.image;
    line.classList.toggle("placed", placed(photo));
    line.classList.toggle("chosen", photo.image === chosen);
    line.addEventListener("click", () => state.overview ? choose(photo.image) : post("/overview", { image: photo.image }));
    return line;
  });
  $("photos").replaceChildren(...lines);
}

function dot(at, kind, title, options) {
  const icon = L.divIcon({ className: `dot ${kind}`, iconSize: [18, 18] });
  return L.marker(at, { icon, title, keyboard: false, ...options }).addTo(dots);
}

function drawDots() {
  dots.clearLayers();
  for (const photo of state.photos) {
    const mine = photo.image === chosen;
    if (placed(photo)) {
      dot(toLatLng(photo.x, photo.y), mine ? "chosen" : "", photo.image, { draggable: true, zIndexOffset: mine ? 1000 : 0 })
        .on("click", () => choose(photo.image))
        .on("dragend", (event) => {
          const { x, y } = toPixel(event.target.getLatLng());
          place(photo.image, x, y);
        });
    } else if (mine && photo.guess) {
      dot(toLatLng(...photo.guess), "guess", "GPS position of its EXIF", {}).on("click", () => place(photo.image, ...photo.guess));
    }
  }
}

function drawPreview() {
  const photo = chosen && photoOf(chosen);
  $("preview").hidden = !photo;
  if (!photo) return;
  const picture = $("preview").querySelector("img");
  if (picture.dataset.image !== chosen) picture.src = imageUrl(chosen, false);
  picture.dataset.image = chosen;
  $("preview").querySelector("figcaption").textContent = chosen;
}

function hint() {
  if (!state.photos.length && !state.overview) return "Add an overview image and photos: drop them here.";
  if (!state.overview) return "Click the overview image in the list.";
  const photo = chosen && photoOf(chosen);
  if (!photo) return next(null) ? "Click a photo in the list." : "All photos are placed. Drag a dot to correct it.";
  if (placed(photo)) return "Drag its dot or click to move it. Delete removes it, ↑ ↓ select other photos.";
  return photo.guess ? "Enter accepts the GPS position, a click sets another one." : "Click where it was taken.";
}

function drawMap() {
  if (!state.overview || map) return;
  const bounds = [[0, 0], [state.overview.height, state.overview.width]];
  map = L.map("map", { crs: L.CRS.Simple, minZoom: -5, zoomSnap: 0.25, attributionControl: false, keyboard: false });
  L.imageOverlay(imageUrl(state.overview.image, false), bounds).addTo(map);
  map.fitBounds(bounds);
  dots.addTo(map);
  map.on("click", (event) => {
    const { x, y } = toPixel(event.latlng);
    if (chosen) place(chosen, x, y);
  });
}

function draw() {
  drawMap();
  if (chosen && !photoOf(chosen)) chosen = null;
  if (!chosen && state.overview) chosen = next(null);
  const count = state.photos.filter(placed).length;
  $("title").textContent = state.file;
  $("count").textContent = `${count} of ${state.photos.length} photos placed`;
  $("undo").disabled = !state.undo;
  $("map").classList.toggle("placing", Boolean(chosen));
  $("hint").textContent = hint();
  drawList();
  if (map) drawDots();
  drawPreview();
}

async function add(files) {
  for (const file of files) {
    const form = new FormData();
    form.append("picture", file, file.name);
    const body = await ask("/add", { method: "POST", body: form });
    if (!body) break;
    state = body;
    draw();
  }
}

const NUDGES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function key(event) {
  const photo = chosen && photoOf(chosen);
  const nudge = event.shiftKey && NUDGES[event.key];
  if ((event.ctrlKey || event.metaKey) && event.key === "z") post("/undo", {});
  else if (nudge && photo && placed(photo)) place(chosen, photo.x + nudge[0], photo.y + nudge[1]);
  else if (event.key === "ArrowDown") step(1);
  else if (event.key === "ArrowUp") step(-1);
  else if (event.key === "Enter" && photo && !placed(photo) && photo.guess) place(chosen, ...photo.guess);
  else if (event.key === "Delete" && photo && placed(photo)) post("/remove", { image: chosen });
  else return;
  event.preventDefault();
}

document.addEventListener("keydown", key);
document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
  event.preventDefault();
  add(event.dataTransfer.files);
});
$("files").addEventListener("change", (event) => add(event.target.files));
$("undo").addEventListener("click", () => post("/undo", {}));
ask("/state").then((body) => {
  if (!body) return;
  state = body;
  draw();
});
