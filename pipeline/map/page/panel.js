// The panel: layers, heading, thresholds, the chosen cell, routes; and what the cursor reads.
const SVG = 'http://www.w3.org/2000/svg';
const COMPASS = ['N', 'NE', 'E', 'SE', 'S', 'SW', 'W', 'NW'];
const compass = (a) => COMPASS[Math.round(a / 45) % 8];

function element(tag, properties = {}, ...children) {
  const e = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) if (name === 'class') e.className = value; else e[name] = value;
  e.append(...children);
  return e;
}
function shape(tag, attributes, ...children) {
  const e = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) e.setAttribute(name, value);
  e.append(...children);
  return e;
}
function facts(rows) {
  const list = element('dl', { class: 'facts' });
  for (const [name, value] of rows) list.append(element('dt', {}, name), element('dd', {}, value));
  return list;
}

function mode_text() {
  return { uphill: 'uphill heading', worst: 'worst heading', best: 'best heading', set: `heading ${state.heading}° ${compass(state.heading)}` }[state.mode];
}

function swatch_of(layer) {
  const b = element('span', { class: 'swatch' });
  const colours = layer.ramp ? RAMPS[layer.ramp].map(css) : layer.entries().slice(0, 4).map((e) => css(e.rgb));
  b.style.background = layer.ramp ? `linear-gradient(135deg, ${colours.join(', ')})`
    : `linear-gradient(135deg, ${colours.map((c, i) => `${c} ${100 * i / colours.length}% ${100 * (i + 1) / colours.length}%`).join(', ')})`;
  return b;
}

function show_layers() {
  const box = $('layers');
  box.replaceChildren();
  for (const layer of layers) {
    const input = element('input', { type: 'radio', name: 'layer', value: layer.id, checked: layer.id === state.layer });
    input.addEventListener('change', () => { state.layer = layer.id; refresh(); });
    box.append(element('label', { title: layer.note }, input, swatch_of(layer), layer.label));
  }
}

/// Cells by class under the present heading and thresholds.
function count_classes() {
  const count = new Map(meta.verdicts.map((v) => [v.code, 0]));
  let total = 0;
  for (let c = 0; c < blob.slope.length; ++c) { const a = answer_of(c); if (a) { count.set(a.verdict, count.get(a.verdict) + 1); ++total; } }
  return { count, total };
}

/// A number with one decimal. It reads "< 0.1" if it would round to 0 though cells were counted.
const small = (x, count, unit) => (count > 0 && x < 0.05 ? `< 0.1${unit}` : `${x.toFixed(1)}${unit}`);

function show_shares() {
  const { count, total } = count_classes(), bar = $('shares'), km2 = cell_w * cell_h * 1e-6;
  bar.replaceChildren();
  bar.nextElementSibling?.classList.contains('share-list') && bar.nextElementSibling.remove();
  const list = element('div', { class: 'share-list' });
  for (const v of meta.verdicts) {
    const n = count.get(v.code), share = total ? n / total : 0, part = element('i'), chip = element('b');
    part.style.cssText = `width:${100 * share}%;background:${css(verdict_colour(v.code))}`;
    chip.style.background = css(verdict_colour(v.code));
    bar.append(part);
    list.append(chip, element('span', {}, verdict_label(v.code)), element('span', {}, small(100 * share, n, ' %')), element('span', { class: 'quiet' }, small(n * km2, n, ' km²')));
  }
  bar.after(list);
}

function show_heading() {
  $('needle').setAttribute('transform', `rotate(${state.heading})`);
  const dial = $('dial');
  dial.setAttribute('aria-valuenow', state.heading);
  dial.setAttribute('aria-valuetext', `${state.heading} degrees, ${compass(state.heading)}`);
  dial.classList.toggle('off', state.mode !== 'set');
  $('heading-value').textContent = state.mode === 'set' ? `${state.heading}° ${compass(state.heading)}` : { uphill: 'Uphill', worst: 'Worst of all', best: 'Best of all' }[state.mode];
  $('heading-note').textContent = {
    uphill: 'Straight up the fall line of each cell.', worst: 'Unknown where a heading is unknown and none is no-go.',
    best: 'Some heading passes.', set: `Clockwise from grid north. Turn the dial, or use the arrow keys on it.`,
  }[state.mode];
  for (const input of document.getElementsByName('mode')) input.checked = input.value === state.mode;
}

function show_thresholds() {
  $('go').value = Math.round(100 * state.go);
  $('no-go').value = Math.round(100 * state.no_go);
  $('go-value').textContent = state.go.toFixed(2);
  $('no-go-value').textContent = state.no_go.toFixed(2);
}

/// Probabilities of a cell by outcome: [{label, p, rgb}].
function outcomes_of(answer) {
  const rows = [{ label: verdict_label(GO), p: answer.p - answer.slow, rgb: verdict_colour(GO) }, { label: verdict_label(SLOW_GO), p: answer.slow, rgb: verdict_colour(SLOW_GO) }];
  for (const outcome of answer.soil.no_go_outcomes) {
    const q = blob[`${answer.table}_${answer.soil.index}_${outcome.reason}`];
    if (q && answer.index >= 0) rows.push({ label: `${verdict_label(NO_GO)}: ${reason_info(reason_code[outcome.reason]).label}`, p: q[answer.index] / 255, rgb: verdict_colour(NO_GO) });
  }
  // The tables hold weights of reasons over all points, P(go) is of those that were sampled.
  const weight = rows.slice(2).reduce((sum, r) => sum + r.p, 0);
  if (answer.soil.bounded) for (const r of rows.slice(2)) r.p *= (1 - answer.p) / Math.max(weight, 1e-9);
  const shown = rows.filter((r, i) => i < 2 || r.p >= 0.005), rest = 1 - shown.reduce((sum, r) => sum + r.p, 0);
  return rest >= 0.005 ? [...shown, { label: `${verdict_label(NO_GO)}: other`, p: rest, rgb: verdict_colour(NO_GO) }] : shown;
}

/// Verdict of every heading as a rose; the grey needle points downhill.
function rose_of(cell) {
  const svg = shape('svg', { viewBox: '-60 -60 120 120', role: 'img', 'aria-label': 'Class by heading' });
  for (let k = 0; k < 36; ++k) {
    const a = answer_of(cell, 'set', k * 10), from = (k * 10 - 5) * DEGREE, to = (k * 10 + 5) * DEGREE;
    const r = Number.isNaN(a.p) ? 46 : 18 + 28 * a.p;
    const point = (angle, radius) => `${(radius * Math.sin(angle)).toFixed(2)},${(-radius * Math.cos(angle)).toFixed(2)}`;
    svg.append(shape('path', { d: `M${point(from, 10)} L${point(from, r)} A${r},${r} 0 0 1 ${point(to, r)} L${point(to, 10)} Z`, fill: css(verdict_colour(a.verdict)), opacity: a.verdict === UNKNOWN ? 0.45 : 1 }));
  }
  svg.append(shape('circle', { r: 46, fill: 'none', stroke: 'currentColor', 'stroke-opacity': 0.25 }));
  const label = shape('text', { y: -50, 'text-anchor': 'middle', 'font-size': 10, fill: 'currentColor' });
  label.textContent = 'N';
  svg.append(label);
  return svg;
}

function coordinates_of(cell) {
  const [x, y] = centre_of(cell), g = meta.grid;
  return [g.west + x / g.metres_per_unit, g.north - y / g.metres_per_unit];
}

function show_cell() {
  const box = $('cell'), cell = view.chosen;
  if (cell === null) return;
  const answer = answer_of(cell);
  box.replaceChildren();
  if (!answer) { box.append(element('p', { class: 'hint' }, 'No elevation here: no data.')); return; }
  const big = element('span', { class: 'big' });
  big.style.background = css(verdict_colour(answer.verdict));
  const why = answer.verdict === GO || answer.verdict === SLOW_GO ? '' : reason_info(answer.reason).label;
  box.append(element('div', { class: 'verdict' }, big, element('div', {}, element('strong', {}, verdict_label(answer.verdict)), element('span', {}, [why, mode_text()].filter(Boolean).join(', ')))));
  if (known(answer)) show_evidence(box, cell, answer);
  const [e, n] = coordinates_of(cell), unit = meta.grid.unit_name === 'metre' ? 'm' : meta.grid.unit_name;
  box.append(element('h3', {}, 'Ground'), facts([
    ['Slope', grade(slope_of(cell))], ['Falls towards', slope_of(cell) > 0 ? `${blob.aspect[cell]}° ${compass(blob.aspect[cell])}` : 'flat'],
    ['Elevation', fixed(height_of(cell), 1, ' m')], ['Soil', layer_of('soil').read(cell, answer)], ...(blob.rule && blob.rule[cell] ? [[meta.land[blob.rule[cell] - 1].of, meta.land[blob.rule[cell] - 1].name]] : []),
    ['Easting', `${e.toFixed(1)} ${unit}`], ['Northing', `${n.toFixed(1)} ${unit}`], ...place_rows(cell)]));
  if (known(answer)) show_inputs(box, answer.soil);
}

/// The contract's text for a reason, without the remark that only maps give it.
function reason_text(code) {
  const text = reason_info(code).about.replace(/^map only: /, '');
  return text[0].toUpperCase() + text.slice(1);
}

function show_evidence(box, cell, answer) {
  const text = (id) => layer_of(id).read(cell, answer);
  if (!Number.isNaN(answer.p)) {
    const bars = element('div', { class: 'bars' });
    for (const row of Number.isNaN(answer.slow) ? [{ label: 'P(go)', p: answer.p, rgb: verdict_colour(GO) }] : outcomes_of(answer)) {
      const bar = element('i');
      bar.style.cssText = `width:${100 * row.p}%;background:${css(row.rgb)}`;
      bars.append(element('span', {}, row.label), element('div', {}, bar), element('output', {}, percent(row.p, 1)));
    }
    box.append(bars);
  } else box.append(element('p', { class: 'hint' }, `${reason_text(answer.reason)}. No probability is given where ${
    answer.reason === reason_code.soft_soil ? 'grains do not stand for the soil' : 'nothing like it was simulated'}.`));
  const rows = [['P(go)', fixed(answer.p, 4)]];
  const s = blob.slope[cell], low = probability(answer.soil.low[s]), high = probability(answer.soil.high[s]);
  rows.push(['90 % interval, uphill', `${fixed(low, 3)} to ${fixed(high, 3)}`], ['Novelty', text('novelty')]);
  for (const id of ['speed', 'slip', 'sinkage']) if (layer_of(id)) rows.push([layer_of(id).label, text(id)]);
  box.append(facts(rows));
  const passable = percent(answer.soil.passable[s]);
  box.append(element('h3', {}, 'By heading'), element('div', { class: 'rose' }, rose_of(cell), element('p', {}, `${passable} of all headings are go or slow-go. Length of a petal: P(go); pale: not known.`)));
}

function show_inputs(box, soil) {
  box.append(element('h3', {}, `Soil: what stands for ${soil.name}`));
  const list = element('ul', { class: 'plain' });
  for (const point of soil.inputs) list.append(element('li', {}, point));
  box.append(list);
  if (soil.note) box.append(element('p', { class: 'hint' }, soil.note));
  box.append(element('h3', {}, 'What the model does not know here'));
  const unknown = element('ul', { class: 'plain' });
  for (const text of soil.unknown) unknown.append(element('li', {}, text));
  for (const text of soil.stronger_because) unknown.append(element('li', {}, text));
  for (const text of soil.soft_because) unknown.append(element('li', {}, text));
  for (const text of soil.outside_because) unknown.append(element('li', {}, `not sampled: ${text}`));
  for (const text of meta.not_modelled) unknown.append(element('li', {}, text));
  box.append(unknown);
}

/// One line below the map: it covers nothing.
function show_readout(cell) {
  view.read = cell;
  const box = $('readout'), answer = cell >= 0 ? answer_of(cell) : null;
  box.classList.toggle('on', Boolean(answer));
  if (!answer) { box.replaceChildren(element('span', { class: 'quiet' }, 'Point at the map to read it.')); return; }
  const chip = element('b'), [e, n] = coordinates_of(cell), rows = [];
  chip.style.background = css(verdict_colour(answer.verdict));
  if (route.reach && Number.isFinite(route.reach[cell])) rows.push(['From A', cost_text(route.cost, route.reach[cell], true)]);
  for (const id of ['p_go', 'slope', 'height', 'reason', 'soil']) rows.push([layer_of(id).label, layer_of(id).read(cell, answer)]);
  rows.push(...place_rows(cell), ['E, N', `${e.toFixed(0)}, ${n.toFixed(0)}`]);
  for (const layer of layers) if (!['class', 'p_go', 'slope', 'height', 'reason', 'soil'].includes(layer.id)) rows.push([layer.label, layer.read(cell, answer)]);
  box.replaceChildren(element('span', { class: 'head' }, chip, verdict_label(answer.verdict)), ...rows.map(([name, value]) => element('span', {}, element('i', {}, name), ` ${value}`)));
}

const duration = (s) => (s >= 3600 ? `${Math.floor(s / 3600)} h ${Math.round(s % 3600 / 60)} min` : s >= 120 ? `${Math.round(s / 60)} min` : `${s.toFixed(0)} s`);

function show_route(result) {
  const box = $('route');
  box.replaceChildren();
  if (!result) {
    box.append(element('p', { class: 'hint', id: 'route-none' }, 'No way is known: every path crosses cells that are no-go or unknown in the direction of travel.'));
    return;
  }
  const rows = [['Length on the ground', `${(result.length / 1000).toFixed(2)} km`], ['Climb', `${result.climb.toFixed(0)} m`]];
  if (Number.isFinite(result.time)) rows.push(['Driving time', duration(result.time)], ['Mean speed', `${(3.6 * result.length / result.time).toFixed(0)} km/h`]);
  if (route.drive) rows.push(['Chance to get through', percent(route.drive.chance, 1)], ['Places where one gets stuck', route.drive.places.toFixed(2)]);
  if (route.drive && route.drive.weakest) rows.push(['Weakest stretch', weakest_text(route.drive.weakest)]);
  rows.push(['Lowest P(go) on the way', fixed(result.min_p, 3)]);
  if (Number.isFinite(result.energy)) rows.push([meta.energy_of, `${(result.energy / 1e6).toFixed(2)} MJ`]);
  box.append(facts(rows), element('h3', {}, 'Elevation along the route'), profile_of(route.path));
  box.append(element('p', { class: 'hint' }, `Chance: ${DRIVE.draws} draws of soil (alike within about ${DRIVE.soil_length} m), mission and errors of heights. The orange stretch stops most of them.`), export_buttons());
}

function profile_of(path) {
  const heights = path.map(height_of), low = Math.min(...heights), high = Math.max(...heights, low + 1);
  const svg = shape('svg', { class: 'profile', viewBox: '0 0 300 96', preserveAspectRatio: 'none', role: 'img', 'aria-label': `Elevation from ${low.toFixed(0)} to ${high.toFixed(0)} m` });
  const points = heights.map((z, i) => `${(300 * i / Math.max(1, heights.length - 1)).toFixed(1)},${(84 - 72 * (z - low) / (high - low)).toFixed(1)}`);
  svg.append(shape('path', { class: 'area', d: `M0,96 L${points.join(' L')} L300,96 Z` }), shape('path', { class: 'line', d: `M${points.join(' L')}` }));
  for (const [y, z] of [[10, high], [94, low]]) { const t = shape('text', { x: 2, y }); t.textContent = `${z.toFixed(0)} m`; svg.append(t); }
  return svg;
}

/// Text below a printed map: the layer, the shares of the classes, the sources.
function show_print_note() {
  const { count, total } = count_classes(), km2 = cell_w * cell_h * 1e-6, box = $('print-note');
  const shares = meta.verdicts.map((v) => `${verdict_label(v.code)} ${small(total ? 100 * count.get(v.code) / total : 0, count.get(v.code), ' %')}, ${small(count.get(v.code) * km2, count.get(v.code), ' km²')}`);
  box.replaceChildren(
    element('p', {}, `${mode_text()}: ${shares.join('; ')}. Go from P(go) ${state.go.toFixed(2)}, no-go below ${state.no_go.toFixed(2)}.`),
    element('p', {}, meta.about), ...meta.notes.map(([title, lines]) => element('p', {}, `${title}: ${lines.join('; ')}.`)),
    element('p', {}, meta.provenance.filter(([name]) => !/hash$/.test(name) && name !== 'rules').map(([name, value]) => `${name}: ${value}`).join('; ')));
}

function show_about() {
  const box = $('about-text');
  box.replaceChildren(element('p', {}, meta.about));
  for (const [title, lines] of meta.notes) {
    box.append(element('h3', {}, title));
    const list = element('ul', { class: 'plain' });
    for (const text of lines) list.append(element('li', {}, text));
    box.append(list);
  }
  const table = element('table');
  for (const [name, value] of meta.provenance) table.append(element('tr', {}, element('td', {}, name), element('td', {}, value)));
  box.append(element('h3', {}, 'Where it comes from'), table, element('h3', {}, 'Keys'));
  box.append(element('p', {}, 'Tab: next control. On the map: arrows move the crosshair, Enter asks, + and − zoom, 0 whole region, R draws a route, [ and ] turn the heading. 1 to 9: layers, m measures. The address holds what you see: keep it as a bookmark.'));
}
