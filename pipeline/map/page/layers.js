// The layers: value of a cell, its colour, its legend, and how the value reads.
const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
const css = (rgb) => `rgb(${rgb[0]} ${rgb[1]} ${rgb[2]})`;
const fixed = (x, digits, unit = '') => (Number.isNaN(x) || x === undefined ? 'no value' : x.toFixed(digits) + unit);
const percent = (x, digits = 0) => (Number.isNaN(x) ? 'no value' : (100 * x).toFixed(digits) + ' %');
const NO_VALUE = [150, 152, 162];

// Viridis (van der Walt and Smith; CC0) for probabilities, and single-hue ramps for the rest: none of them holds red.
const RAMPS = {
  viridis: ['#440154', '#3b528b', '#21918c', '#5ec962', '#fde725'].map(hex),
  slope: ['#f7f4ea', '#dcc9a3', '#b58f63', '#7d5a43', '#3b2a2a'].map(hex),
  cool: ['#f1f6f5', '#b3d6d8', '#69abc2', '#3a76a6', '#243f77'].map(hex),
  violet: ['#f6f2fa', '#d3c4e6', '#a68fcf', '#7659ab', '#47307a'].map(hex),
  height: ['#356859', '#7fa36b', '#d6cf94', '#b98d64', '#f3f0ec'].map(hex),
};
const SOIL_COLOURS = ['#c8a15a', '#7c9a5e', '#a8754f', '#6f8fa8', '#b9a6c9', '#d4bd86', '#8d7f6a', '#93b7a4'].map(hex);

function on_ramp(name, share) {
  const stops = RAMPS[name], x = Math.min(1, Math.max(0, share)) * (stops.length - 1), i = Math.min(stops.length - 2, Math.floor(x));
  return stops[i].map((c, k) => Math.round(c + (stops[i + 1][k] - c) * (x - i)));
}

/// Names of the classes: the model's own, those of NG-NRMM (AMSP-06), and those of cross-country mobility overlays (FM
/// 5-33, MCOO).
const TERMS = {
  model: {}, nrmm: { [GO]: 'GO', [SLOW_GO]: 'SLOW GO', [NO_GO]: 'NO GO' },
  ccm: { [GO]: 'unrestricted', [SLOW_GO]: 'restricted', [NO_GO]: 'severely restricted' },
};
const verdict_label = (code) => TERMS[state.terms][code] ?? verdict_info(code).label;
const verdict_info = (code) => meta.verdicts.find((v) => v.code === code);
const verdict_colour = (code) => hex(state.safe_colours ? verdict_info(code).colour_blind_safe : verdict_info(code).colour);
const reason_info = (code) => meta.reasons.find((r) => r.code === code);

/// A layer of numbers: a ramp between two values.
function ramp_layer(id, label, ramp, range, value, text, note = '') {
  return {
    id, label, ramp, range, value, text, note,
    colour(cell, answer) {
      const v = value(cell, answer);
      return Number.isNaN(v) ? NO_VALUE : on_ramp(ramp, (v - range[0]) / (range[1] - range[0]));
    },
    read: (cell, answer) => text(value(cell, answer)),
  };
}

/// A layer of classes: code of a cell, and the legend's entries {code, label, rgb}.
const class_layer = (id, label, code, entries, note = '') => ({
  id, label, entries, note,
  colour(cell, answer) { const c = code(cell, answer), e = entries().find((x) => x.code === c); return e ? e.rgb : NO_VALUE; },
  read(cell, answer) { const c = code(cell, answer), e = entries().find((x) => x.code === c); return e ? e.label : 'no value'; },
});

const known = (answer) => answer && answer.soil;
const grade = (s) => `${s.toFixed(1)}° (${(100 * Math.tan(s * DEGREE)).toFixed(0)} %)`;

function make_layers() {
  const sample = soils.length ? soils[0].measures : {};
  const unit_of = (cell) => (blob.soil[cell] < NO_SOIL ? soils[blob.soil[cell]] : null);
  const measure = (name) => (cell, a) => (known(a) && !Number.isNaN(a.p) ? unit_of(cell).measure(name, ...slopes_of(cell)) : NaN);
  const table = (name) => (cell) => { const s = unit_of(cell); return s && s[name] ? probability(s[name][blob.slope[cell]]) : NaN; };
  const spread = (cell) => table('high')(cell) - table('low')(cell);
  const list = [
    class_layer('class', 'Go / no-go', (c, a) => a.verdict, () => meta.verdicts.map((v) => ({ code: v.code, label: verdict_label(v.code), rgb: verdict_colour(v.code) }))),
    ramp_layer('p_go', 'P(go)', 'viridis', [0, 1], (c, a) => a.p, (v) => fixed(v, 3), 'Probability that a valid trial ends in go or slow-go'),
    class_layer('reason', 'Reason', (c, a) => a.reason, () => meta.reasons.map((r) => ({ code: r.code, label: r.label, rgb: hex(r.colour) })), 'Why the class is what it is'),
    ramp_layer('spread', 'Uncertainty', 'violet', [0, 1], spread, (v) => fixed(v, 3), 'Width of the 90 % interval on P(go), uphill'),
    ramp_layer('passable', 'Headings', 'viridis', [0, 1], (c) => { const s = unit_of(c); return s ? s.passable[blob.slope[c]] : NaN; }, (v) => percent(v), 'Share of headings that are go or slow-go'),
    ramp_layer('novelty', 'Novelty', 'violet', [0, 4], (c) => { const s = unit_of(c); return s && s.novelty ? (s.novelty[blob.slope[c]] === NONE16 ? NaN : s.novelty[blob.slope[c]] / 1000) : NaN; }, (v) => fixed(v, 2), 'Distance to the nearest trial; 1: as near as trials are to one another'),
  ];
  // As the measures, the worst and best headings show it uphill.
  const speed = (cell, a) => (!known(a) || Number.isNaN(a.p) || a.verdict === NO_GO ? NaN : state.mode === 'set' ? a.soil.speed(a.table, a.index) : a.soil.speed('uphill', blob.slope[cell]));
  if (soils.some((s) => s.uphill_speed)) list.push(ramp_layer('speed', 'Top speed', 'cool', [0, meta.max_speed], speed, (v) => (Number.isNaN(v) ? 'no value' : `${v.toFixed(0)} km/h`), 'Where tractive force equals slope and motion resistance; not where it is no-go'));
  if (sample.slip) list.push(ramp_layer('slip', 'Slip', 'cool', [0, 0.6], measure('slip'), (v) => percent(v), 'Expected slip of trials that pass'));
  if (sample.sinkage) list.push(ramp_layer('sinkage', 'Sinkage', 'cool', [0, meta.max_sinkage], measure('sinkage'), (v) => (Number.isNaN(v) ? 'no value' : `${(100 * v).toFixed(1)} cm`), 'Expected sinkage of trials that pass'));
  list.push(ramp_layer('slope', 'Slope', 'slope', [0, 40], (c) => slope_of(c), grade, 'Degrees and per cent grade'));
  list.push(class_layer('soil', 'Soil', (c) => blob.soil[c], () => soils.map((s, i) => ({ code: i, label: s.name, rgb: SOIL_COLOURS[i % SOIL_COLOURS.length] })).concat([{ code: NO_SOIL, label: 'not known', rgb: NO_VALUE }])));
  list.push(ramp_layer('height', 'Elevation', 'height', [meta.height.lowest, meta.height.highest], (c) => height_of(c), (v) => fixed(v, 0, ' m')));
  return list;
}
let layers = [];
const layer_of = (id) => layers.find((l) => l.id === id);

function stops_of(layer) {
  const [low, high] = layer.range, middle = (low + high) / 2;
  if (layer.id === 'slope') return [0, 10, 20, 30, 40].map((s) => `${s}°\n${(100 * Math.tan(s * DEGREE)).toFixed(0)}\u00a0%`);
  if (layer.id === 'novelty') return ['0', '2', '4+'];
  return [low, middle, high].map((v) => layer.text(v).replace('.000', '').replace('.500', '.5'));
}

function show_legend() {
  const layer = layer_of(state.layer), box = $('legend');
  box.replaceChildren();
  const title = document.createElement('h2');
  title.textContent = layer.label + (['class', 'p_go', 'reason', 'speed', 'slip', 'sinkage'].includes(layer.id) ? `, ${mode_text()}` : '');
  box.append(title);
  const item = (rgb, text) => {
    const li = document.createElement('li'), b = document.createElement('b');
    b.style.background = css(rgb);
    li.append(b, text);
    return li;
  };
  const list = document.createElement('ul');
  if (layer.entries) {
    const seen = present_codes(layer);
    for (const e of layer.entries()) if (layer.id === 'class' || seen.has(e.label)) list.append(item(e.rgb, e.label));
  } else {
    const ramp = document.createElement('div'), stops = document.createElement('div');
    ramp.className = 'ramp';
    ramp.style.background = `linear-gradient(90deg, ${RAMPS[layer.ramp].map(css).join(', ')})`;
    stops.className = 'stops';
    for (const text of stops_of(layer)) { const s = document.createElement('span'); s.textContent = text; stops.append(s); }
    box.append(ramp, stops);
    list.className = 'none';
    if (!['slope', 'height'].includes(layer.id)) list.append(item(NO_VALUE, 'no value'));
  }
  box.append(list);
  if (bands.lines) list.append(element('li', { class: 'bands' }, element('b'), `every ${cost_text(route.cost, bands.interval)} from A`));
  if (layer.note) { const p = document.createElement('div'); p.className = 'quiet'; p.textContent = layer.note; box.append(p); }
}

function present_codes(layer) {
  const seen = new Set(), step = Math.max(1, Math.floor(blob.slope.length / 40000));
  for (let c = 0; c < blob.slope.length; c += step) { const a = answer_of(c); if (a) seen.add(layer.read(c, a)); }
  return seen;
}
