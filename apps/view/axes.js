// Ranges and azimuths over a picture, as SVG of the picture's size in pixels, and the bar of its colours.
/* global beamEdges, ticksWithin */

const kSvg = 'http://www.w3.org/2000/svg';
const kRings = 5;    // about
const kLines = 4;    // about
const kArcSteps = 32;

// `lookup`: of frame_viewer.js.
export function drawAxes(svg, {range_m: [nearest, farthest], azimuth_deg: azimuth}, {width, height, place}) {
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  const edges = beamEdges(azimuth);
  const [first, last] = [edges[0], edges[edges.length - 1]];
  const parts = [];
  const line = (points) => {
    const polyline = document.createElementNS(kSvg, 'polyline');
    polyline.setAttribute('points', points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(' '));
    parts.push(polyline);
  };
  const text = (words, [x, y], anchor, down) => {
    const label = document.createElementNS(kSvg, 'text');
    label.setAttribute('x', Math.min(width - 4, Math.max(4, x)).toFixed(1));
    label.setAttribute('y', Math.min(height - 6, Math.max(18, y + down)).toFixed(1));
    label.setAttribute('text-anchor', anchor);
    label.textContent = words;
    parts.push(label);
  };
  for (const {value: range, text: words} of ticksWithin([nearest, farthest], kRings)) {
    const arc = Array.from({length: kArcSteps + 1}, (_, i) => first + ((last - first) * i) / kArcSteps);
    line(arc.map((at) => place(range, at)));
    text(`${words} m`, place(range, first), 'start', -4);
  }
  for (const {value: at, text: words} of ticksWithin([first, last], kLines)) {
    line([place(nearest, at), place(farthest, at)]);
    text(`${words}\u00b0`, place(farthest, at), 'middle', 20);
  }
  svg.replaceChildren(...parts);
}

// `colours`: red, green and blue from one end to the other; `ends`: what stands there; `name`: what it shows.
export function drawBar(bar, colours, [low, high], name) {
  const stops = colours.filter((_, i) => i % 15 === 0 || colours.length < 32).map(([r, g, b]) => `rgb(${r} ${g} ${b})`);
  const scale = document.createElement('i');
  scale.style.backgroundImage = `linear-gradient(to right, ${stops.join(', ')})`;
  bar.replaceChildren(low, scale, high, ` ${name}`);
}
