// From metres to pixels: north up, the same scale both ways.

const LEAST = 0.05; // px per m
const MOST = 800;

/** A view of a map: `centre` [n, e] in the middle, `scale` px per m. */
export function makeView() {
  return { centre: [0, 0], scale: 8, follow: false, fitted: false };
}

/** Functions from metres to px of a canvas of this size. */
export function projection(view, width, height) {
  const [north, east] = view.centre;
  const { scale } = view;
  return {
    scale,
    width,
    height,
    x: (e) => width / 2 + (e - east) * scale,
    y: (n) => height / 2 - (n - north) * scale,
    north: (y) => north + (height / 2 - y) / scale,
    east: (x) => east + (x - width / 2) / scale,
  };
}

/** Show all these points [n, e], with a border. */
export function fit(view, points, width, height) {
  if (!points.length || !width) return;
  const [norths, easts] = [points.map((it) => it[0]), points.map((it) => it[1])];
  const [south, north] = extent(norths);
  const [west, east] = extent(easts);
  view.centre = [(south + north) / 2, (west + east) / 2];
  const border = 0.8;
  const size = Math.min((border * height) / Math.max(north - south, 4), (border * width) / Math.max(east - west, 4));
  view.scale = limited(size);
}

function extent(values) {
  return values.reduce(([low, high], it) => [Math.min(low, it), Math.max(high, it)], [Infinity, -Infinity]);
}

function limited(scale) {
  return Math.min(Math.max(scale, LEAST), MOST);
}

/** Zoom so that the place under (x, y) stays where it is. */
export function zoomAt(view, factor, x, y, width, height) {
  const before = projection(view, width, height);
  const [n, e] = [before.north(y), before.east(x)];
  view.scale = limited(view.scale * factor);
  view.centre = [n - (height / 2 - y) / view.scale, e - (x - width / 2) / view.scale];
}

/** A round distance (m) that takes about `pixels`. */
export function roundDistance(scale, pixels) {
  const raw = pixels / scale;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [5, 2, 1].map((it) => it * power).find((it) => it <= raw) ?? power;
}
