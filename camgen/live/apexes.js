// Where the points of a linkage go while one is dragged: each from two placed ones and its distances from them, in the order that
// camgen gives. The answer is camgen's own: start, and paths over the turn as x, y, x, y, ...; null where it does not close.
"use strict";

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const ends = key => key.split("-").map(end => end.trim());

function moved(asked, sheet) {  // a sheet's points and lengths after a drag
  const points = { ...sheet.points, ...asked.points };
  const lengths = Object.fromEntries(Object.entries(sheet.lengths).map(([key, length]) => {
    const [a, b] = ends(key), follows = asked.follow && (a in asked.points || b in asked.points);
    return [[a, b].sort(), follows ? Math.max(0.01, distance(points[a], points[b])) : length];
  }));
  return { ...sheet, points, lengths };
}

function motion({ apexes, angles, gaps }, { points, lengths, links, drive }) {
  const ground = links.ground, driven = links[drive];
  const length = (a, b) => lengths[[a, b].sort()] ?? distance(points[a], points[b]);
  const triangle = (a, b, name) => {  // the place of a point from those of a and b
    const [p, q, r] = [points[a], points[b], points[name]], side = (q[0] - p[0]) * (r[1] - p[1]) < (q[1] - p[1]) * (r[0] - p[0]) ? -1 : 1;
    const first = length(a, name), second = length(b, name);
    return (from, to) => apex(from, to, first, second, side);
  };
  const laid = ([a, b, ...rest]) => {  // a link as its lengths have it, its first point and the direction to the second as drawn
    if (b === undefined) return { [a]: points[a] };
    const share = length(a, b) / distance(points[a], points[b]), end = points[a].map((x, k) => x + share * (points[b][k] - x));
    return { [a]: points[a], [b]: end, ...Object.fromEntries(rest.map(name => [name, triangle(a, b, name)(points[a], end)])) };
  };
  const paths = Object.fromEntries(Object.entries(laid(ground)).map(([name, place]) => [name, angles.map(() => place)]));
  const crank = laid(driven), pivot = driven.find(name => ground.includes(name)), [cx, cy] = crank[pivot];
  for (const name of driven.filter(name => name !== pivot)) {
    const x = crank[name][0] - cx, y = crank[name][1] - cy;
    paths[name] = angles.map((angle, k) => {
      const [c, s] = [Math.cos(angle), Math.sin(angle)], [px, py] = paths[pivot][k];
      return [px + c * x - s * y, py + s * x + c * y];
    });
  }
  for (const [name, a, b] of apexes) {
    const place = triangle(a, b, name);
    paths[name] = angles.map((_, k) => place(paths[a][k], paths[b][k]));
  }
  const closed = angles.map((_, k) => Object.values(paths).every(path => path[k].every(isFinite)));
  return answered(paths, reached(closed, angles), gaps);
}

function apex([px, py], [qx, qy], first, second, side) {  // of the triangle with these sides; NaN where they do not meet
  const x = qx - px, y = qy - py, square = x * x + y * y, along = (square + first * first - second * second) / (2 * square);
  const across = first * first / square - along * along, rounding = 1e-9;  // of a point on the line
  const up = side * Math.sqrt(across < 0 && across > -rounding ? 0 : across);
  return [px + along * x - up * y, py + along * y + up * x];
}

function reached(closed, angles) {  // of a turn the angles beside the drawn place, as far as the chain closes either way; all of a range
  if (Math.abs(Math.abs(angles.at(-1) - angles[1]) - 2 * Math.PI) > 1e-6) return closed;
  const first = closed.indexOf(false, 1), last = closed.lastIndexOf(false);
  return closed.map((is, k) => is && (first < 0 || k < first || k > last));
}

function answered(paths, closed, gaps) {
  if (!closed[0]) return { start: null };  // camgen says why
  const turn = closed.slice(1), share = turn.filter(Boolean).length / turn.length;
  const rows = Object.entries(paths), flat = path => path.slice(1).flatMap((place, k) => turn[k] ? place : [null, null]);
  return {
    start: Object.fromEntries(rows.map(([name, path]) => [name, path[0]])),
    paths: Object.fromEntries(rows.map(([name, path]) => [name, flat(path)])),
    reason: share === 1 ? "" : gaps.replace("PERCENT", Math.round(100 * share)),
  };
}
