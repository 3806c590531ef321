// Routes over the cells: the costs of pipeline/map/route/cost.h, Dijkstra with a binary heap.
const route = { start: null, end: null, path: null, drive: null, reach: null, drawing: false, cost: 'time', reaching: false };
const COSTS = [['time', 'Fastest'], ['risk', 'Safest'], ['energy', 'Least energy'], ['length', 'Shortest']];
const STEPS = [[0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1]];  // from north, clockwise
const step_heading = STEPS.map(([dx, dy]) => (Math.round(Math.atan2(dx * cell_w, -dy * cell_h) / DEGREE) + 360) % 360);
const step_length = STEPS.map(([dx, dy]) => Math.hypot(dx * cell_w, dy * cell_h));
const usable_costs = () => COSTS.filter(([id]) => (id === 'time' ? soils.some((s) => s.node_speed) : id === 'energy' ? soils.some((s) => s.measures.energy_per_metre) : true));

/// Costs per metre of map distance at a node of a soil's heading table; null if it cannot be passed.
function per_metre(soil, node) {
  const verdict = soil.node_class[node];
  if (verdict !== GO && verdict !== SLOW_GO) return null;
  const along = (Math.floor(node / soil.across_count) + soil.first_along) / meta.heading_steps;
  const across = (node % soil.across_count + soil.first_across) / meta.heading_steps;
  const length = 1 / Math.cos(along * DEGREE), speed = soil.speed('heading', node) / 3.6;  // m/s
  return {
    length, time: length / speed, risk: -Math.log(Math.min(1, soil.p_at(node))) * length / meta.rules.correlation_length_m,
    energy: length * Math.max(0, soil.measure('energy_per_metre', along, across)), p: soil.p_at(node),
  };
}

const blocked = (cell) => blob.soil[cell] >= NO_SOIL || (blob.rule && blob.rule[cell] !== 0);
const node_of = (cell, k) => places[blob.slope[cell] * 360 + fall_line_angle(step_heading[k], blob.aspect[cell])];

/// Cost of half a step in direction k inside a cell, or null if it cannot be passed.
function half_step(cell, k) {
  const node = blocked(cell) ? -1 : node_of(cell, k), cost = node >= 0 ? per_metre(soils[blob.soil[cell]], node) : null;
  if (!cost) return null;
  for (const name of ['length', 'time', 'risk', 'energy']) cost[name] *= step_length[k] / 2;
  return cost;
}

/// One kind of cost of every node of every soil; infinite where it cannot be passed.
let factors = [];
function make_factors(kind) {
  factors = soils.map((soil) => Float64Array.from(soil.node_p, (_, node) => { const cost = per_metre(soil, node); return cost ? cost[kind] : Infinity; }));
}
function half_cost(cell, k) {
  const node = blocked(cell) ? -1 : node_of(cell, k);
  return node < 0 ? Infinity : factors[blob.soil[cell]][node] * step_length[k] / 2;
}

function can_ever_pass(cell) {
  if (blocked(cell)) return false;
  const best = soils[blob.soil[cell]].best.verdict[blob.slope[cell]];
  return best === GO || best === SLOW_GO;
}

/// Cost from the start to every cell, and the cell before each; ends early at `end`.
function dijkstra(start, end, kind) {
  const count = blob.slope.length, cost = new Float64Array(count).fill(Infinity), before = new Int32Array(count).fill(-1);
  const heap = new Heap(), done = new Uint8Array(count), passable = new Uint8Array(count);
  for (let c = 0; c < count; ++c) passable[c] = can_ever_pass(c) ? 1 : 0;
  make_factors(kind);
  cost[start] = 0;
  heap.push(0, start);
  while (heap.size) {
    const cell = heap.pop();
    if (done[cell]) continue;
    done[cell] = 1;
    if (cell === end) break;
    const column = cell % cells.columns, row = (cell - column) / cells.columns;
    for (let k = 0; k < 8; ++k) {
      const x = column + STEPS[k][0], y = row + STEPS[k][1];
      if (x < 0 || y < 0 || x >= cells.columns || y >= cells.rows) continue;
      const next = y * cells.columns + x;
      if (done[next] || !passable[next]) continue;
      // A diagonal step touches two more cells: both must be passable in some heading.
      if (k % 2 && (!passable[row * cells.columns + x] || !passable[y * cells.columns + column])) continue;
      const sum = cost[cell] + half_cost(cell, k) + half_cost(next, k);
      if (sum < cost[next]) { cost[next] = sum; before[next] = cell; heap.push(sum, next); }
    }
  }
  return { cost, before };
}

class Heap {
  constructor() { this.key = []; this.item = []; }
  get size() { return this.key.length; }
  push(key, item) {
    let i = this.key.length;
    this.key.push(key); this.item.push(item);
    for (let parent; i > 0 && this.key[parent = (i - 1) >> 1] > key; i = parent) { this.key[i] = this.key[parent]; this.item[i] = this.item[parent]; }
    this.key[i] = key; this.item[i] = item;
  }
  pop() {
    const top = this.item[0], key = this.key.pop(), item = this.item.pop(), n = this.key.length;
    if (n === 0) return top;
    let i = 0;
    for (;;) {
      let child = 2 * i + 1;
      if (child >= n) break;
      if (child + 1 < n && this.key[child + 1] < this.key[child]) ++child;
      if (this.key[child] >= key) break;
      this.key[i] = this.key[child]; this.item[i] = this.item[child];
      i = child;
    }
    this.key[i] = key; this.item[i] = item;
    return top;
  }
}

/// Which of the eight steps leads from one cell to its neighbour.
function step_between(from, to) {
  const dx = to % cells.columns - from % cells.columns, dy = Math.floor(to / cells.columns) - Math.floor(from / cells.columns);
  return STEPS.findIndex(([x, y]) => x === dx && y === dy);
}

/// Totals along a path: length and climb; time, risk and energy if the model has measures.
function totals_of(path) {
  const sum = { length: 0, time: 0, risk: 0, energy: 0, climb: 0, min_p: 1 };
  for (let i = 1; i < path.length; ++i) {
    const k = step_between(path[i - 1], path[i]);
    for (const cell of [path[i - 1], path[i]]) {
      const h = half_step(cell, k);
      for (const name of ['length', 'time', 'risk', 'energy']) sum[name] += h[name];
      sum.min_p = Math.min(sum.min_p, h.p);
    }
    sum.climb += Math.max(0, height_of(path[i]) - height_of(path[i - 1]));
  }
  return sum;
}

function find_route() {
  const { cost, before } = dijkstra(route.start, route.end, route.cost);
  route.path = null;
  if (!Number.isFinite(cost[route.end])) return null;
  const path = [];
  for (let cell = route.end; cell !== -1; cell = before[cell]) path.push(cell);
  route.path = path.reverse();
  route.drive = forecast_drive(route.path);
  return { cost: cost[route.end], ...totals_of(route.path) };
}
