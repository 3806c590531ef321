// Measuring: straight lines between clicks, their length on the map, direction and difference in height.
const measure = { on: false, cells: [] };

function toggle_measure() {
  measure.on = !measure.on;
  measure.cells = [];
  if (measure.on) route.drawing = false;
  $('measure').setAttribute('aria-pressed', measure.on);
  show_measure();
}

function add_measured(cell) {
  measure.cells.push(cell);
  show_measure();
}

/// {length [m], heading [deg clockwise from grid north], rise [m]} of the last line; length of all.
function measured() {
  let total = 0, last = null;
  for (let i = 1; i < measure.cells.length; ++i) {
    const [x, y] = centre_of(measure.cells[i - 1]), [u, v] = centre_of(measure.cells[i]), length = Math.hypot(u - x, v - y);
    total += length;
    last = { length, heading: (Math.atan2(u - x, y - v) / DEGREE + 360) % 360, rise: height_of(measure.cells[i]) - height_of(measure.cells[i - 1]) };
  }
  return { total, last };
}

const length_text = (m) => (m >= 1000 ? `${(m / 1000).toFixed(2)} km` : `${m.toFixed(0)} m`);

function show_measure() {
  const box = $('measured'), { total, last } = measured();
  box.hidden = !measure.on;
  box.textContent = !last ? 'Click places on the map.' : `${length_text(total)} in all; the last line ${length_text(last.length)} towards ${last.heading.toFixed(0)}° ${compass(last.heading)}${Number.isNaN(last.rise) ? '' : `, ${last.rise < 0 ? 'falls' : 'rises'} ${Math.abs(last.rise).toFixed(0)} m`}. Lengths are on the map, without slopes.`;
  view.dirty = true;
}

function draw_measure() {
  if (measure.cells.length === 0) return;
  stroke_path(measure.cells, 'rgb(255 255 255 / .95)', 6);
  stroke_path(measure.cells, '#1a1a1a', 2.5);
  for (const cell of measure.cells) mark_cell(cell, '#1a1a1a', 4);
}
