// Routes as files: GPX with elevations, GeoJSON with the totals. Both hold WGS 84.
const xml = (text) => text.replace(/[<>&"]/g, (c) => ({ '<': '&lt;', '>': '&gt;', '&': '&amp;', '"': '&quot;' }[c]));

const route_places = () => route.path.map((cell) => [...degrees_of(...centre_of(cell)), height_of(cell)]);
const route_name = () => `${COSTS.find(([id]) => id === route.cost)[1]}: ${meta.title}`;

function route_gpx() {
  const points = route_places().map(([x, y, z]) => `<trkpt lat="${y.toFixed(7)}" lon="${x.toFixed(7)}">${Number.isNaN(z) ? '' : `<ele>${z.toFixed(1)}</ele>`}</trkpt>`);
  return `<?xml version="1.0" encoding="UTF-8"?>\n<gpx version="1.1" creator="gonogo" xmlns="http://www.topografix.com/GPX/1/1">\n<trk><name>${xml(route_name())}</name><trkseg>\n${points.join('\n')}\n</trkseg></trk>\n</gpx>\n`;
}

function route_geojson() {
  const sum = totals_of(route.path), properties = { name: route_name(), length_m: sum.length, risk: sum.risk };
  if (route.drive) Object.assign(properties, { chance: route.drive.chance, stuck_places: route.drive.places });
  if (route.drive && route.drive.weakest) properties.weakest = weakest_text(route.drive.weakest);
  if (Number.isFinite(sum.time)) properties.time_s = sum.time;
  if (Number.isFinite(sum.energy)) properties.energy_j = sum.energy;
  const coordinates = route_places().map(([x, y, z]) => [Number(x.toFixed(7)), Number(y.toFixed(7)), ...(Number.isNaN(z) ? [] : [Number(z.toFixed(1))])]);
  return JSON.stringify({ type: 'FeatureCollection', features: [{ type: 'Feature', properties, geometry: { type: 'LineString', coordinates } }] });
}

function save(name, type, text) {
  const link = element('a', { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/// Buttons below a route; none where the map has no WGS 84.
function export_buttons() {
  if (!meta.degrees || !meta.degrees.wgs84) return element('p', { class: 'hint' }, 'No way to WGS 84 is known, so routes cannot be saved as GPX or GeoJSON.');
  const gpx = element('button', { type: 'button', id: 'save-gpx' }, 'Save GPX'), json = element('button', { type: 'button', id: 'save-geojson' }, 'Save GeoJSON');
  gpx.addEventListener('click', () => save('route.gpx', 'application/gpx+xml', route_gpx()));
  json.addEventListener('click', () => save('route.geojson', 'application/geo+json', route_geojson()));
  return element('div', { class: 'buttons' }, gpx, json);
}
