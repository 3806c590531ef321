// Reads the data that the map command embedded: one JSON object, and deflated arrays with a filter each.
const $ = (id) => document.getElementById(id);
const meta = JSON.parse($('meta').textContent);
const NONE16 = 65535, NO_DATA = 255, NO_SOIL = 254;
const blob = {};

function base64_bytes(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// Undoes the filter of pipeline/map/page/blob.cpp, which stores the difference of each value from its prediction.
function unfilter(value, width, filter) {
  const mask = value instanceof Uint8Array ? 255 : 65535;
  for (let i = 0; i < value.length; ++i) {
    const left = i % width ? value[i - 1] : 0, up = i >= width ? value[i - width] : 0;
    const corner = i % width && i >= width ? value[i - width - 1] : 0;
    const expected = filter === 1 ? left : filter === 2 ? left + up - corner : filter === 3 ? (left + up) >> 1 : 0;
    value[i] = (value[i] + expected) & mask;
  }
  return value;
}

async function read_blobs() {
  for (const element of document.querySelectorAll('script[type="application/x-gonogo"]')) {
    const bytes = await inflate(base64_bytes(element.textContent));
    const width = Number(element.dataset.width), filter = Number(element.dataset.filter);
    let value = bytes;
    if (element.dataset.bits === '16') {  // low bytes first, then high bytes
      const count = bytes.length / 2;
      value = new Uint16Array(count);
      for (let i = 0; i < count; ++i) value[i] = bytes[i] | (bytes[count + i] << 8);
    }
    blob[element.id] = unfilter(value, width, filter);
    element.remove();
  }
}
