// One row for each parameter: a slider, a number to type, the unit; words get a list to choose from. Rows show
// what the state holds and say what they were moved to; they keep nothing themselves.

const kSteps = 1000;  // of a slider
const kDigits = 4;    // that a slider gives

export function valueAt(state, path) {
  let node = state;
  for (const key of path) {
    if (node === null || typeof node !== 'object' || !(key in node)) return undefined;
    node = node[key];
  }
  return node;
}

function setValueAt(state, path, value) {
  let node = state;
  for (const key of path.slice(0, -1)) {
    if (!(key in node)) node[key] = {};
    node = node[key];
  }
  const last = path[path.length - 1];
  if (value !== undefined) {
    node[last] = value;
    return;
  }
  delete node[last];
  // A mirror without its loss is none.
  if (path[1] === 'mirror') delete state.parameters.mirror[path[2]];
}

export function short(value, digits = 6) {
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  return size > 0 && (size < 1e-3 || size >= 1e6) ? rounded.toExponential().replace('+', '') : String(rounded);
}

const make = (tag, attributes = {}, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name in element && typeof value !== 'string') element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
};
export {make};

const units = {deg: '\u00b0', C: '\u00b0C', '1': ''};
const unitText = (unit) => (unit in units ? units[unit] : unit);
const unitWord = (unit) => unitText(unit).replace(/ re .*/, '');  // the bounds say it whole

// A slider's place of a value and back.
class Scale {
  constructor(control) {
    [this.low, this.high] = control.slider;
    this.logarithmic = control.logarithmic && this.low > 0;
    this.whole = control.whole;
  }

  reach(value) {
    if (this.logarithmic && !(value > 0)) return;
    this.low = Math.min(this.low, value);
    this.high = Math.max(this.high, value);
  }

  place(value) {
    const {low, high} = this;
    const share = this.logarithmic ? Math.log(Math.max(value, low) / low) / Math.log(high / low)
                                   : (value - low) / (high - low);
    return Math.round(kSteps * Math.min(1, Math.max(0, share)));
  }

  value(place) {
    if (place <= 0) return this.low;
    if (place >= kSteps) return this.high;
    const share = place / kSteps;
    const span = this.high - this.low;
    const value = this.logarithmic ? this.low * Math.exp(share * Math.log(this.high / this.low))
                                   : this.low + share * span;
    // As many digits as tell one place from the next, so that what is shown is what is meant.
    const before = Math.ceil(Math.log10(Math.max(Math.abs(value), 1e-12) / span));
    const digits = this.logarithmic ? kDigits : Math.max(kDigits, before + kDigits);
    return this.whole ? Math.round(value) : Number(value.toPrecision(Math.min(15, digits)));
  }
}

class Row {
  // `moved(set, done)`: a change of the state, and whether the hand has left the control.
  constructor(control, id, start, moved) {
    this.control = control;
    this.start = start;  // the value where the state has none of its own (sonar)
    this.moved = moved;
    this.scale = control.words ? null : new Scale(control);
    this.build(id);
  }

  build(id) {
    const {control} = this;
    this.number = control.words
        ? make('select', {id}, ...control.words.map((word) => make('option', {value: word}, word)))
        : make('input', {id, type: 'number', step: 'any', inputmode: 'decimal', autocomplete: 'off'});
    const unit = unitText(control.unit);
    const label = make('label', {for: id}, control.label);
    this.element = make('div', {class: control.words ? 'row words' : 'row'}, label, this.number,
                        make('span', {class: 'unit'}, unitWord(control.unit)));
    this.element.dataset.name = control.name;
    if (control.model) this.element.dataset.model = control.model;
    this.fault = make('p', {class: 'fault', hidden: true, id: `${id}-fault`});
    if (control.words) {
      this.number.addEventListener('change', () => this.set(this.number.value, true));
    } else {
      const zero = control.zero ? `; 0: ${control.zero}` : '';
      const bounds = `${short(control.lower)} to ${short(control.upper)}${unit ? ` ${unit}` : ''}${zero}`;
      this.number.title = `Bounds: ${bounds}`;
      this.bounds = make('p', {class: 'bounds'}, bounds);
      this.slider = make('input', {type: 'range', min: '0', max: String(kSteps), step: '1',
                                   'aria-label': `${control.label}, slider`});
      this.slider.addEventListener('input', () => this.set(this.scale.value(Number(this.slider.value)), false));
      this.slider.addEventListener('change', () => this.set(this.scale.value(Number(this.slider.value)), true));
      this.number.addEventListener('change', () => this.type(true));
      this.number.addEventListener('input', () => this.type(false));
      this.number.addEventListener('keydown', (event) => this.step(event));
      if (control.absent !== undefined) this.addSwitch(id);
      this.element.append(this.slider, this.bounds);
    }
    this.element.append(this.fault);
    if (control.fixed_because) {
      for (const input of [this.number, this.slider]) if (input) input.disabled = true;
      this.element.append(make('p', {class: 'why'}, control.fixed_because));
    }
  }

  addSwitch(id) {
    const {label, absent} = this.control;
    this.switch = make('input', {type: 'checkbox', id: `${id}-on`, 'aria-label': `${label}: present`});
    this.switch.addEventListener('change', () => this.set(this.switch.checked ? absent : undefined, true));
    this.element.prepend(this.switch);
    this.element.classList.add('switched');
  }

  set(value, done) {
    this.complain('');
    this.moved((state) => setValueAt(state, this.control.path, value), done);
  }

  complain(sentence) {
    this.fault.textContent = sentence;
    this.fault.hidden = !sentence;
    if (sentence) {
      this.number.setAttribute('aria-invalid', 'true');
      this.number.setAttribute('aria-describedby', this.fault.id);
    } else {
      this.number.removeAttribute('aria-invalid');
      this.number.removeAttribute('aria-describedby');
    }
  }

  // What is being typed counts as soon as it is a value.
  type(done) {
    const {lower, upper, zero, whole} = this.control;
    const text = this.number.value.trim();
    const value = Number(text);
    const accepted = text !== '' && Number.isFinite(value) &&
        ((value >= lower && value <= upper) || (value === 0 && zero)) && (!whole || Number.isInteger(value));
    if (!accepted) {
      if (done) {
        // What was taken of it on the way was not meant.
        if (this.before) this.set(this.before.value, true);
        this.before = null;
        const kind = whole ? 'a whole number' : 'a number';
        this.complain(`'${text}': expected ${kind} from ${short(lower)} to ${short(upper)}` +
                      `${zero ? `, or 0 (${zero})` : ''}.`);
      }
      return;
    }
    if (!done) this.before = this.before || {value: this.drawn.value};
    else this.before = null;
    this.typing = !done;
    this.set(value, done);
    this.typing = false;
  }

  step(event) {
    const by = {ArrowUp: 5, ArrowDown: -5}[event.key];
    if (!by) return;
    event.preventDefault();
    const value = this.control.whole ? Number(this.number.value) + Math.sign(by)
                                     : this.scale.value(this.scale.place(Number(this.number.value)) + by);
    this.number.value = short(value);
    this.type(true);
  }

  show(state) {
    const own = valueAt(state, this.control.path);
    const value = own === undefined || own === null ? this.start : own;
    if (this.drawn && this.drawn.value === value) return;
    this.drawn = {value};
    if (this.control.words) {
      this.number.value = value;
      return;
    }
    const there = value !== undefined;
    if (this.switch) {
      this.switch.checked = there;
      this.number.disabled = this.slider.disabled = !there;
    }
    if (!there) {
      this.number.value = '';
      return;
    }
    if (!(value === 0 && this.control.zero)) this.scale.reach(value);
    if (!this.typing) this.number.value = short(value);
    this.slider.value = String(this.scale.place(value));
    this.slider.setAttribute('aria-valuetext', `${short(value)} ${unitText(this.control.unit)}`);
    this.element.classList.toggle('off', value === 0 && Boolean(this.control.zero));
  }
}

// A to F in a picture, which opens larger in a tab of its own.
function curveLegend() {
  const picture = make('img', {src: '/gsab_curve.svg', loading: 'lazy',
                               alt: 'A curve of 10 log10 GSAB over the incidence angle, as the sum of three terms'});
  return make('details', {class: 'curve-legend'}, make('summary', {}, 'A to F in a picture'),
              make('a', {href: '/gsab_curve.svg', target: '_blank', title: 'Open the picture larger'}, picture));
}

// All rows, in groups that fold.
export class Controls {
  constructor(root, session, moved) {
    this.session = session;
    this.rows = [];
    this.parts = [];  // of materials: shown where the material has values of its own
    this.words = [];  // that a row must have to be shown
    const groups = new Map();
    session.controls.forEach((control, index) => {
      const start = control.path[0] === 'sonar' ? session.sonar[control.path[1]] : undefined;
      const row = new Row(control, `c${index}`, start, moved);
      this.rows.push(row);
      if (!groups.has(control.group)) groups.set(control.group, new Map());
      const parts = groups.get(control.group);
      if (!parts.has(control.part)) parts.set(control.part, []);
      parts.get(control.part).push(row);
    });
    for (const [group, parts] of groups) {
      const details = make('details', {class: 'group', open: ['Levels and display', 'Materials'].includes(group)},
                           make('summary', {}, group));
      details.dataset.group = group;
      if (group === 'Materials') details.append(curveLegend());
      for (const [part, rows] of parts) {
        if (!part) details.append(...rows.map((row) => row.element));
        else details.append(this.materialPart(part, rows, moved));
      }
      root.append(details);
    }
    this.groups = [...root.querySelectorAll('.group')];
  }

  materialPart(material, rows, moved) {
    const title = material === 'default' ? 'Every other material' : material;
    const swatch = make('span', {class: 'swatch'});
    swatch.dataset.material = material;
    const served = make('p', {class: 'served'}, 'As every other material. ');
    const own = make('button', {type: 'button'}, 'Give it values of its own');
    own.addEventListener('click', () => moved((state) => {
      const {materials} = state.parameters;
      materials[material] = JSON.parse(JSON.stringify(materials.default));
    }, true));
    served.append(own);
    const part = make('details', {class: 'part', open: this.parts.length === 0},
                      make('summary', {}, swatch, title), served, ...rows.map((row) => row.element));
    part.dataset.material = material;
    this.parts.push({material, part, served, rows});
    return part;
  }

  // Returns whether any row has all words of the text in its label, name, group or material. Folded groups
  // open while there are words.
  search(text, state) {
    const folds = [...this.groups, ...this.parts.map(({part}) => part)];
    if (!this.words.length) this.openBefore = folds.map((fold) => fold.open);
    this.words = text.toLowerCase().split(/\s+/).filter(Boolean);
    this.show(state);
    folds.forEach((fold, i) => { fold.open = this.words.length > 0 || this.openBefore[i]; });
    return this.groups.some((group) => !group.hidden);
  }

  isFound({control}) {
    const text = [control.label, control.name, control.group, control.part || ''].join(' ').toLowerCase();
    return this.words.every((word) => text.includes(word));
  }

  show(state) {
    const {model} = state.parameters;
    for (const row of this.rows) {
      row.element.hidden = (Boolean(row.control.model) && row.control.model !== model) || !this.isFound(row);
      row.show(state);
    }
    for (const {material, part, served, rows} of this.parts) {
      const there = material in state.parameters.materials;
      part.hidden = !rows.some((row) => !row.element.hidden);
      served.hidden = there;
      for (const row of rows) row.element.hidden = row.element.hidden || !there;
    }
    for (const group of this.groups) {
      group.hidden = ![...group.querySelectorAll('.row')].some((row) => !row.hidden);
    }
  }
}
