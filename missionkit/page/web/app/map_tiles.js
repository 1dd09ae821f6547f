// Offline tiles below the map, placed by where the flight's origin lies on Earth.

const EARTH = 6378137; // m, equatorial radius (WGS 84)
const SIZE = 256; // px of a tile
const KEPT = 200;
const RADIANS = Math.PI / 180;
const images = new Map();

/** Draw the tiles that the server has; `arrived` is called when one more can be drawn. */
export function drawTiles(context, p, { origin, tiles }, arrived) {
  if (!origin || !tiles) return;
  const stretch = Math.cos(origin.lat * RADIANS);
  const ideal = Math.log2((2 * Math.PI * EARTH * stretch * p.scale) / SIZE);
  const zoom = Math.min(Math.max(Math.round(ideal), tiles.min_zoom), tiles.max_zoom);
  const count = 2 ** zoom;
  const metres = (2 * Math.PI * EARTH * stretch) / count; // on the ground, a side
  const [column, row] = tileOf(origin, count);
  const side = metres * p.scale;
  const first = [Math.floor(column + p.east(0) / metres), Math.floor(row - p.north(0) / metres)];
  for (let x = first[0]; p.x((x - column) * metres) < p.width; x++) {
    for (let y = first[1]; p.y((row - y) * metres) < p.height; y++) {
      const image = tile(`/api/tiles/${zoom}/${x}/${y}`, arrived);
      if (image) context.drawImage(image, p.x((x - column) * metres), p.y((row - y) * metres), side, side);
    }
  }
}

/** Column and row, with fractions, of a place (web Mercator). */
function tileOf({ lat, lon }, count) {
  const north = Math.asinh(Math.tan(lat * RADIANS));
  return [((lon + 180) / 360) * count, ((1 - north / Math.PI) / 2) * count];
}

function tile(path, arrived) {
  let image = images.get(path);
  if (!image) {
    image = new Image();
    image.onload = arrived;
    image.src = path;
    images.set(path, image);
    if (images.size > KEPT) images.delete(images.keys().next().value);
  }
  return image.complete && image.naturalWidth ? image : null;
}
