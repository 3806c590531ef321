// The state of the page in its address, behind the #: layer, heading, thresholds, view, chosen cell and route.
const number_in = (text, low, high) => { const v = Number(text); return text !== null && text !== '' && v >= low && v <= high ? v : null; };

function link_text() {
  const p = new URLSearchParams();
  p.set('layer', state.layer);
  p.set('mode', state.mode === 'set' ? state.heading : state.mode);
  p.set('go', state.go);
  p.set('no_go', state.no_go);
  p.set('opacity', state.opacity);
  if (state.safe_colours) p.set('safe', 1);
  if (state.terms !== 'model') p.set('terms', state.terms);
  p.set('at', [view.x, view.y].map((v) => v.toFixed(1)).join(','));
  p.set('scale', view.scale.toPrecision(6));
  if (view.chosen !== null) p.set('cell', view.chosen);
  p.set('cost', route.cost);
  if (route.start !== null) p.set('from', route.start);
  if (route.end !== null) p.set('to', route.end);
  if (route.reaching) p.set('reach', 1);
  return p.toString();
}

let linking = 0, linked = '';
/// Soon: dragging changes the state many times a second.
function remember() {
  clearTimeout(linking);
  linking = setTimeout(write_link, 250);
}
function write_link() {
  const text = link_text();
  if (text === linked) return;
  linked = text;
  history.replaceState(null, '', `#${text}`);
}

/// Takes what the address says; values that the map does not have are left out.
function follow_link() {
  const p = new URLSearchParams(location.hash.slice(1)), last = blob.slope.length - 1;
  const cell = (name) => { const v = number_in(p.get(name), 0, last); return v === null ? null : Math.floor(v); };
  if (layer_of(p.get('layer'))) state.layer = p.get('layer');
  const mode = p.get('mode'), degrees = number_in(mode, 0, 359);
  if (['uphill', 'worst', 'best'].includes(mode)) state.mode = mode;
  else if (degrees !== null) { state.mode = 'set'; state.heading = Math.floor(degrees); }
  const go = number_in(p.get('go'), 0, 1), no_go = number_in(p.get('no_go'), 0, 1);
  if (go !== null && no_go !== null && no_go <= go) { state.go = go; state.no_go = no_go; for (const soil of soils) soil.update(); }
  state.opacity = number_in(p.get('opacity'), 0, 1) ?? state.opacity;
  state.safe_colours = p.get('safe') === '1';
  if (TERMS[p.get('terms')]) state.terms = p.get('terms');
  const [x, y] = (p.get('at') ?? '').split(','), scale = number_in(p.get('scale'), 1e-9, 1e9);
  if (scale !== null && number_in(x, -1e9, 1e9) !== null && number_in(y, -1e9, 1e9) !== null) Object.assign(view, { x: Number(x), y: Number(y), scale });
  view.chosen = cell('cell');
  if (usable_costs().some(([id]) => id === p.get('cost'))) route.cost = p.get('cost');
  Object.assign(route, { start: cell('from'), end: cell('to'), path: null, reach: null, drawing: false, reaching: p.get('reach') === '1' });
  if (route.start === null) route.end = null;
}
