// Longitude, latitude and MGRS of places on the map.

/// [longitude, latitude] of a place [m from the map's corner], bilinear between the nodes that the map command gave. null
/// where the map has none.
function degrees_of(x, y) {
  const d = meta.degrees;
  if (!d) return null;
  const u = Math.min(d.columns - 1, Math.max(0, x / (meta.grid.columns * meta.grid.cell_width_m) * (d.columns - 1))), v = Math.min(d.rows - 1, Math.max(0, y / (meta.grid.rows * meta.grid.cell_height_m) * (d.rows - 1)));
  const i = Math.min(d.columns - 2, Math.floor(u)), j = Math.min(d.rows - 2, Math.floor(v)), s = u - i, t = v - j;
  const at = (list) => {
    const k = j * d.columns + i;
    return (list[k] * (1 - s) + list[k + 1] * s) * (1 - t) + (list[k + d.columns] * (1 - s) + list[k + d.columns + 1] * s) * t;
  };
  const longitude = at(d.longitude);
  return [(longitude + 540) % 360 - 180, at(d.latitude)];
}

const degrees_text = ([longitude, latitude]) => `${Math.abs(latitude).toFixed(5)}° ${latitude < 0 ? 'S' : 'N'}, ${Math.abs(longitude).toFixed(5)}° ${longitude < 0 ? 'W' : 'E'}`;

/// Easting and northing [m] on the ellipsoid of WGS 84 by Krueger's series (Karney 2011, eq. 7 to 12 and 35), to n^4.
function utm_of(longitude, latitude, zone) {
  const n = 1 / 298.257223563 / (2 - 1 / 298.257223563), n2 = n * n, n3 = n2 * n, n4 = n2 * n2;
  const alpha = [n / 2 - 2 / 3 * n2 + 5 / 16 * n3 + 41 / 180 * n4, 13 / 48 * n2 - 3 / 5 * n3 + 557 / 1440 * n4, 61 / 240 * n3 - 103 / 140 * n4, 49561 / 161280 * n4];
  const radius = 6378137 / (1 + n) * (1 + n2 / 4 + n4 / 64), e = 2 * Math.sqrt(n) / (1 + n);
  const phi = latitude * DEGREE, lambda = (((longitude - (6 * zone - 183)) + 540) % 360 - 180) * DEGREE;
  const sigma = Math.sinh(e * Math.atanh(e * Math.tan(phi) / Math.hypot(1, Math.tan(phi)))), tau = Math.tan(phi);
  const conformal = tau * Math.hypot(1, sigma) - sigma * Math.hypot(1, tau);
  const xi = Math.atan2(conformal, Math.cos(lambda)), eta = Math.asinh(Math.sin(lambda) / Math.hypot(conformal, Math.cos(lambda)));
  let x = eta, y = xi;
  alpha.forEach((a, k) => { const j = 2 * (k + 1); x += a * Math.cos(j * xi) * Math.sinh(j * eta); y += a * Math.sin(j * xi) * Math.cosh(j * eta); });
  return [500000 + 0.9996 * radius * x, (latitude < 0 ? 1e7 : 0) + 0.9996 * radius * y];
}

/// Zone of UTM, with the exceptions of Norway and Svalbard.
function zone_of(longitude, latitude) {
  if (latitude >= 56 && latitude < 64 && longitude >= 3 && longitude < 12) return 32;
  if (latitude >= 72 && longitude >= 0 && longitude < 42) return longitude < 9 ? 31 : longitude < 21 ? 33 : longitude < 33 ? 35 : 37;
  return Math.min(60, Math.floor((longitude + 180) / 6) + 1);
}

/// "10SGJ 12345 67890", to 1 m, after NGA.STND.0037. Empty beyond 84 degrees north and 80 south, where UTM ends.
function mgrs_of(longitude, latitude) {
  if (latitude < -80 || latitude > 84) return '';
  const zone = zone_of(longitude, latitude), [x, y] = utm_of(longitude, latitude, zone).map(Math.floor);
  const band = 'CDEFGHJKLMNPQRSTUVWXX'[Math.floor((latitude + 80) / 8)];
  const column = 'ABCDEFGHJKLMNPQRSTUVWXYZ'[(zone - 1) % 3 * 8 + Math.floor(x / 1e5) - 1];
  const row = 'ABCDEFGHJKLMNPQRSTUV'[(Math.floor(y / 1e5) + (zone % 2 ? 0 : 5)) % 20];
  const digits = (v) => String(v % 1e5).padStart(5, '0');
  return `${zone}${band}${column}${row} ${digits(x)} ${digits(y)}`;
}

/// Rows for the panel and the readout: [name, value].
function place_rows(cell) {
  const place = degrees_of(...centre_of(cell));
  if (!place) return [];
  const mgrs = meta.degrees.wgs84 ? mgrs_of(...place) : '';
  return [[meta.degrees.wgs84 ? 'WGS 84' : 'Degrees of the body', degrees_text(place)], ...(mgrs ? [['MGRS', mgrs]] : [])];
}
