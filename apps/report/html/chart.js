// Charts of a report (line_chart.h): values under the pointer, and zoom into a range of the horizontal axis. Without
// this script a chart is the same drawing, to look at.

/* global ticksWithin */

const kShortestDrag = 0.02;  // of the width of a plot: a click is no zoom

function startChart(figure) {
  const data = JSON.parse(figure.dataset.chart);
  const [left, top, width, height] = data.box;
  const svg = figure.querySelector('.plot');
  const inner = svg.querySelector('svg');
  const ticks = svg.querySelector('.ticks');
  const points = [...svg.querySelectorAll('.point')].map(
      (circle) => ({circle, x: circle.cx.baseVal.value - left, y: circle.cy.baseVal.value - top}));
  const whole = {x: [data.x.min, data.x.max], y: [data.y.min, data.y.max]};
  let view = whole;
  let cursor = null;  // a value of x
  let dragged = null;  // where a drag began

  const addShape = (name, attributes) => {
    const shape = document.createElementNS(svg.namespaceURI, name);
    for (const [key, value] of Object.entries({...attributes, visibility: 'hidden'})) shape.setAttribute(key, value);
    return svg.appendChild(shape);
  };
  const line = addShape('line', {class: 'cursor', y1: top, y2: top + height});
  const selection = addShape('rect', {class: 'selection', y: top, height});
  const readout = figure.appendChild(document.createElement('output'));

  const part = (value, [min, max]) => (value - min) / (max - min);
  const plotX = (x) => left + width * part(x, view.x);

  function draw() {
    const scale = {x: width / (whole.x[1] - whole.x[0]), y: height / (whole.y[1] - whole.y[0])};
    const box = {
      x: (view.x[0] - whole.x[0]) * scale.x, y: (whole.y[1] - view.y[1]) * scale.y,
      width: (view.x[1] - view.x[0]) * scale.x, height: (view.y[1] - view.y[0]) * scale.y};
    inner.setAttribute('viewBox', `${box.x} ${box.y} ${box.width} ${box.height}`);
    inner.setAttribute('preserveAspectRatio', 'none');
    for (const {circle, x, y} of points) {
      const at = {x: (x - box.x) / box.width, y: (y - box.y) / box.height};
      circle.setAttribute('cx', left + width * at.x);
      circle.setAttribute('cy', top + height * at.y);
      circle.toggleAttribute('hidden', at.x < 0 || at.x > 1 || at.y < 0 || at.y > 1);
    }
    const base = top + height;
    ticks.innerHTML = ticksWithin(view.y, 5).map(({value, text}) => {
      const y = base - height * part(value, view.y);
      return `<line class="grid" x1="${left}" y1="${y}" x2="${left + width}" y2="${y}"/>` +
          `<text class="tick" x="${left - 7}" y="${y}" text-anchor="end" dy="0.35em">${text}</text>`;
    }).join('') + ticksWithin(view.x, 6).map(({value, text}) => {
      const x = plotX(value);
      return `<line class="mark" x1="${x}" y1="${base}" x2="${x}" y2="${base + 5}"/>` +
          `<text class="tick" x="${x}" y="${base + 19}" text-anchor="middle">${text}</text>`;
    }).join('');
  }

  // The value nearest to the cursor, of those in view.
  function nearest(series) {
    let best = -1;
    series.x.forEach((x, i) => {
      if (series.y[i] === null || x < view.x[0] || x > view.x[1]) return;
      if (best < 0 || Math.abs(x - cursor) < Math.abs(series.x[best] - cursor)) best = i;
    });
    return best;
  }

  function read() {
    line.setAttribute('visibility', cursor === null ? 'hidden' : 'visible');
    if (cursor === null) {
      readout.textContent = view === whole ? 'Point to read values. Drag to zoom.' : 'Double-click to see all.';
      return;
    }
    const number = (value) => String(Number(value.toPrecision(4))).replace('-', '\u2212');
    const values = [];
    let x = cursor;
    for (const series of data.series) {
      const i = nearest(series);
      if (i < 0) continue;
      x = series.x[i];
      const band = series.band?.[i];
      values.push(`${series.name} ${number(series.y[i])}${band ? ` (${band.map(number).join(' to ')})` : ''}`);
    }
    line.setAttribute('x1', plotX(x));
    line.setAttribute('x2', plotX(x));
    readout.textContent = `${data.x.text} ${number(x)}: ${values.join(', ')}`;
  }

  // Zooms to a range of x, and to the values within.
  function zoom(x) {
    const heights = data.series.flatMap((series) => series.x.flatMap((at, i) =>
        at < x[0] || at > x[1] || series.y[i] === null ? [] : [series.y[i], ...(series.band?.[i] ?? [])]));
    if (heights.length < 2) return;
    const [min, max] = [Math.min(...heights), Math.max(...heights)];
    const margin = 0.06 * (max - min || 1);
    view = {x, y: [min - margin, max + margin]};
    draw();
  }

  function reset() {
    view = whole;
    draw();
    read();
  }

  // Value of x under the pointer, within the plot.
  function under(event) {
    const box = svg.getBoundingClientRect();
    const x = ((event.clientX - box.left) * svg.viewBox.baseVal.width) / box.width;
    return view.x[0] + Math.min(1, Math.max(0, (x - left) / width)) * (view.x[1] - view.x[0]);
  }

  svg.addEventListener('pointerdown', (event) => {
    dragged = under(event);
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener('pointermove', (event) => {
    cursor = under(event);
    read();
    if (dragged === null) return;
    const [from, to] = [dragged, cursor].map(plotX).sort((a, b) => a - b);
    selection.setAttribute('visibility', 'visible');
    selection.setAttribute('x', from);
    selection.setAttribute('width', to - from);
  });
  svg.addEventListener('pointerup', (event) => {
    const range = [dragged ?? under(event), under(event)].sort((a, b) => a - b);
    if (range[1] - range[0] > kShortestDrag * (view.x[1] - view.x[0])) zoom(range);
    dragged = null;
    selection.setAttribute('visibility', 'hidden');
    read();
  });
  for (const end of ['pointerleave', 'pointercancel']) {
    svg.addEventListener(end, () => {
      dragged = null;
      cursor = null;
      selection.setAttribute('visibility', 'hidden');
      read();
    });
  }
  svg.addEventListener('dblclick', reset);
  const keys = {
    ArrowLeft: () => { cursor = Math.max(view.x[0], cursor - 0.02 * (view.x[1] - view.x[0])); },
    ArrowRight: () => { cursor = Math.min(view.x[1], cursor + 0.02 * (view.x[1] - view.x[0])); },
    '+': () => zoom([-0.25, 0.25].map((by) => Math.min(whole.x[1], Math.max(whole.x[0],
        cursor + by * (view.x[1] - view.x[0]))))),
    Escape: reset,
  };
  svg.addEventListener('keydown', (event) => {
    if (!(event.key in keys) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    cursor ??= 0.5 * (view.x[0] + view.x[1]);
    keys[event.key]();
    read();
  });
  svg.setAttribute('tabindex', '0');
  read();
}

for (const figure of document.querySelectorAll('[data-chart]')) startChart(figure);
