// P(go), class and reason of a cell: looks up the tables of its soil by slope and heading, with the rules of
// pipeline/map/region/rules.cpp and heading_table.cpp.
const GO = 1, SLOW_GO = 2, NO_GO = 3, UNKNOWN = 4;
const DEGREE = Math.PI / 180;
const state = {
  layer: 'class', mode: 'uphill', heading: 0, opacity: 0.8, go: meta.rules.go, no_go: meta.rules.no_go, safe_colours: false,
  terms: 'model',
};
const reason_code = {};
for (const r of meta.reasons) reason_code[r.name] = r.code;

const cells = meta.cells;  // {columns, rows, step}
const cell_w = meta.grid.cell_width_m * cells.step, cell_h = meta.grid.cell_height_m * cells.step;  // [m]

/// As C's lround: half away from zero.
const rounded = (x) => (x < 0 ? -Math.floor(-x + 0.5) : Math.floor(x + 0.5));

function bed_slopes(slope, psi) {
  const rise = Math.tan(slope * DEGREE);
  return [Math.atan(rise * Math.cos(psi)) / DEGREE, Math.atan(rise * Math.sin(psi)) / DEGREE];
}
/// psi in whole degrees, 0 to 359; headings and aspects are whole degrees.
const fall_line_angle = (heading, aspect) => (heading - aspect + 540) % 360;

/// Node of the heading tables for slope and psi. -1: outside the sampled box. -2 - j: steeper uphill than sampled, at
/// slope j across. The box is the same for every soil.
let places = null;
function make_places() {
  const box = meta.soils[0], steps = 90 * meta.slope_steps + 1;
  places = new Int32Array(steps * 360);
  const cosine = [], sine = [];
  for (let a = 0; a < 360; ++a) { cosine.push(Math.cos(a * DEGREE)); sine.push(Math.sin(a * DEGREE)); }
  for (let s = 0; s < steps; ++s) {
    const rise = Math.tan(s / meta.slope_steps * DEGREE);
    for (let a = 0; a < 360; ++a) {
      const i = rounded(Math.atan(rise * cosine[a]) / DEGREE * meta.heading_steps) - box.first_along;
      const j = rounded(Math.atan(rise * sine[a]) / DEGREE * meta.heading_steps) - box.first_across;
      places[s * 360 + a] = i < 0 || j < 0 || j >= box.across_count ? -1 : i >= box.along_count ? -2 - j : i * box.across_count + j;
    }
  }
}

const probability = (q) => (q === NONE16 ? NaN : q / 65534);

function verdict_at(p, slow_is_likelier) {
  if (p < state.no_go) return NO_GO;
  return p < state.go || slow_is_likelier ? SLOW_GO : GO;
}

/// Class of one entry of a table, as classify() in pipeline/map/region/rules.cpp; `bounds` as PassageBounds there.
function classify(p, p_slow, bounds) {
  if (Number.isNaN(bounds.most)) return UNKNOWN;
  if (bounds.most < state.no_go) return NO_GO;
  if (bounds.least < state.no_go) return UNKNOWN;
  const slow = p_slow > p - p_slow, verdict = verdict_at(bounds.lower, slow);
  if (verdict !== verdict_at(bounds.upper, slow)) return UNKNOWN;
  return verdict === GO && bounds.least < state.go ? SLOW_GO : verdict;
}

function likeliest_reason(soil, table, index) {
  let best = -1, reason = 0;
  for (const outcome of soil.no_go_outcomes) {
    const q = blob[`${table}_${soil.index}_${outcome.reason}`];
    const p = q ? q[index] : 0;
    if (p > best) { best = p; reason = reason_code[outcome.reason]; }
  }
  return reason;
}

/// Reason of an unknown cell, from the share of its points that were not sampled or are too soft.
const reason_of_unknown = (outside, soft) => (soft > 0 && 2 * soft >= outside ? reason_code.soft_soil : reason_code.outside_sampled);

/// Tables of one soil: p, verdict and reason of every node. Rebuilt when a threshold changes.
class Soil {
  constructor(info, index) {
    Object.assign(this, info);
    this.index = index;
    this.node_p = blob[`heading_go_${index}`];
    this.node_slow = blob[`heading_slow_${index}`];
    this.uphill_p = blob[`uphill_go_${index}`];
    this.uphill_slow = blob[`uphill_slow_${index}`];
    this.low = blob[`low_${index}`];
    this.high = blob[`high_${index}`];
    this.novelty = blob[`novelty_${index}`];
    this.node_speed = blob[`heading_speed_${index}`];
    this.uphill_speed = blob[`uphill_speed_${index}`];
    this.update();
  }

  /// Bounds of entry i of a table. Where every point was sampled and the soil is one, all are P(go).
  bounds(table, i) {
    const of = (name) => probability(blob[`${table}_${name}_${this.index}`][i]);
    if (this.bounded) return { lower: of('lower'), upper: of('upper'), least: of('least'), most: of('most') };
    const p = probability((table === 'uphill' ? this.uphill_p : this.node_p)[i]);
    return { lower: p, upper: p, least: p, most: p };
  }

  update() {
    const classes = (table, p, slow) => Uint8Array.from(p, (q, i) => classify(probability(q), probability(slow[i]), this.bounds(table, i)));
    this.node_class = classes('heading', this.node_p, this.node_slow);
    this.uphill_class = classes('uphill', this.uphill_p, this.uphill_slow);
    const inside = this.outside_share > 0 ? reason_of_unknown(this.outside_share, this.soft_share) : reason_code.input_missing;
    this.reason_outside = reason_of_unknown(1, this.soft_share);
    const reasons = (table, verdicts) => verdicts.map((v, i) => (v === NO_GO ? likeliest_reason(this, table, i)
      : v !== UNKNOWN ? 0 : Number.isNaN(this.bounds(table, i).most) ? this.reason_outside : inside));
    this.node_reason = reasons('heading', this.node_class);
    this.uphill_reason = reasons('uphill', this.uphill_class);
    const last = this.along_count - 1;
    this.steeper = Array.from({ length: this.across_count }, (_, j) => last >= 0 && this.node_class[last * this.across_count + j] === NO_GO);
    const asked = this.bounded ? blob[`uphill_most_${this.index}`] : this.uphill_p, sampled = asked.findLastIndex((q) => q !== NONE16);
    if (sampled >= 0 && this.uphill_class[sampled] === NO_GO) {
      this.uphill_class.fill(NO_GO, sampled + 1);
      this.uphill_reason.fill(this.uphill_reason[sampled], sampled + 1);
    }
    this.last_uphill = sampled;
    this.over_headings();
  }

  /// Verdict, P(go) and node of a place; the node that decides where it is steeper than sampled.
  verdict_at(place) { return place >= 0 ? this.node_class[place] : place <= -2 && this.steeper[-2 - place] ? NO_GO : UNKNOWN; }
  p_at(place) { return place >= 0 ? probability(this.node_p[place]) : NaN; }
  reason_at(place) {
    const verdict = this.verdict_at(place);
    if (verdict === UNKNOWN) return place >= 0 ? this.node_reason[place] : this.reason_outside;
    return verdict === NO_GO ? this.node_reason[place >= 0 ? place : (this.along_count - 1) * this.across_count - 2 - place] : 0;
  }

  over_headings() {
    const steps = this.uphill_p.length;
    const empty = () => ({ verdict: new Uint8Array(steps), reason: new Uint8Array(steps), p: new Float32Array(steps).fill(NaN), node: new Int32Array(steps).fill(-1) });
    this.worst = empty();
    this.best = empty();
    this.passable = new Float32Array(steps);
    for (let s = 0; s < steps; ++s) this.over_headings_at(s);
  }

  over_headings_at(s) {
    let worst = GO, best = NO_GO, worst_reason = 0, best_reason = 0, unknown = 0, passable = 0;
    for (let h = 0; h < meta.headings; ++h) {
      const node = places[s * 360 + h * 360 / meta.headings], verdict = this.verdict_at(node), p = this.p_at(node);
      const reason = verdict === NO_GO || verdict === UNKNOWN ? this.reason_at(node) : 0;
      if (!Number.isNaN(p)) {
        if (!(p >= this.worst.p[s])) { this.worst.p[s] = p; this.worst.node[s] = node; }
        if (!(p <= this.best.p[s])) { this.best.p[s] = p; this.best.node[s] = node; }
      }
      if (verdict === UNKNOWN) { unknown = unknown === reason_code.soft_soil ? unknown : reason; continue; }
      if (verdict !== NO_GO) ++passable;
      if (verdict > worst) { worst = verdict; worst_reason = reason; }
      if (verdict < best || (h === 0 && verdict === NO_GO)) { best = verdict; best_reason = reason; }
    }
    if (unknown && worst !== NO_GO) { worst = UNKNOWN; worst_reason = unknown; }
    if (unknown && best === NO_GO) { best = UNKNOWN; best_reason = unknown; }
    this.worst.verdict[s] = worst; this.worst.reason[s] = worst_reason;
    this.best.verdict[s] = best; this.best.reason[s] = best_reason;
    this.passable[s] = passable / meta.headings;
  }

  /// Top speed [km/h] of an entry of a table; NaN where there is none.
  speed(table, index) {
    const values = table === 'uphill' ? this.uphill_speed : this.node_speed;
    return !values || index < 0 || values[index] === NONE16 ? NaN : values[index] / 100;
  }

  measure(name, along, across) {
    const m = this.measures[name];
    if (!m) return NaN;
    const value = m.base + along * (m.along + m.along2 * along) + across * (m.across + m.across2 * across);
    return Math.min(m.highest, Math.max(m.lowest, value));
  }
}

let soils = [];

const slope_of = (cell) => blob.slope[cell] / meta.slope_steps;
const height_of = (cell) => (blob.height[cell] === NONE16 ? NaN : meta.height.lowest + blob.height[cell] * meta.height.step);

/// Answer for a cell under the chosen heading: {verdict, reason, p, slow, table, index}.
function answer_of(cell, mode = state.mode, heading = state.heading) {
  const answer = known_answer_of(cell, mode, heading);
  if (answer && answer.verdict === UNKNOWN && answer.soil && !answer.soil.given) answer.reason = reason_code.input_missing;
  return answer;
}

function known_answer_of(cell, mode, heading) {
  const unit = blob.soil[cell];
  if (unit === NO_DATA) return null;
  const rule = blob.rule ? blob.rule[cell] : 0;
  if (rule) return { verdict: meta.land[rule - 1].verdict, reason: meta.land[rule - 1].reason, p: NaN, slow: NaN };
  if (unit === NO_SOIL) return { verdict: UNKNOWN, reason: reason_code.input_missing, p: NaN, slow: NaN };
  const soil = soils[unit], s = blob.slope[cell];
  if (mode === 'uphill') {
    const p = probability(soil.uphill_p[s]);
    return { verdict: soil.uphill_class[s], reason: soil.uphill_reason[s], p, slow: probability(soil.uphill_slow[s]), table: 'uphill', index: Number.isNaN(p) ? -1 : s, soil };
  }
  if (mode === 'set') {
    const place = places[s * 360 + fall_line_angle(heading, blob.aspect[cell])];
    return { verdict: soil.verdict_at(place), reason: soil.reason_at(place), p: soil.p_at(place), slow: place >= 0 ? probability(soil.node_slow[place]) : NaN, table: 'heading', index: place, soil };
  }
  const of = soil[mode];
  return { verdict: of.verdict[s], reason: of.reason[s], p: of.p[s], slow: of.node[s] >= 0 ? probability(soil.node_slow[of.node[s]]) : NaN, table: 'heading', index: of.node[s], soil };
}

/// Slopes along and across the chosen heading, for the measures.
function slopes_of(cell) {
  const psi = state.mode === 'set' ? fall_line_angle(state.heading, blob.aspect[cell]) : 0;
  return bed_slopes(slope_of(cell), psi * DEGREE);
}
