// Lines of equal cost over the reachable area, with their labels; the intervals of pipeline/map/route/bands.cpp.
const bands = { interval: 0, labels: [], lines: null };

function round_interval(kind, least) {
  if (!(least > 0)) return 1;
  if (kind === 'time' && least > 30) for (const s of [60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400]) if (s >= least) return s;
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((f) => f * power).find((v) => v >= least);
}

/// "12 min", "0.5 km", "risk 0.2": a cost as people say it.
function cost_text(kind, cost, exact = false) {
  const number = (v) => String(Number(v.toPrecision(exact ? 3 : 6)));
  if (kind === 'time') return cost >= 7200 ? `${Math.floor(cost / 3600)} h ${Math.round(cost % 3600 / 60)} min` : cost >= 60 ? `${number(exact ? Math.round(cost / 6) / 10 : cost / 60)} min` : `${number(cost)} s`;
  if (kind === 'energy') return cost >= 1e5 ? `${number(cost / 1e6)} MJ` : `${number(cost / 1e3)} kJ`;
  if (kind === 'length') return cost >= 1000 ? `${number(cost / 1000)} km` : `${number(cost)} m`;
  return `risk ${number(cost)}`;
}

/// Marks the cells beside which a band ends, and one label a line, spread over the directions from the start.
function make_bands() {
  bands.labels = [];
  bands.lines = null;
  const cost = route.reach;
  if (!cost) return;
  let most = 0;
  for (const c of cost) if (Number.isFinite(c) && c > most) most = c;
  bands.interval = round_interval(route.cost, most / 8);
  const w = cells.columns, band = (c) => (Number.isFinite(cost[c]) ? Math.floor(cost[c] / bands.interval) : -1);
  bands.lines = new Uint8Array(cost.length);
  const best = new Map(), [sx, sy] = centre_of(route.start);
  for (let c = 0; c < cost.length; ++c) {
    const here = band(c);
    if (here < 0) continue;
    for (const next of [c % w < w - 1 ? c + 1 : -1, c + w < cost.length ? c + w : -1]) {
      const there = next < 0 ? -1 : band(next);
      if (there < 0 || there === here) continue;
      bands.lines[c] = 1;
      const k = Math.max(here, there), [x, y] = centre_of(c), turn = Math.atan2(x - sx, y - sy) - k * 1.3;
      const off = Math.abs(Math.atan2(Math.sin(turn), Math.cos(turn)));
      if (!best.has(k) || off < best.get(k).off) best.set(k, { off, cell: c });
    }
  }
  for (const [k, { cell }] of best) bands.labels.push({ cell, text: cost_text(route.cost, k * bands.interval) });
}

function draw_bands() {
  context.font = '600 12px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  for (const { cell, text } of bands.labels) {
    const [x, y] = to_screen(...centre_of(cell)), width = context.measureText(text).width + 8;
    context.fillStyle = 'rgb(255 255 255 / .88)';
    context.fillRect(x - width / 2, y - 9, width, 18);
    context.fillStyle = '#5b0b43';
    context.fillText(text, x, y + 0.5);
  }
}
