// Where a vehicle was, on a grid of latitude and longitude: no tiles, nothing is loaded.
const track = { t: unpacked(data.t), lat: unpacked(data.lat), lon: unpacked(data.lon), alt: unpacked(data.alt) };
const METRES = 111194.93; // of a degree of latitude
let width = 0, height = 0, centre = null, scale = 1, cursor = null; // scale: CSS pixels of a degree of latitude
const hidden = new Set();
let showMission = true;

function bounds() {
  let south = Infinity, north = -Infinity, west = Infinity, east = -Infinity;
  const take = (lat, lon) => {
    south = Math.min(south, lat); north = Math.max(north, lat); west = Math.min(west, lon); east = Math.max(east, lon);
  };
  for (let n = 0; n < track.lat.length; n++) take(track.lat[n], track.lon[n]);
  for (const place of data.waypoints) take(place.lat, place.lon);
  if (data.home) take(data.home.lat, data.home.lon);
  return { south, north, west, east };
}

const box = bounds();
const narrow = Math.max(0.01, Math.cos((box.south + box.north) / 2 * Math.PI / 180)); // a degree of longitude beside one of latitude

function reset() {
  centre = { lat: (box.south + box.north) / 2, lon: (box.west + box.east) / 2 };
  const high = Math.max(box.north - box.south, 2e-4), wide = Math.max((box.east - box.west) * narrow, 2e-4);
  scale = Math.min((height - 80) / high, (width - 120) / wide);
  scale = Math.max(scale, 1);
}

const toX = (lon) => width / 2 + (lon - centre.lon) * narrow * scale;
const toY = (lat) => height / 2 - (lat - centre.lat) * scale;
const toLon = (x) => centre.lon + (x - width / 2) / scale / narrow;
const toLat = (y) => centre.lat - (y - height / 2) / scale;

function drawGrid() {
  context.strokeStyle = "#e2e2e2"; context.fillStyle = "#777"; context.lineWidth = 1;
  context.font = "11px system-ui, sans-serif";
  const step = niceStep(height / scale, Math.max(2, height / 110)), lonStep = niceStep(width / scale / narrow, Math.max(2, width / 150));
  context.textAlign = "left"; context.textBaseline = "bottom";
  for (const lat of ticks(Math.max(-90, toLat(height)), Math.min(90, toLat(0)), step)) {
    context.beginPath(); context.moveTo(0, toY(lat)); context.lineTo(width, toY(lat)); context.stroke();
    context.fillText(lat.toFixed(decimals(step)) + "°", 4, toY(lat) - 2);
  }
  context.textBaseline = "bottom";
  for (const lon of ticks(toLon(0), toLon(width), lonStep)) {
    context.beginPath(); context.moveTo(toX(lon), 0); context.lineTo(toX(lon), height); context.stroke();
    const shown = ((lon + 180) % 360 + 360) % 360 - 180;
    context.fillText(shown.toFixed(decimals(lonStep)) + "°", toX(lon) + 3, height - 3);
  }
}

function drawScaleBar() {
  const metres = niceStep(160 / scale * METRES, 1), pixels = metres / METRES * scale;
  const text = metres >= 1000 ? metres / 1000 + " km" : metres >= 1 ? metres + " m" : metres * 100 + " cm";
  const x = width - 24 - pixels, y = height - 30;
  context.fillStyle = "#ffffffd0";
  context.fillRect(x - 8, y - 22, pixels + 16, 32);
  context.strokeStyle = context.fillStyle = "#222"; context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x, y - 5); context.lineTo(x, y); context.lineTo(x + pixels, y); context.lineTo(x + pixels, y - 5);
  context.stroke();
  context.textAlign = "center"; context.textBaseline = "bottom";
  context.fillText(text, x + pixels / 2, y - 4);
}

function drawTrack() {
  context.lineWidth = 2; context.lineJoin = "round";
  for (const { mode, colour, first, end } of data.stretches) {
    if (hidden.has(mode)) continue;
    context.strokeStyle = colour;
    context.beginPath();
    for (let n = first; n < Math.min(end + 1, track.lat.length); n++) context.lineTo(toX(track.lon[n]), toY(track.lat[n]));
    context.stroke();
  }
  const last = track.lat.length - 1;
  const away = leftwards(toX(track.lon[last]) - toX(track.lon[0]), toY(track.lat[last]) - toY(track.lat[0]));
  dot(track.lon[0], track.lat[0], "#2a2", "start", away.start);
  dot(track.lon[last], track.lat[last], "#c22", "end", away.end);
}

// Where the end is so far from the start in pixels, which of their names stand to the left: close by, they go apart.
function leftwards(right, down) {
  const close = Math.abs(right) < 60 && Math.abs(down) < 16;
  return { start: close && right >= 0, end: close && right < 0 };
}

function dot(lon, lat, colour, name, toLeft) {
  const x = toX(lon), y = toY(lat);
  context.fillStyle = colour; context.strokeStyle = "#fff"; context.lineWidth = 1.5;
  context.beginPath(); context.arc(x, y, 5, 0, 7); context.fill(); context.stroke();
  context.font = "12px system-ui, sans-serif"; context.textAlign = toLeft ? "right" : "left"; context.textBaseline = "middle";
  const at = toLeft ? x - 8 : x + 8;
  context.lineWidth = 3; context.strokeText(name, at, y);
  context.fillStyle = "#222"; context.fillText(name, at, y);
}

function drawMission() {
  if (!showMission) return;
  context.strokeStyle = "#0008"; context.lineWidth = 1; context.setLineDash([5, 4]);
  context.beginPath();
  for (const { lat, lon } of data.waypoints) context.lineTo(toX(lon), toY(lat));
  context.stroke(); context.setLineDash([]);
  for (const { name, lat, lon } of data.waypoints) dot(lon, lat, "#555", name);
  if (data.home) {
    const x = toX(data.home.lon), y = toY(data.home.lat);
    context.fillStyle = "#111"; context.strokeStyle = "#fff"; context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x, y - 9); context.lineTo(x + 8, y - 1); context.lineTo(x + 5, y - 1); context.lineTo(x + 5, y + 7);
    context.lineTo(x - 5, y + 7); context.lineTo(x - 5, y - 1); context.lineTo(x - 8, y - 1); context.closePath();
    context.fill(); context.stroke();
  }
}

function drawCursor() {
  if (!cursor) { tip.style.display = "none"; return; }
  let best = -1, distance = 40 * 40;
  for (let n = 0; n < track.lat.length; n++) {
    const dx = toX(track.lon[n]) - cursor.x, dy = toY(track.lat[n]) - cursor.y, now = dx * dx + dy * dy;
    if (now < distance) { distance = now; best = n; }
  }
  const lat = best < 0 ? toLat(cursor.y) : track.lat[best], lon = best < 0 ? toLon(cursor.x) : track.lon[best];
  const shown = ((lon + 180) % 360 + 360) % 360 - 180, text = [lat.toFixed(7) + "°, " + shown.toFixed(7) + "°"];
  if (best >= 0) {
    const stretch = data.stretches.find(({ first, end }) => first <= best && best < end);
    text.push(track.alt[best].toFixed(1) + " m");
    if (Math.abs(track.t[best]) < 8.64e12) text.push(timeText(track.t[best], 0.01, true, true) + " UTC");
    if (stretch && stretch.mode) text.push(stretch.mode);
    context.strokeStyle = "#222"; context.lineWidth = 2;
    context.beginPath(); context.arc(toX(track.lon[best]), toY(track.lat[best]), 6, 0, 7); context.stroke();
  }
  showTip(cursor.x, cursor.y, text.join("\n"), width);
}

function draw() {
  context.clearRect(0, 0, width, height);
  drawGrid();
  drawTrack();
  drawMission();
  drawScaleBar();
  drawCursor();
}

interact({
  move(dx, dy) { centre = { lat: centre.lat + dy / scale, lon: centre.lon - dx / scale / narrow }; draw(); },
  zoom(x, y, factor) {
    const at = { lat: toLat(y), lon: toLon(x) };
    scale = Math.max(1, Math.min(1e10, scale / factor));
    centre = { lat: at.lat + (y - height / 2) / scale, lon: at.lon - (x - width / 2) / scale / narrow };
    draw();
  },
  hover(x, y) { cursor = { x, y }; draw(); },
  leave() { cursor = null; tip.style.display = "none"; draw(); },
  reset() { reset(); draw(); },
});

const modes = new Map(data.stretches.map(({ mode, colour }) => [mode, colour]));
for (const [mode, colour] of modes) {
  legendButton(mode || "track", colour, false, () => { hidden.has(mode) ? hidden.delete(mode) : hidden.add(mode); });
}
if (data.waypoints.length || data.home) legendButton("home and mission", "#555", true, () => { showMission = !showMission; });
window.onresize = () => fit((w, h) => { width = w; height = h; if (!centre) reset(); draw(); });
window.onresize();
