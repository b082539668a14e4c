// Values over time, with an axis on the left and one on the right, and flight modes behind them.
const lines = data.lines.map((line) => ({ ...line, x: unpacked(line.x), y: unpacked(line.y), shown: true }));
const sides = { left: lines.filter((line) => !line.right), right: lines.filter((line) => line.right) };
const pad = { left: 66, right: sides.right.length ? 66 : 16, top: 20, bottom: 40 };
let width = 0, height = 0, span = null, scale = { left: null, right: null }, cursor = null;
const hidden = new Set();

function everything() {
  let low = Infinity, high = -Infinity;
  for (const { x } of lines) for (const one of x) { low = Math.min(low, one); high = Math.max(high, one); }
  if (!(high > low)) { low -= 1; high += 1; }
  return [low, high];
}

const whole = everything();
span = [...whole];
// Times may go back where a clock was set; then all points are looked at.
for (const line of lines) line.sorted = line.x.every((one, n) => n === 0 || one >= line.x[n - 1]);

function visible(line) {
  if (!line.sorted) return [0, line.x.length];
  return [Math.max(0, lowerBound(line.x, span[0]) - 1), Math.min(line.x.length, lowerBound(line.x, span[1]) + 1)];
}

function valueSpan(side) {
  if (scale[side]) return scale[side];
  let low = Infinity, high = -Infinity;
  for (const line of sides[side]) {
    if (!line.shown) continue;
    const [first, end] = visible(line);
    for (let n = first; n < end; n++) { low = Math.min(low, line.y[n]); high = Math.max(high, line.y[n]); }
  }
  if (!(high >= low)) return [0, 1];
  const room = (high - low) * 0.06 || Math.abs(high) * 0.05 || 1;
  return [low - room, high + room];
}

const toX = (time) => pad.left + (time - span[0]) / (span[1] - span[0]) * (width - pad.left - pad.right);
const toTime = (x) => span[0] + (x - pad.left) / (width - pad.left - pad.right) * (span[1] - span[0]);
const toY = (value, [low, high]) => height - pad.bottom - (value - low) / (high - low) * (height - pad.top - pad.bottom);

function drawModes() {
  context.textAlign = "left"; context.textBaseline = "top"; context.font = "11px system-ui, sans-serif";
  for (const { mode, start, end, colour } of data.modes) {
    if (hidden.has(mode)) continue;
    const left = Math.max(pad.left, toX(start)), right = Math.min(width - pad.right, toX(end));
    if (right <= left) continue;
    context.fillStyle = colour + "22";
    context.fillRect(left, pad.top, right - left, height - pad.top - pad.bottom);
    context.fillStyle = colour;
    if (context.measureText(mode).width + 6 < right - left) context.fillText(mode, left + 3, pad.top - 14);
  }
}

function drawAxes(spans) {
  context.strokeStyle = "#ddd"; context.fillStyle = "#444"; context.lineWidth = 1;
  const bottom = height - pad.bottom, step = timeStep(span[1] - span[0], Math.max(2, width / 110), data.absolute);
  context.textAlign = "center"; context.textBaseline = "top";
  const zero = data.absolute ? data.zero : 0;
  const line = (x1, y1, x2, y2) => { context.beginPath(); context.moveTo(x1, y1); context.lineTo(x2, y2); context.stroke(); };
  for (const tick of ticks(span[0] + zero, span[1] + zero, step)) {
    const x = toX(tick - zero);
    line(x, pad.top, x, bottom);
    context.fillText(timeText(tick, step, data.absolute, false), x, bottom + 5);
  }
  const from = timeText(span[0] + zero, 60, data.absolute, true);
  context.fillText(data.absolute ? from + " UTC and on" : data.across, pad.left + (width - pad.left - pad.right) / 2, bottom + 22);
  context.textBaseline = "middle";
  for (const side of ["left", "right"]) {
    if (!sides[side].length) continue;
    const [low, high] = spans[side], valueStep = niceStep(high - low, Math.max(2, height / 60));
    context.textAlign = side === "left" ? "right" : "left";
    const x = side === "left" ? pad.left - 6 : width - pad.right + 6;
    for (const tick of ticks(low, high, valueStep)) {
      const y = toY(tick, spans[side]);
      if (side === "left" || !sides.left.length) line(pad.left, y, width - pad.right, y);
      context.fillText(numberText(tick, valueStep), x, y);
    }
  }
  context.strokeStyle = "#999";
  context.strokeRect(pad.left, pad.top, width - pad.left - pad.right, bottom - pad.top);
}

// Where there are many points for a pixel, its smallest and largest stand for all.
function drawLine(line, valueSpan) {
  const [first, end] = visible(line);
  context.strokeStyle = line.colour; context.lineWidth = 1.4;
  context.setLineDash(line.right ? [6, 3] : []);
  context.beginPath();
  if (!line.sorted || end - first < 4 * width) {
    for (let n = first; n < end; n++) context.lineTo(toX(line.x[n]), toY(line.y[n], valueSpan));
    if (end - first === 1) context.rect(toX(line.x[first]) - 1, toY(line.y[first], valueSpan) - 1, 3, 3);
  } else {
    for (let n = first; n < end;) {
      const pixel = Math.floor(toX(line.x[n]));
      let low = line.y[n], high = low, last = low;
      for (; n < end && Math.floor(toX(line.x[n])) === pixel; n++) {
        last = line.y[n]; low = Math.min(low, last); high = Math.max(high, last);
      }
      for (const value of [low, high, last]) context.lineTo(pixel + 0.5, toY(value, valueSpan));
    }
  }
  context.stroke();
  context.setLineDash([]);
}

function nearest(line, time) {
  if (line.sorted) {
    const n = lowerBound(line.x, time);
    return n > 0 && (n === line.x.length || time - line.x[n - 1] < line.x[n] - time) ? n - 1 : n;
  }
  let best = 0;
  for (let n = 1; n < line.x.length; n++) if (Math.abs(line.x[n] - time) < Math.abs(line.x[best] - time)) best = n;
  return best;
}

function drawCursor(spans) {
  if (!cursor || cursor.x < pad.left || cursor.x > width - pad.right) { tip.style.display = "none"; return; }
  const time = toTime(cursor.x), zero = data.absolute ? data.zero : 0;
  context.strokeStyle = "#8888";
  context.beginPath(); context.moveTo(cursor.x, pad.top); context.lineTo(cursor.x, height - pad.bottom); context.stroke();
  const text = [data.absolute ? timeText(time + zero, 0.001, true, true) : Number(time.toPrecision(9)) + " " + data.across];
  const mode = data.modes.find(({ start, end }) => start <= time && time < end);
  if (mode) text.push(mode.mode);
  for (const line of lines) {
    if (!line.shown || !line.x.length) continue;
    const n = nearest(line, time);
    text.push(line.label + " = " + Number(line.y[n].toPrecision(9)));
    context.fillStyle = line.colour;
    context.beginPath();
    context.arc(toX(line.x[n]), toY(line.y[n], spans[line.right ? "right" : "left"]), 3.5, 0, 7);
    context.fill();
  }
  showTip(cursor.x, cursor.y, text.join("\n"), width);
}

function draw() {
  context.clearRect(0, 0, width, height);
  const spans = { left: valueSpan("left"), right: valueSpan("right") };
  drawModes();
  drawAxes(spans);
  context.save();
  context.beginPath();
  context.rect(pad.left, pad.top, width - pad.left - pad.right, height - pad.top - pad.bottom);
  context.clip();
  for (const line of lines) if (line.shown) drawLine(line, spans[line.right ? "right" : "left"]);
  drawCursor(spans);
  context.restore();
}

function zoomed([low, high], at, factor) { return [at + (low - at) * factor, at + (high - at) * factor]; }

interact({
  move(dx) {
    const by = dx / (width - pad.left - pad.right) * (span[1] - span[0]);
    span = span.map((one) => one - by);
    draw();
  },
  zoom(x, y, factor, values) {
    if (values) {
      for (const side of ["left", "right"]) {
        const now = valueSpan(side), share = (height - pad.bottom - y) / (height - pad.top - pad.bottom);
        scale[side] = zoomed(now, now[0] + share * (now[1] - now[0]), factor);
      }
    } else {
      const next = zoomed(span, toTime(x), factor);
      if (next[1] - next[0] > 1e-5 && next[1] - next[0] < 20 * (whole[1] - whole[0])) span = next;
    }
    draw();
  },
  hover(x, y) { cursor = { x, y }; draw(); },
  leave() { cursor = null; tip.style.display = "none"; draw(); },
  reset() { span = [...whole]; scale = { left: null, right: null }; draw(); },
});

for (const line of lines) {
  legendButton(line.label + (line.right ? " (right)" : ""), line.colour, false, () => { line.shown = !line.shown; });
}
for (const [mode, colour] of new Map(data.modes.map(({ mode, colour }) => [mode, colour]))) {
  legendButton(mode, colour + "66", true, () => { hidden.has(mode) ? hidden.delete(mode) : hidden.add(mode); });
}
window.onresize = () => fit((w, h) => { width = w; height = h; draw(); });
window.onresize();
