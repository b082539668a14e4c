"use strict";
// What charts and maps share: data, canvas, ticks, dragging and zooming. Texts from logs are only ever drawn or set as text.
const data = JSON.parse(document.getElementById("data").textContent);
const canvas = document.getElementById("canvas");
const context = canvas.getContext("2d");
const tip = document.getElementById("tip");
const legend = document.getElementById("legend");

function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  return Float64Array.from({ length: bytes.length / 8 }, (_, n) => view.getFloat64(8 * n, true));
}

// A step of 1, 2 or 5 times a power of ten that divides a span into at most `most` pieces.
function niceStep(span, most) {
  const raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((one) => one * power >= raw * 0.999999);
}

function ticks(low, high, step) {
  const found = [];
  for (let n = Math.ceil(low / step); n * step <= high && found.length < 200; n++) found.push(n * step);
  return found;
}

function decimals(step) {
  return Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9)));
}

function numberText(value, step) {
  const large = Math.abs(value) >= 1e7 || (step < 1e-6 && value !== 0);
  return large ? value.toExponential(Math.max(0, Math.min(8, Math.floor(Math.log10(Math.abs(value) / step) + 1e-9))))
    : value.toFixed(decimals(step));
}

// Seconds since 1970 in UTC, or a plain number of seconds.
function timeText(seconds, step, absolute, withDate) {
  if (!absolute) return seconds.toFixed(decimals(step));
  const text = new Date(Math.round(seconds * 1000)).toISOString(); // 2024-01-31T12:00:00.000Z
  const clock = step < 1 ? text.slice(11, 23) : step < 60 ? text.slice(11, 19) : text.slice(11, 16);
  return step >= 86400 ? text.slice(0, 10) : withDate ? text.slice(0, 10) + " " + clock : clock;
}

function timeStep(span, most, absolute) {
  if (!absolute || span / most < 1) return niceStep(span, most);
  const steps = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400];
  return steps.find((one) => span / one <= most) || niceStep(span / 86400, most) * 86400;
}

// Index of the first element that is not below `value` in a sorted array.
function lowerBound(array, value) {
  let low = 0, high = array.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (array[middle] < value) low = middle + 1; else high = middle;
  }
  return low;
}

function legendButton(label, colour, area, toggle) {
  const button = document.createElement("button"), mark = document.createElement("i");
  mark.style.background = colour;
  if (area) mark.className = "area";
  button.append(mark, document.createTextNode(label));
  button.onclick = () => { button.classList.toggle("off"); toggle(); draw(); };
  legend.append(button);
}

// Canvas pixels are those of the screen; `resized` tells the drawing its size in CSS pixels.
function fit(resized) {
  const box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
  canvas.width = Math.max(1, Math.round(box.width * ratio));
  canvas.height = Math.max(1, Math.round(box.height * ratio));
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  resized(box.width, box.height);
}

// Dragging, wheel, hover and double click, in CSS pixels.
function interact({ move, zoom, hover, leave, reset }) {
  let last = null;
  canvas.onpointerdown = (event) => { last = event; canvas.setPointerCapture(event.pointerId); };
  canvas.onpointerup = canvas.onpointercancel = () => { last = null; };
  canvas.onpointermove = (event) => {
    if (last) { move(event.offsetX - last.offsetX, event.offsetY - last.offsetY); last = event; leave(); return; }
    hover(event.offsetX, event.offsetY);
  };
  canvas.onpointerleave = leave;
  canvas.ondblclick = reset;
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const amount = event.deltaY || event.deltaX;
    zoom(event.offsetX, event.offsetY, Math.exp(Math.max(-1, Math.min(1, amount / 300))), event.shiftKey);
  }, { passive: false });
}

function showTip(x, y, text, width) {
  tip.textContent = text;
  tip.style.display = "block";
  const left = x + 16 + tip.offsetWidth > width ? x - tip.offsetWidth - 12 : x + 16;
  tip.style.left = Math.max(0, left) + "px";
  tip.style.top = Math.max(0, y - 12) + "px";
}
