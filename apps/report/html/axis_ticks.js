// Round numbers for the marks of an axis, as in axis_ticks.h, for charts of a report and the view.

function niceStep(span, count) {
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5].map((factor) => factor * power).find((step) => step >= rough * (1 - 1e-9)) ?? 10 * power;
}

function ticksWithin([min, max], count) {
  const step = niceStep(max - min, count);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let i = Math.ceil(min / step - 1e-9); i <= max / step + 1e-9; ++i) {
    ticks.push({value: i * step, text: (i * step + 0).toFixed(decimals).replace('-', '\u2212')});
  }
  return ticks;
}
