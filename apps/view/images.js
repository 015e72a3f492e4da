// The two pictures, fan and polar, of the simulated and the recorded image: one of them, both side by side or in
// turn, on top of each other, their difference or their object regions. Which sample a pixel shows, and where regions end, is
// known to frame_viewer.js, which draws the frames of reports by the same rules.
/* global polarLookup, fanLookup, edgesAt, drawRing, kBlinkMs, kDifferenceShown, keysOf */

import {drawAxes, drawBar} from './axes.js';
import {Zoom} from './zoom.js';

const kCaptions = {fan: 'Fan: ahead is up', polar: 'Polar: near is up'};
const kNotCompared = 'Regions appear once the image was compared with a recording.';

// Real image in blue plus simulated image in orange, of grey values 0 .. 255.
const overlaid = (real, simulated) => [simulated, (real + simulated) / 2, real];

// A colour as a picture holds it, its bytes from the lowest on.
const pack = (r, g, b) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;

export class Images {
  constructor(root, session) {
    this.session = session;
    this.simulated = null;
    this.recorded = null;
    this.real = session.recorded && session.recorded.synthetic ? 'synthetic' : 'recorded';  // as it is called
    this.keys = keysOf(this.real);
    this.regions = null;  // {values, bins, beams}
    this.second = false;  // of the two that blink
    this.cursor = -1;     // a sample
    this.still = window.matchMedia('(prefers-reduced-motion: reduce)');
    this.part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.root = root;
    this.views = ['fan', 'polar'].map((view) => {
      const canvas = this.part(`${view}-canvas`);
      const zoom = new Zoom(canvas.parentElement.parentElement, canvas.parentElement);
      const context = canvas.getContext('2d', {willReadFrequently: true});
      return {view, canvas, context, zoom, axes: this.part(`${view}-axes`), key: '', lookup: null};
    });
    this.colours = {...session.colours, grey: Array.from({length: 256}, (_, i) => [i, i, i])};
    for (const view of this.views) this.listen(view);
    for (const control of root.querySelectorAll('input[name="show"], select, input[type="checkbox"]')) {
      control.addEventListener('change', () => this.draw());
    }
    setInterval(() => {
      if (this.show !== 'blink' || this.still.matches || document.hidden || this.part('pause').checked) return;
      this.second = !this.second;
      this.draw();
    }, kBlinkMs);
  }

  get show() {
    return this.root.querySelector('input[name="show"]:checked').value;
  }

  set({simulated = this.simulated, recorded = this.recorded, regions = this.regions}) {
    this.simulated = simulated;
    this.recorded = recorded;
    this.regions = regions;
    this.draw();
  }

  // `kind`: fan or polar.
  lookupOf(view, kind, image) {
    const {axes, bins} = image;
    const key = `${kind} ${bins} ${axes.range_m} ${axes.azimuth_deg}`;
    if (view.key !== key) {
      view.lookup = (kind === 'fan' ? fanLookup : polarLookup)(axes, bins);
      view.key = key;
      view.zoom.reset();
      drawAxes(view.axes, axes, view.lookup);
      this.cursor = -1;
    }
    return view.lookup;
  }

  // What each sample looks like: red, green, blue and 255 in the bytes of one number.
  coloursOf(show) {
    const {simulated, recorded, regions} = this;
    const {alike, regions: regionColours} = this.session;
    const packAll = (colours) => new Uint32Array(colours.map(([r, g, b]) => pack(r, g, b)));
    const greyOf = (image) => {
      const factor = 255 / image.fullScale;
      return factor === 1 ? image.values : image.values.map((value) => Math.round(value * factor));
    };
    if (show === 'blink') show = this.second ? 'simulated' : 'real';
    const out = new Uint32Array(simulated.values.length);
    if (show === 'simulated' || show === 'real' || !recorded) {
      const image = show === 'real' && recorded ? recorded : simulated;
      const scale = packAll(this.colours[this.part('colours').value]);
      const grey = greyOf(image);
      const shown = new Uint32Array(grey.length);
      for (let i = 0; i < grey.length; ++i) shown[i] = scale[grey[i]];
      return shown;
    }
    if (show === 'regions') {
      const colours = packAll(regionColours);
      return out.map((_, i) => colours[regions ? regions.values[i] & 3 : 0]);
    }
    const real = greyOf(recorded);
    const made = greyOf(simulated);
    if (show === 'overlay') return out.map((_, i) => pack(...overlaid(real[i], made[i])));
    return out.map((_, i) => {
      const d = (made[i] - real[i]) / 255 / kDifferenceShown;
      const end = regionColours[d < 0 ? 1 : 2];
      const t = Math.min(1, Math.abs(d));
      return pack(...end.map((c) => Math.round(alike + t * (c - alike))));
    });
  }

  // Recorded and simulated have one shape, or only the simulated one is shown.
  get comparable() {
    const {recorded, simulated} = this;
    return Boolean(recorded) && recorded.bins === simulated.bins && recorded.beams === simulated.beams;
  }

  draw() {
    if (!this.simulated) return;
    const {show} = this;
    const alone = show !== 'simulated' && show !== 'real' && !this.comparable;
    const shown = show === 'real' && this.recorded ? this.recorded : this.simulated;
    const beside = show === 'both' && !alone;  // two fans
    const colours = this.coloursOf(alone || beside ? 'simulated' : show);
    const besideColours = beside ? this.coloursOf('real') : null;
    const [, realEdge, simulatedEdge] = this.session.regions.map((c) => pack(...c));
    const outlined = this.part('outline').checked && this.regions && this.comparable ? this.regions.values : null;
    for (const view of this.views) {
      const second = beside && view.view === 'polar';
      const lookup = this.lookupOf(view, second ? 'fan' : view.view, shown);
      view.axes.toggleAttribute('hidden', !this.part('axes').checked);
      let caption = kCaptions[view.view];
      if (beside) caption = second ? `Fan, ${this.real}` : 'Fan, simulated';
      this.part(`${view.view}-caption`).textContent = caption;
      const what = show === 'real' ? this.real : show;
      view.name = beside ? `${second ? this.real : 'simulated'}_fan` : `${what}_${view.view}`;
      const {width, height, index} = lookup;
      const {canvas, context} = view;
      if (canvas.width !== width || canvas.height !== height) {
        canvas.width = width;
        canvas.height = height;
      }
      const picture = context.createImageData(width, height);
      const pixels = new Uint32Array(picture.data.buffer);
      for (let i = 0; i < index.length; ++i) {
        const sample = index[i];
        if (sample < 0) continue;  // stays transparent
        pixels[i] = (second ? besideColours : colours)[sample];
        if (!outlined) continue;
        const edges = edgesAt(lookup, i, outlined);
        if (edges) pixels[i] = edges & 1 ? realEdge : simulatedEdge;
      }
      context.putImageData(picture, 0, 0);
      drawRing(context, lookup, this.cursor);
    }
    this.drawBar(alone ? 'simulated' : show, shown);
    let key = this.keys[show] || '';
    if (alone) key = `The simulated image alone: it has other bins or beams than the ${this.real} one.`;
    else if (show === 'regions' && !this.regions) key = kNotCompared;
    this.part('key').textContent = key;
    this.part('which').textContent = show !== 'blink' || alone ? '' : `The ${this.second ? 'simulated' : this.real} one.`;
    this.read();
  }

  drawBar(show, image) {
    const {alike, regions} = this.session;
    const bar = this.part('bar');
    const ends = [`${this.real} brighter`, 'simulated brighter'];
    const middle = [alike, alike, alike];
    bar.hidden = show === 'regions';
    if (show === 'overlay') drawBar(bar, [[255, 0], [128, 128], [0, 255]].map((pair) => overlaid(...pair)), ends, '');
    else if (show === 'difference') drawBar(bar, [regions[1], middle, regions[2]], ends, '');
    else drawBar(bar, this.colours[this.part('colours').value], ['0', String(image.fullScale)], 'grey level');
  }

  // The sample's colours for the fan in the 3D view: bins x beams, four bytes each, dark samples see-through.
  texture() {
    const {bins, beams, values, fullScale} = this.simulated;
    const scale = this.colours[this.part('colours').value];
    const seen = new Uint32Array(scale.map(([r, g, b], grey) =>
        ((pack(r, g, b) & 0xffffff) | ((40 + Math.round(215 * Math.sqrt(grey / 255))) << 24)) >>> 0));
    const colours = new Uint32Array(values.length);
    const factor = 255 / fullScale;
    for (let i = 0; i < values.length; ++i) colours[i] = seen[Math.round(values[i] * factor)];
    const bytes = new Uint8Array(colours.buffer);
    return {bytes, bins, beams};
  }

  read() {
    const {simulated, recorded, cursor} = this;
    const out = this.part('readout');
    const shown = this.show === 'real' && recorded ? recorded : simulated;
    if (cursor < 0 || cursor >= shown.values.length) {
      out.textContent = 'Point at a picture, or use the arrow keys in it, to read its values.';
      return;
    }
    const {beams, bins, axes} = shown;
    const bin = Math.floor(cursor / beams);
    const beam = cursor % beams;
    const [nearest, farthest] = axes.range_m;
    const number = (value, digits) => value.toFixed(digits).replace('-', '\u2212');
    const range = nearest + ((bin + 0.5) * (farthest - nearest)) / bins;
    let text = `${number(range, 3)} m, ${number(axes.azimuth_deg[beam], 2)}\u00b0 (bin ${bin}, beam ${beam}): `;
    if (this.comparable) {
      const difference = simulated.values[cursor] - recorded.values[cursor];
      text += `${this.real} ${recorded.values[cursor]}, simulated ${simulated.values[cursor]}, difference ` +
          number(difference, 0);
    } else {
      text += `${shown === simulated ? 'simulated' : this.real} ${shown.values[cursor]}`;
    }
    out.textContent = `${text} of ${shown.fullScale}`;
  }

  move(view, right, down) {
    const {beams, bins} = this.simulated;
    if (this.cursor < 0) this.cursor = Math.floor(bins / 2) * beams + Math.floor(beams / 2);
    const farther = view.key.startsWith('fan') ? -down : down;
    const bin = Math.min(bins - 1, Math.max(0, Math.floor(this.cursor / beams) + farther));
    const beam = Math.min(beams - 1, Math.max(0, (this.cursor % beams) + right));
    this.cursor = bin * beams + beam;
    this.draw();
  }

  listen(view) {
    const {canvas} = view;
    const point = (event) => {
      if (!view.lookup) return;
      const box = canvas.getBoundingClientRect();
      // The picture is as large as fits, in the middle of the canvas.
      const scale = Math.min(box.width / canvas.width, box.height / canvas.height);
      const x = Math.floor((event.clientX - (box.left + box.right) / 2) / scale + canvas.width / 2);
      const y = Math.floor((event.clientY - (box.top + box.bottom) / 2) / scale + canvas.height / 2);
      const inside = x >= 0 && y >= 0 && x < canvas.width && y < canvas.height;
      this.cursor = inside ? view.lookup.index[y * canvas.width + x] : -1;
      this.draw();
    };
    canvas.addEventListener('pointermove', point);
    canvas.addEventListener('pointerdown', point);
    canvas.addEventListener('pointerleave', () => {
      this.cursor = -1;
      this.draw();
    });
    const keys = {
      ArrowLeft: () => this.move(view, -1, 0),
      ArrowRight: () => this.move(view, 1, 0),
      ArrowUp: () => this.move(view, 0, -1),
      ArrowDown: () => this.move(view, 0, 1),
      ' ': () => {
        this.second = !this.second;
        this.draw();
      },
    };
    canvas.addEventListener('keydown', (event) => {
      if (!this.simulated || !(event.key in keys) || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      keys[event.key]();
    });
  }
}
