// Full resolution for a page served by `gonogo view`. When zoomed in it draws tiles of the GeoTIFFs over the thinned
// picture, and a click reads the exact cell. A page opened from disk sends no requests.
const served = location.protocol.startsWith('http') && meta.cells.step > 1;
const tiles = new Map();
const TILE = 512, MOST_TILES = 200;

/// The GeoTIFF of the layer that the page shows. null if thresholds or heading differ from those of the map.
function served_layer() {
  const study = state.go === meta.rules.go && state.no_go === meta.rules.no_go && !state.safe_colours;
  const mode = state.mode === 'worst' || state.mode === 'best' ? `_${state.mode}` : '';
  if (state.mode === 'set') return null;
  if (state.layer === 'class') return study ? (mode ? `go${mode}` : meta.map_heading === 'uphill heading' ? 'go' : null) : null;
  if (state.layer === 'p_go') return mode ? `p_go${mode}` : meta.map_heading === 'uphill heading' ? 'p_go' : null;
  if (state.layer === 'reason') return study && !mode && meta.map_heading === 'uphill heading' ? 'reason' : null;
  return ['novelty', 'speed', 'slip', 'sinkage'].includes(state.layer) && !mode ? state.layer : null;
}

function tile_image(name) {
  if (tiles.has(name)) return tiles.get(name);
  if (tiles.size >= MOST_TILES) tiles.delete(tiles.keys().next().value);
  const image = new Image();
  image.onload = () => { view.dirty = true; };
  image.src = `/tile/${name}`;
  tiles.set(name, image);
  return image;
}

function draw_served() {
  const layer = served && served_layer();
  if (!layer) return;
  const cell = meta.grid.cell_width_m, tall = meta.grid.cell_height_m;
  const level = Math.max(0, Math.floor(Math.log2(1 / (view.scale * cell)) + 0.5));
  if (2 ** level >= meta.cells.step) return;
  const width = TILE * cell * 2 ** level, height = TILE * tall * 2 ** level;
  const [left, top] = to_map(0, 0), [right, bottom] = to_map(canvas.clientWidth, canvas.clientHeight);
  context.globalAlpha = state.opacity;
  context.imageSmoothingEnabled = view.scale * cell * 2 ** level < 1;
  for (let y = Math.max(0, Math.floor(top / height)); y * height < Math.min(bottom, map_h()); ++y)
    for (let x = Math.max(0, Math.floor(left / width)); x * width < Math.min(right, map_w()); ++x) {
      const image = tile_image(`${layer}/${level}/${x}/${y}`);
      if (!image.complete || !image.naturalWidth) continue;
      const [px, py] = to_screen(x * width, y * height);
      context.drawImage(image, px, py, image.naturalWidth * cell * 2 ** level * view.scale, image.naturalHeight * tall * 2 ** level * view.scale);
    }
  context.globalAlpha = 1;
}

/// Values of all layers in the cell under a place [m from the map's corner].
async function show_served_cell([x, y]) {
  if (!served) return;
  const column = Math.floor(x / meta.grid.cell_width_m), row = Math.floor(y / meta.grid.cell_height_m);
  const answer = await fetch(`/cell/${column}/${row}`);
  if (!answer.ok) return;
  const rows = Object.values(await answer.json()).map((e) => [e.title, e.value === null ? 'no value' : e.label || `${Number(e.value.toPrecision(5))}${e.unit && e.unit !== '1' ? ` ${e.unit}` : ''}`]);
  const old = document.getElementById('served-cell');
  if (old) old.remove();
  $('cell').append(element('div', { id: 'served-cell' }, element('h3', {}, `In the GeoTIFFs: column ${column}, row ${row}`), facts(rows)));
}
