// Chance to get through a route: the draws of pipeline/map/route/drive.h, with at most 16 points for each soil, whose P(go)
// is interpolated between slopes 2 degrees apart. The members of the model are left out.
const DRIVE = { draws: 200, soil_length: 1000, likeness: 0.3, bed_share: 0.05, waves: 16, seed: 1 };  // as DriveDoubt

/// Uniform random numbers in [0, 1): mulberry32 by T. Ettinger (public domain).
function random_numbers(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
const normal_of = (unit) => Math.sqrt(-2 * Math.log(1 - unit())) * Math.cos(2 * Math.PI * unit());

/// Distribution function of the standard normal distribution, to 1e-7 (Abramowitz and Stegun 26.2.17).
function normal_share(x) {
  const t = 1 / (1 + 0.2316419 * Math.abs(x));
  const tail = Math.exp(-x * x / 2) / Math.sqrt(2 * Math.PI) * t * (0.31938153 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  return x > 0 ? 1 - tail : tail;
}

/// Pieces of a path: both halves of every step, with the rises of the ground along and across the heading.
function drive_pieces(path) {
  const pieces = [];
  let at = 0;
  for (let i = 1; i < path.length; ++i) {
    const k = step_between(path[i - 1], path[i]);
    for (const cell of [path[i - 1], path[i]]) {
      const length = half_step(cell, k).length, psi = fall_line_angle(step_heading[k], blob.aspect[cell]) * DEGREE, rise = Math.tan(slope_of(cell) * DEGREE);
      pieces.push({ cell, heading: step_heading[k] * DEGREE, begin: at, end: at += length, along: rise * Math.cos(psi), across: rise * Math.sin(psi), node: node_of(cell, k) });
    }
  }
  return pieces;
}

/// P(go) of one point of a soil at slopes in degrees, between the entries of its table.
function p_between(soil, point, along, across) {
  const t = soil.drive, q = blob[`drive_${soil.index}`], side = (x, first, count) => Math.min(count - 1, Math.max(0, (x * meta.heading_steps - first) / t.stride));
  const x = side(along, soil.first_along, t.along), y = side(across, soil.first_across, t.across);
  const i = Math.min(t.along - 2, Math.floor(x)), j = Math.min(t.across - 2, Math.floor(y)), u = x - i, v = y - j;
  const at = (a, b) => probability(q[(point * t.along + a) * t.across + b]);
  return (1 - u) * ((1 - v) * at(i, j) + v * at(i, j + 1)) + u * ((1 - v) * at(i + 1, j) + v * at(i + 1, j + 1));
}

/// Error of the gradient in a cell from errors of the heights around it; the same cell errs alike in one draw.
function gradient_noise(heights, cell, unit) {
  const h = (dx, dy) => {
    const c = cell + dy * cells.columns + dx;
    if (!heights.has(c)) heights.set(c, normal_of(unit) * meta.height_error);
    return heights.get(c);
  };
  let east = 0, north = 0;
  for (const k of [-1, 0, 1]) { const w = k ? 1 : 2; east += w * (h(1, k) - h(-1, k)); north += w * (h(k, -1) - h(k, 1)); }
  return [east / (8 * meta.grid.cell_width_m), north / (8 * meta.grid.cell_height_m)];
}

/// One draw: for every piece whether it stops the vehicle.
function drive_once(pieces, unit) {
  const [box] = soils, size = 2 + box.drive.points[0].length, scale = [box.along_count, box.across_count].map((n) => meta.heading_steps / (n - 1) / DRIVE.likeness);
  const waves = Array.from({ length: DRIVE.waves }, () => Array.from({ length: size + 2 }, () => normal_of(unit)));
  const held = new Map(), heights = new Map(), beds = new Map(), spread = Math.sqrt(1 - DRIVE.bed_share);
  return pieces.map((piece) => {
    const soil = soils[blob.soil[piece.cell]], known = held.get(soil.index), away = known ? piece.begin - known.left : Infinity;
    let here = known;
    if (!(unit() < Math.exp(-away / DRIVE.soil_length))) {
      const point = Math.floor(unit() * soil.drive.points.length), x = soil.drive.points[point];
      here = { point, phase: waves.map((w) => x.reduce((sum, value, v) => sum + w[v] * value / DRIVE.likeness, 0)) };
    }
    here.left = piece.begin;
    held.set(soil.index, here);
    let { along, across } = piece;
    if (meta.height_error > 0) {
      const [east, north] = gradient_noise(heights, piece.cell, unit), s = Math.sin(piece.heading), c = Math.cos(piece.heading);
      along += east * s + north * c;
      across += north * s - east * c;
    }
    along = Math.atan(along) / DEGREE;
    across = Math.atan(across) / DEGREE;
    let rest = 0;
    waves.forEach((w, k) => { const phase = here.phase[k] + w[size - 2] * along * scale[0] + w[size - 1] * across * scale[1]; rest += w[size] * Math.cos(phase) + w[size + 1] * Math.sin(phase); });
    const bed = Math.floor(piece.begin / meta.rules.correlation_length_m);
    if (!beds.has(bed)) beds.set(bed, normal_of(unit));
    return p_between(soil, here.point, along, across) < normal_share(-spread * rest / Math.sqrt(DRIVE.waves) - Math.sqrt(DRIVE.bed_share) * beds.get(bed));
  });
}

/// {chance, places, weakest: {begin, end, stuck, reason, soil, first, last}}; null for a path without a step.
function forecast_drive(path) {
  const pieces = drive_pieces(path), apart = meta.rules.correlation_length_m, stuck = new Float64Array(pieces.length), draws = [];
  if (!pieces.length) return null;
  const unit = random_numbers(DRIVE.seed);
  let through = 0, places = 0;
  for (let d = 0; d < DRIVE.draws; ++d) {
    const stops = drive_once(pieces, unit), before = places;
    let last = -Infinity;
    stops.forEach((stop, i) => { if (!stop) return; stuck[i] += 1 / DRIVE.draws; places += pieces[i].begin - last >= apart; last = pieces[i].end; });
    through += places === before;
    draws.push(stops);
  }
  const result = { chance: through / DRIVE.draws, places: places / DRIVE.draws, weakest: null };
  if (places) {
    const worst = stuck.indexOf(Math.max(...stuck));
    const edge = (step) => { let e = worst; for (let i = worst; i >= 0 && i < pieces.length && Math.abs(pieces[i].begin - pieces[e].begin) <= apart; i += step) if (stuck[i] >= stuck[worst] / 2) e = i; return e; };
    const first = edge(-1), last = edge(1), soil = soils[blob.soil[pieces[worst].cell]];
    result.weakest = {
      begin: pieces[first].begin, end: pieces[last].end, stuck: draws.filter((stops) => stops.slice(first, last + 1).some(Boolean)).length / DRIVE.draws,
      reason: likeliest_reason(soil, 'heading', pieces[worst].node), soil: soil.name, cells: pieces.slice(first, last + 1).map((p) => p.cell),
    };
  }
  return result;
}

/// "km 2.31 to 2.48: no traction in 12.0 % of the draws, loam".
const weakest_text = (w) => `km ${(w.begin / 1000).toFixed(2)} to ${(w.end / 1000).toFixed(2)}: ${meta.reasons.find((r) => r.code === w.reason).label} in ${percent(w.stuck, 1)} of the draws, ${w.soil}`;
