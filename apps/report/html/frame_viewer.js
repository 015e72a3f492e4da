'use strict';
// The frame viewer of a report (frame_viewer.h): draws two polar images and their object regions as the reader
// asks for them, from the embedded pictures, whose grey values are the data. The viewer is folded away until it is
// asked for, as the page shows some of its pictures; without this script it stays hidden.

const kHeightPx = 520;
const kLargestWidthPx = 960;
const kBlinkMs = 600;  // slower than the three flashes a second that some people must not see
const kDifferenceShown = 0.5;  // of full scale: as blue or orange as it gets

// What no colour bar says; `real` is how the real side is called, recorded or synthetic.
const keysOf = (real) => ({
  blink: `The ${real} and the simulated image in turn; the space bar changes over.`,
  difference: 'Full colour where one is brighter by half of full scale.',
  regions: `Object in the ${real} image alone: blue; in the simulated one alone: orange; in both: white.`,
});

// `index`: the sample (bin x beams + beam) that each pixel of a picture shows, -1 outside. `place`: where a range
// in m and an azimuth in degrees lie, in pixels.
function polarLookup(geometry, bins) {
  const beams = geometry.azimuth_deg.length;
  const width = Math.round(0.75 * kHeightPx);
  const index = new Int32Array(width * kHeightPx);
  for (let y = 0; y < kHeightPx; ++y) {
    const bin = Math.floor(((y + 0.5) * bins) / kHeightPx);
    for (let x = 0; x < width; ++x) {
      index[y * width + x] = bin * beams + Math.floor(((x + 0.5) * beams) / width);
    }
  }
  const [nearest, farthest] = geometry.range_m;
  const edges = beamEdges(geometry.azimuth_deg);
  const place = (range, azimuth) => {
    const beam = Math.max(0, Math.min(beams - 1, edges.findIndex((edge) => edge > azimuth) - 1));
    const share = (azimuth - edges[beam]) / (edges[beam + 1] - edges[beam]);
    return [((beam + share) * width) / beams, ((range - nearest) / (farthest - nearest)) * kHeightPx];
  };
  return {width, height: kHeightPx, index, place};
}

// Beams end halfway to their neighbours; the outermost reach as far outwards as inwards.
function beamEdges(azimuth) {
  const count = azimuth.length;
  const edges = [];
  for (let i = 1; i < count; ++i) edges.push(0.5 * (azimuth[i - 1] + azimuth[i]));
  const first = count > 1 ? azimuth[0] - (edges[0] - azimuth[0]) : azimuth[0] - 0.5;
  const last = count > 1 ? azimuth[count - 1] + (azimuth[count - 1] - edges[count - 2]) : azimuth[0] + 0.5;
  return [first, ...edges, last];
}

function fanLookup(geometry, bins) {
  const radians = Math.PI / 180;
  const [nearest, farthest] = geometry.range_m;
  const edges = beamEdges(geometry.azimuth_deg);
  const beams = geometry.azimuth_deg.length;
  const first = edges[0] * radians;
  const last = edges[beams] * radians;
  const corners = [nearest, farthest].flatMap((r) => [first, last].map((a) => [r * Math.sin(a), r * Math.cos(a)]));
  const left = Math.min(...corners.map((c) => c[0]), first < -Math.PI / 2 ? -farthest : Infinity);
  const right = Math.max(...corners.map((c) => c[0]), last > Math.PI / 2 ? farthest : -Infinity);
  const bottom = Math.min(...corners.map((c) => c[1]));
  const top = first <= 0 && last >= 0 ? farthest : Math.max(...corners.map((c) => c[1]));
  const pixel = Math.max((top - bottom) / kHeightPx, (right - left) / kLargestWidthPx);
  const width = Math.max(1, Math.round((right - left) / pixel));
  const height = Math.max(1, Math.round((top - bottom) / pixel));
  const index = new Int32Array(width * height).fill(-1);
  for (let row = 0; row < height; ++row) {
    const y = top - (row + 0.5) * pixel;
    for (let col = 0; col < width; ++col) {
      const x = left + (col + 0.5) * pixel;
      const range = Math.hypot(x, y);
      const azimuth = Math.atan2(x, y) / radians;
      const bin = Math.floor(((range - nearest) / (farthest - nearest)) * bins);
      if (bin < 0 || bin >= bins || azimuth < edges[0] || azimuth >= edges[beams]) continue;
      let low = 0;  // the beam whose edges hold the azimuth
      let high = beams;
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (azimuth < edges[middle]) high = middle;
        else low = middle;
      }
      index[row * width + col] = bin * beams + low;
    }
  }
  const place = (range, azimuth) => [(range * Math.sin(azimuth * radians) - left) / pixel,
                                     (top - range * Math.cos(azimuth * radians)) / pixel];
  return {width, height, index, place};
}

// Whose region ends at a pixel, as bits of `objects`: 1 recorded, 2 simulated. Beside the last column and below
// the last row lies nothing.
function edgesAt({width, index}, at, objects) {
  const own = objects[index[at]];
  const beside = (at + 1) % width > 0 && index[at + 1] >= 0 ? objects[index[at + 1]] : 0;
  const below = index[at + width] >= 0 ? objects[index[at + width]] : 0;
  return ((own ^ beside) | (own ^ below)) & 3;
}

// A ring about the middle one of the pixels that show a sample; none where none does.
function drawRing(context, {width, index}, sample) {
  const pixels = [];
  for (let i = 0; i < index.length; ++i) if (index[i] === sample) pixels.push(i);
  if (sample < 0 || !pixels.length) return;
  const at = pixels[pixels.length >> 1];
  const x = (at % width) + 0.5;
  const y = Math.floor(at / width) + 0.5;
  for (const [line, style] of [[4, '#000'], [2, '#fff']]) {
    context.lineWidth = line;
    context.strokeStyle = style;
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    context.stroke();
  }
}

// Colours of the grey values 0 .. 255, from the filter by which the page colours its pictures.
function infernoColours() {
  const channels = [...document.querySelector('#inferno feComponentTransfer').children].map(
      (channel) => channel.getAttribute('tableValues').split(' ').map((value) => Math.round(255 * value)));
  return channels[0].map((_, i) => channels.map((channel) => channel[i]));
}

async function greyValues(id) {
  const image = new Image();
  image.src = document.getElementById(id).getAttribute('href');
  await image.decode();
  const canvas = document.createElement('canvas');
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  const context = canvas.getContext('2d', {willReadFrequently: true});
  context.drawImage(image, 0, 0);
  const rgba = context.getImageData(0, 0, canvas.width, canvas.height).data;
  const grey = new Uint8Array(canvas.width * canvas.height);
  for (let i = 0; i < grey.length; ++i) grey[i] = rgba[4 * i];
  return {values: grey, rows: canvas.height};
}

function startViewer(root) {
  const data = JSON.parse(root.dataset.viewer);
  const keys = keysOf(data.real);
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const canvas = part('canvas');
  const slider = part('slider');
  const context = canvas.getContext('2d', {willReadFrequently: true});  // pixels are put, not painted
  const still = window.matchMedia('(prefers-reduced-motion: reduce)');
  const colours = {inferno: infernoColours(), grey: Array.from({length: 256}, (_, i) => [i, i, i])};
  const lookups = new Map();
  let shown = null;  // what the canvas shows: frame, images, lookup
  let cursor = -1;   // a sample
  let second = false;  // of the two that blink
  let asked = 0;

  const chosen = (name) => root.querySelector(`input[data-choice="${name}"]:checked`).value;

  async function load(frame) {
    const images = {};
    for (const [of, id] of Object.entries(data.frames[frame].pictures)) images[of] = await greyValues(id);
    return images;
  }

  function lookupFor(frame, bins) {
    const geometry = data.frames[frame].geometry;
    const key = `${chosen('view')} ${geometry} ${bins}`;
    if (!lookups.has(key)) {
      const make = chosen('view') === 'fan' ? fanLookup : polarLookup;
      lookups.set(key, make(data.geometries[geometry], bins));
    }
    return lookups.get(key);
  }

  function colourOf(show) {
    const {real, simulated, objects} = shown.images;
    const scale = colours[part('colours').value];
    if (show === 'blink') show = second ? 'simulated' : 'real';
    if (show === 'real') return (i) => scale[real.values[i]];
    if (show === 'simulated') return (i) => scale[simulated.values[i]];
    if (show === 'regions') return (i) => data.regions[objects.values[i] & 3];
    if (show === 'overlay') {
      return (i) => {
        const r = real.values[i];
        const s = simulated.values[i];
        return [s, (r + s) / 2, r];
      };
    }
    return (i) => {
      const d = (simulated.values[i] - real.values[i]) / 255 / kDifferenceShown;
      const t = Math.min(1, Math.abs(d));
      const end = d < 0 ? data.regions[1] : data.regions[2];
      return end.map((c) => data.alike + t * (c - data.alike));
    };
  }

  function draw() {
    if (!shown) return;
    const show = chosen('show');
    const {width, height, index} = shown.lookup;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const picture = context.createImageData(width, height);
    const colour = colourOf(show);
    const objects = shown.images.objects.values;
    const outlined = part('outline').checked;
    for (let i = 0; i < index.length; ++i) {
      if (index[i] < 0) continue;  // stays transparent
      let rgb = colour(index[i]);
      if (outlined) {
        const edges = edgesAt(shown.lookup, i, objects);
        if (edges) rgb = data.regions[edges & 1 ? 1 : 2];
      }
      picture.data.set([rgb[0], rgb[1], rgb[2], 255], 4 * i);
    }
    context.putImageData(picture, 0, 0);
    drawRing(context, shown.lookup, cursor);
    part('key').textContent = keys[show] ?? '';
    const bar = {overlay: 'overlay', difference: 'difference', regions: ''}[show] ?? part('colours').value;
    const axes = `${chosen('view')} ${data.frames[shown.frame].geometry}`;
    for (const of of root.querySelectorAll('[data-bar]')) of.toggleAttribute('hidden', of.dataset.bar !== bar);
    for (const of of root.querySelectorAll('[data-axes]')) of.toggleAttribute('hidden', of.dataset.axes !== axes);
    part('which').textContent = show !== 'blink' ? '' : second ? 'simulated' : data.real;
  }

  function read() {
    const frame = data.frames[shown.frame];
    const geometry = data.geometries[frame.geometry];
    const beams = geometry.azimuth_deg.length;
    if (cursor < 0) {
      part('readout').textContent = 'Point at the picture, or focus it and use the arrow keys, to read both values.';
      return;
    }
    const bin = Math.floor(cursor / beams);
    const beam = cursor % beams;
    const [nearest, farthest] = geometry.range_m;
    const range = nearest + ((bin + 0.5) * (farthest - nearest)) / shown.images.real.rows;
    const grey = (of) => Math.round((shown.images[of].values[cursor] * frame.full_scale) / 255);
    const number = (value, digits) => value.toFixed(digits).replace('-', '\u2212');
    part('readout').textContent =
        `${number(range, 3)} m, ${number(geometry.azimuth_deg[beam], 2)}\u00b0 (bin ${bin}, beam ${beam}): ` +
        `${data.real} ${grey('real')}, simulated ${grey('simulated')}, ` +
        `difference ${number(grey('simulated') - grey('real'), 0)} of ${frame.full_scale}`;
  }

  async function showFrame() {
    const frame = Number(slider.value);
    const mine = ++asked;
    const images = shown && shown.frame === frame ? shown.images : await load(frame);
    if (mine !== asked) return;  // another was asked for in the meantime
    const lookup = lookupFor(frame, images.real.rows);
    if (shown && cursor >= images.real.values.length) cursor = -1;
    shown = {frame, images, lookup};
    const {name, figures} = data.frames[frame];
    part('name').textContent = `${name} (${frame + 1} of ${data.frames.length})`;
    part('figures').textContent = figures;
    slider.setAttribute('aria-valuetext', name);
    canvas.setAttribute('aria-label', `${name}: ${chosen('show')}, ${chosen('view')} view`);
    root.dataset.ready = 'yes';
    draw();
    read();
  }

  function step(by) {
    const last = data.frames.length - 1;
    slider.value = Math.min(last, Math.max(0, Number(slider.value) + by));
    showFrame();
  }

  function moveCursor(right, down) {
    const geometry = data.geometries[data.frames[shown.frame].geometry];
    const beams = geometry.azimuth_deg.length;
    const bins = shown.images.real.rows;
    if (cursor < 0) cursor = Math.floor(bins / 2) * beams + Math.floor(beams / 2);
    const farther = chosen('view') === 'fan' ? -down : down;
    const bin = Math.min(bins - 1, Math.max(0, Math.floor(cursor / beams) + farther));
    const beam = Math.min(beams - 1, Math.max(0, (cursor % beams) + right));
    cursor = bin * beams + beam;
    draw();
    read();
  }

  function point(event) {
    if (!shown) return;
    const box = canvas.getBoundingClientRect();
    const x = Math.floor(((event.clientX - box.left) * canvas.width) / box.width);
    const y = Math.floor(((event.clientY - box.top) * canvas.height) / box.height);
    const inside = x >= 0 && y >= 0 && x < canvas.width && y < canvas.height;
    cursor = inside ? shown.lookup.index[y * canvas.width + x] : -1;
    draw();
    read();
  }

  const steps = {
    ArrowLeft: () => moveCursor(-1, 0),
    ArrowRight: () => moveCursor(1, 0),
    ArrowUp: () => moveCursor(0, -1),
    ArrowDown: () => moveCursor(0, 1),
    PageUp: () => step(-1),
    PageDown: () => step(1),
    ' ': () => {
      second = !second;
      draw();
    },
  };
  canvas.addEventListener('keydown', (event) => {
    if (!shown || !(event.key in steps) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    steps[event.key]();
  });
  canvas.addEventListener('pointermove', point);
  canvas.addEventListener('pointerdown', point);
  slider.addEventListener('input', showFrame);
  part('before').addEventListener('click', () => step(-1));
  part('after').addEventListener('click', () => step(1));
  for (const control of root.querySelectorAll('input[data-choice], select, input[type="checkbox"]')) {
    control.addEventListener('change', showFrame);
  }
  setInterval(() => {
    if (!shown || chosen('show') !== 'blink' || still.matches || document.hidden) return;
    second = !second;
    draw();
  }, kBlinkMs);
  root.closest('details').hidden = false;
  showFrame();
}

for (const root of document.querySelectorAll('.viewer')) startViewer(root);
