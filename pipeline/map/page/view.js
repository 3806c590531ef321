// The canvas: the layer as one picture, drawn at any zoom in metres; crosshair, chosen cell and routes on top.
const canvas = $('canvas'), context = canvas.getContext('2d');
const picture = document.createElement('canvas');
const view = { scale: 1, x: 0, y: 0, cross: null, chosen: null, pointed: null, read: -1, dirty: true };  // scale [px/m]; x, y [m] at the middle
const map_w = () => cells.columns * cell_w, map_h = () => cells.rows * cell_h;

/// Relief from slope and aspect, the light in the north-west at 45 degrees (terrain/raster/slope.h).
let relief = null;
function make_relief() {
  relief = new Float32Array(blob.slope.length);
  for (let c = 0; c < relief.length; ++c) {
    if (blob.soil[c] === NO_DATA) { relief[c] = NaN; continue; }
    const s = slope_of(c) * DEGREE;
    relief[c] = Math.max(0, Math.cos(s) * Math.SQRT1_2 + Math.sin(s) * Math.SQRT1_2 * Math.cos((blob.aspect[c] - 315) * DEGREE));
  }
}

function paint_layer() {
  const layer = layer_of(state.layer), image = new ImageData(cells.columns, cells.rows), out = image.data;
  const strength = state.opacity, reach = route.reach;
  // Relief is milder under classes, whose colours must be found again in the legend. Flat ground keeps its colour.
  const depth = layer.entries ? 0.5 : 0.82, flat = 1 - depth * Math.SQRT1_2;
  for (let c = 0; c < relief.length; ++c) {
    if (Number.isNaN(relief[c])) continue;
    const answer = answer_of(c), rgb = layer.colour(c, answer), k = 4 * c;
    const light = flat + depth * relief[c], shine = Math.min(0.3, Math.max(0, light - 1)), grey = 255 * Math.min(1, 0.12 + 1.12 * relief[c]);
    const fade = reach && !Number.isFinite(reach[c]) ? 0.25 * strength : strength;
    if (bands.lines && bands.lines[c]) { out[k] = 91; out[k + 1] = 11; out[k + 2] = 67; out[k + 3] = 255; continue; }
    for (let i = 0; i < 3; ++i) out[k + i] = grey * (1 - fade) + (rgb[i] * Math.min(1, light) + (255 - rgb[i]) * shine) * fade;
    out[k + 3] = 255;
  }
  picture.width = cells.columns;
  picture.height = cells.rows;
  picture.getContext('2d').putImageData(image, 0, 0);
  view.dirty = true;
}

const to_screen = (x, y) => [(x - view.x) * view.scale + canvas.clientWidth / 2, (y - view.y) * view.scale + canvas.clientHeight / 2];
const to_map = (px, py) => [(px - canvas.clientWidth / 2) / view.scale + view.x, (py - canvas.clientHeight / 2) / view.scale + view.y];
const centre_of = (cell) => [(cell % cells.columns + 0.5) * cell_w, (Math.floor(cell / cells.columns) + 0.5) * cell_h];

function cell_at(px, py) {
  const [x, y] = to_map(px, py), column = Math.floor(x / cell_w), row = Math.floor(y / cell_h);
  return column < 0 || row < 0 || column >= cells.columns || row >= cells.rows ? -1 : row * cells.columns + column;
}

function fit() {
  view.scale = 0.96 * Math.min(canvas.clientWidth / map_w(), canvas.clientHeight / map_h());
  view.x = map_w() / 2;
  view.y = map_h() / 2;
  view.dirty = true;
}

function zoom_at(px, py, factor) {
  const [x, y] = to_map(px, py), smallest = 0.4 * Math.min(canvas.clientWidth / map_w(), canvas.clientHeight / map_h());
  view.scale = Math.min(60 / Math.min(cell_w, cell_h), Math.max(smallest, view.scale * factor));
  const [nx, ny] = to_map(px, py);
  view.x += x - nx;
  view.y += y - ny;
  view.dirty = true;
}

function resize() {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  view.dirty = true;
}

function stroke_path(path, colour, width) {
  context.beginPath();
  path.forEach((cell, i) => { const [x, y] = to_screen(...centre_of(cell)); if (i) context.lineTo(x, y); else context.moveTo(x, y); });
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.lineJoin = context.lineCap = 'round';
  context.stroke();
}

function pin(cell, text, colour) {
  const [x, y] = to_screen(...centre_of(cell));
  context.beginPath();
  context.arc(x, y, 9, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = '#fff';
  context.stroke();
  context.fillStyle = '#fff';
  context.font = '700 11px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillText(text, x, y + 0.5);
}

function mark_cell(cell, colour, size) {
  const [x, y] = to_screen(...centre_of(cell)), half = Math.max(size, cell_w * view.scale / 2 + 1), tall = Math.max(size, cell_h * view.scale / 2 + 1);
  for (const [ink, width] of [['#fff', 4], [colour, 2]]) {
    context.strokeStyle = ink;
    context.lineWidth = width;
    context.strokeRect(x - half, y - tall, 2 * half, 2 * tall);
  }
}

function draw() {
  const ratio = window.devicePixelRatio || 1, style = getComputedStyle(document.documentElement);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  const [x, y] = to_screen(0, 0);
  context.imageSmoothingEnabled = view.scale * Math.min(cell_w, cell_h) < 1.5;
  context.imageSmoothingQuality = 'high';
  context.drawImage(picture, x, y, map_w() * view.scale, map_h() * view.scale);
  draw_served();
  draw_bands();
  const magenta = style.getPropertyValue('--route').trim();
  if (route.path) { stroke_path(route.path, 'rgb(255 255 255 / .95)', 7); stroke_path(route.path, magenta, 3.5); }
  if (route.path && route.drive && route.drive.weakest) stroke_path(route.drive.weakest.cells, '#ff7f0e', 5);
  if (route.start !== null) pin(route.start, 'A', magenta);
  if (route.end !== null) pin(route.end, 'B', magenta);
  draw_measure();
  if (view.chosen !== null) mark_cell(view.chosen, '#111', 6);
  if (view.cross !== null && document.activeElement === canvas && canvas.matches(':focus-visible')) mark_cell(view.cross, magenta, 9);
  draw_scale();
}

function draw_scale() {
  const wanted = 130 / view.scale, power = 10 ** Math.floor(Math.log10(wanted));
  const length = [5, 2, 1].map((m) => m * power).find((m) => m <= wanted);
  $('scale-text').textContent = length >= 1000 ? `${length / 1000} km` : `${length} m`;
  $('scale-bar').style.width = `${length * view.scale}px`;
}

function frame() {
  if (view.dirty) { view.dirty = false; draw(); remember(); }
  requestAnimationFrame(frame);
}

/// Mouse, pen and fingers: one drags, two zoom, a short press chooses.
function listen_to_pointers(on_click, on_hover) {
  const pointers = new Map();
  let moved = 0;
  canvas.addEventListener('pointerdown', (e) => { canvas.setPointerCapture(e.pointerId); pointers.set(e.pointerId, [e.offsetX, e.offsetY]); if (pointers.size === 1) moved = 0; });
  canvas.addEventListener('pointermove', (e) => {
    const before = pointers.get(e.pointerId);
    if (e.pointerType === 'mouse' || before) on_hover(cell_at(e.offsetX, e.offsetY));
    if (!before) return;
    const dx = e.offsetX - before[0], dy = e.offsetY - before[1];
    if (pointers.size === 1) { view.x -= dx / view.scale; view.y -= dy / view.scale; view.dirty = true; }
    else {
      const other = [...pointers.entries()].find(([id]) => id !== e.pointerId)[1];
      const was = Math.hypot(before[0] - other[0], before[1] - other[1]), is = Math.hypot(e.offsetX - other[0], e.offsetY - other[1]);
      if (was > 0) zoom_at((e.offsetX + other[0]) / 2, (e.offsetY + other[1]) / 2, is / was);
    }
    moved += Math.abs(dx) + Math.abs(dy);
    pointers.set(e.pointerId, [e.offsetX, e.offsetY]);
  });
  const end = (e) => { const held = pointers.delete(e.pointerId); if (held && e.type === 'pointerup' && moved < 6 && pointers.size === 0) { view.pointed = to_map(e.offsetX, e.offsetY); on_click(cell_at(e.offsetX, e.offsetY)); } };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', end);
  canvas.addEventListener('pointerleave', () => on_hover(-1));
  canvas.addEventListener('wheel', (e) => { e.preventDefault(); zoom_at(e.offsetX, e.offsetY, Math.exp(-e.deltaY * 0.0015)); }, { passive: false });
}
