// Connects the controls to the view.
let painting = 0, counting = false;
/// What was asked for since the last frame is done together: a later call without counts must not lose those of an
/// earlier one.
function refresh(counts = true) {
  cancelAnimationFrame(painting);
  counting = counting || counts;
  painting = requestAnimationFrame(() => {
    paint_layer();
    show_legend();
    show_heading();
    show_thresholds();
    if (counting) show_shares();
    counting = false;
    show_cell();
    show_readout(view.read);
    remember();
  });
}

function show_tab(name) {
  for (const tab of ['layers', 'cell', 'route']) {
    $(`tab-${tab}`).setAttribute('aria-selected', tab === name);
    $(`tab-${tab}`).tabIndex = tab === name ? 0 : -1;
    $(`pane-${tab}`).hidden = tab !== name;
  }
}

function set_heading(degrees) {
  state.heading = Math.round((degrees % 360 + 360) % 360);
  state.mode = 'set';
  refresh();
}

function set_thresholds(go, no_go, moved) {
  if (moved === 'go') no_go = Math.min(no_go, go); else go = Math.max(go, no_go);
  state.go = go;
  state.no_go = no_go;
  for (const soil of soils) soil.update();
  refresh();
  if (route.end !== null || route.reach) update_route();
}

function choose(cell) {
  if (cell < 0) return;
  if (measure.on) { add_measured(cell); return; }
  if (route.drawing) { place_route_point(cell); return; }
  view.chosen = cell;
  show_cell();
  if (view.pointed) show_served_cell(view.pointed);
  show_tab('cell');
  view.dirty = true;
  remember();
}

function place_route_point(cell) {
  if (route.start === null || route.end !== null) { route.start = cell; route.end = route.path = null; $('route-hint').textContent = 'Now the end.'; $('route').replaceChildren(); }
  else { route.end = cell; route.drawing = false; $('route-hint').textContent = 'Draw again, or choose another cost.'; }
  update_route();
}

function update_route() {
  if (route.start !== null && route.end !== null) show_route(find_route());
  route.reach = route.reaching && route.start !== null ? dijkstra(route.start, -1, route.cost).cost : null;
  make_bands();
  $('route-reach').setAttribute('aria-pressed', route.reaching);
  refresh(false);
}

function draw_route() {
  show_tab('route');
  route.drawing = true;
  route.start = route.end = route.path = route.reach = null;
  make_bands();
  if (measure.on) toggle_measure();
  $('route').replaceChildren();
  $('route-hint').textContent = 'Click the start on the map (or press Enter at the crosshair).';
  refresh(false);
}

function listen_to_keys() {
  canvas.addEventListener('keydown', (e) => {
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
    if (move) {
      const cross = view.cross ?? cell_at(canvas.clientWidth / 2, canvas.clientHeight / 2), far = e.shiftKey ? 20 : Math.max(1, Math.round(8 / (view.scale * cell_w)));
      const column = Math.min(cells.columns - 1, Math.max(0, Math.max(cross, 0) % cells.columns + far * move[0]));
      const row = Math.min(cells.rows - 1, Math.max(0, Math.floor(Math.max(cross, 0) / cells.columns) + far * move[1]));
      view.cross = row * cells.columns + column;
      show_readout(view.cross);
    } else if (e.key === 'Enter' || e.key === ' ') choose(view.cross ?? cell_at(canvas.clientWidth / 2, canvas.clientHeight / 2));
    else if (e.key === '+' || e.key === '=') zoom_at(canvas.clientWidth / 2, canvas.clientHeight / 2, 1.4);
    else if (e.key === '-') zoom_at(canvas.clientWidth / 2, canvas.clientHeight / 2, 1 / 1.4);
    else if (e.key === '0') fit();
    else if (e.key === 'r' || e.key === 'R') draw_route();
    else if (e.key === 'm' || e.key === 'M') toggle_measure();
    else if (e.key === '[') set_heading(state.heading - 5);
    else if (e.key === ']') set_heading(state.heading + 5);
    else if (layers[Number(e.key) - 1]) { state.layer = layers[Number(e.key) - 1].id; show_layers(); refresh(); }
    else return;
    e.preventDefault();
    view.dirty = true;
  });
  $('dial').addEventListener('keydown', (e) => {
    const turn = { ArrowLeft: -5, ArrowDown: -5, ArrowRight: 5, ArrowUp: 5, PageUp: 45, PageDown: -45 }[e.key];
    if (turn) { set_heading(state.heading + turn); e.preventDefault(); }
  });
  document.querySelector('.tabs').addEventListener('keydown', (e) => {
    const tabs = ['layers', 'cell', 'route'], at = tabs.findIndex((t) => $(`tab-${t}`) === document.activeElement);
    const next = { ArrowRight: at + 1, ArrowLeft: at + 2 }[e.key];
    if (next !== undefined) { show_tab(tabs[next % 3]); $(`tab-${tabs[next % 3]}`).focus(); }
  });
}

function listen_to_controls() {
  for (const tab of ['layers', 'cell', 'route']) $(`tab-${tab}`).addEventListener('click', () => show_tab(tab));
  for (const input of document.getElementsByName('mode')) input.addEventListener('change', () => { state.mode = input.value; refresh(); });
  $('opacity').addEventListener('input', (e) => { state.opacity = e.target.value / 100; $('opacity-value').textContent = `${e.target.value} %`; refresh(false); });
  $('go').addEventListener('input', (e) => set_thresholds(e.target.value / 100, state.no_go, 'go'));
  $('no-go').addEventListener('input', (e) => set_thresholds(state.go, e.target.value / 100, 'no_go'));
  $('reset').addEventListener('click', () => set_thresholds(meta.rules.go, meta.rules.no_go, 'go'));
  $('palette').addEventListener('click', () => { state.safe_colours = !state.safe_colours; set_palette(); });
  $('theme').addEventListener('click', () => set_theme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'));
  $('about').addEventListener('click', () => { show_about(); $('about-box').showModal(); });
  $('zoom-in').addEventListener('click', () => zoom_at(canvas.clientWidth / 2, canvas.clientHeight / 2, 1.6));
  $('zoom-out').addEventListener('click', () => zoom_at(canvas.clientWidth / 2, canvas.clientHeight / 2, 1 / 1.6));
  $('zoom-fit').addEventListener('click', fit);
  $('measure').addEventListener('click', toggle_measure);
  $('terms').addEventListener('change', (e) => { state.terms = e.target.value; show_layers(); refresh(); });
  window.addEventListener('hashchange', () => { if (location.hash.slice(1) !== linked) { follow_link(); show_state(); } });
  $('route-draw').addEventListener('click', draw_route);
  $('route-reach').addEventListener('click', () => { route.reaching = !route.reaching; if (route.start === null) $('route-hint').textContent = 'Draw a start first.'; update_route(); });
  $('route-clear').addEventListener('click', () => { Object.assign(route, { start: null, end: null, path: null, reach: null, drawing: false, reaching: false }); $('route').replaceChildren(); update_route(); });
  window.addEventListener('beforeprint', show_print_note);
  const dial = $('dial');
  const turn = (e) => { const box = dial.getBoundingClientRect(); set_heading(Math.atan2(e.clientX - box.x - box.width / 2, -(e.clientY - box.y - box.height / 2)) / DEGREE); };
  dial.addEventListener('pointerdown', (e) => { dial.setPointerCapture(e.pointerId); turn(e); });
  dial.addEventListener('pointermove', (e) => { if (dial.hasPointerCapture(e.pointerId)) turn(e); });
}

function set_palette() {
  $('palette').setAttribute('aria-pressed', state.safe_colours);
  for (const v of meta.verdicts) document.documentElement.style.setProperty(`--v${v.code}`, css(verdict_colour(v.code)));
  show_layers();
  refresh();
}

function set_theme(theme) {
  document.documentElement.dataset.theme = theme;
  $('theme').textContent = theme === 'dark' ? 'Light' : 'Dark';
  view.dirty = true;
}

function draw_ticks() {
  for (let a = 0; a < 360; a += 15) $('ticks').append(shape('line', { x1: 0, y1: -50, x2: 0, y2: a % 90 ? -46 : -42, transform: `rotate(${a})` }));
  for (const [name, x, y] of [['N', 0, -29], ['E', 34, 4], ['S', 0, 38], ['W', -34, 4]]) { const t = shape('text', { x, y, 'text-anchor': 'middle' }); t.textContent = name; $('ticks').append(t); }
}

function make_costs() {
  const usable = usable_costs();
  route.cost = usable[0][0];
  for (const [id, label] of usable) {
    const input = element('input', { type: 'radio', name: 'cost', value: id, checked: id === route.cost });
    input.addEventListener('change', () => { route.cost = id; update_route(); });
    $('costs').append(element('label', {}, input, element('span', {}, label)));
  }
}

/// Brings controls and picture in line with the state that an address gave.
function show_state() {
  $('opacity').value = Math.round(100 * state.opacity);
  $('opacity-value').textContent = `${$('opacity').value} %`;
  $('terms').value = state.terms;
  for (const input of document.getElementsByName('cost')) input.checked = input.value === route.cost;
  set_palette();
  if (route.start !== null) update_route();
  if (view.chosen !== null) show_tab('cell');
}

async function start() {
  $('title').textContent = document.title = meta.title;
  $('subtitle').textContent = meta.subtitle;
  set_theme(matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
  try {
    await read_blobs();
  } catch (error) {
    $('wait').textContent = `This browser cannot unpack the map (${error.message}); use one of 2023 or later.`;
    return;
  }
  make_places();
  soils = meta.soils.map((info, index) => new Soil(info, index));
  layers = make_layers();
  make_relief();
  make_costs();
  draw_ticks();
  follow_link();
  set_palette();
  listen_to_controls();
  listen_to_keys();
  listen_to_pointers(choose, (cell) => show_readout(cell));
  new ResizeObserver(() => { resize(); }).observe(canvas);
  resize();
  fit();
  follow_link();
  show_state();
  show_readout(-1);
  frame();
  $('wait').hidden = true;
  $('app').setAttribute('aria-busy', 'false');
}
start();
