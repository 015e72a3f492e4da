// The panel of the fit: starts it from the values of the controls, shows its progress, and hands over its
// result.
import {ask} from './server.js';
import {make, short} from './controls.js';

const kPollMs = 400;

export class Fit {
  // `options`: those of the session; `stateOf()`: state to start from; `found(parameters)`: takes the fitted
  // values; `complain(sentence)`: shows an error.
  constructor(root, options, stateOf, found, complain) {
    this.part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.stateOf = stateOf;
    this.found = found;
    this.complain = complain;
    this.root = root;
    this.inputs = options.map((option) => this.addOption(option));
    this.part('start').addEventListener('click', () => this.start());
    this.part('stop').addEventListener('click', () => this.stop());
  }

  // Adds the row of an option. Returns its name and a function that reads its value.
  addOption({name, help, min, max, default: value}) {
    const id = `fit-${name}`;
    const list = Array.isArray(value);
    const input = list ? make('input', {id, type: 'text', placeholder: 'material.wall.*, ...', autocomplete: 'off',
                                        spellcheck: 'false', title: help})
                       : make('input', {id, type: 'number', min: String(min), max: String(max), value: String(value),
                                        title: help});
    const words = name.replaceAll('_', ' ');
    this.part('options').append(
        make('div', {class: 'row plain'}, make('label', {for: id}, words[0].toUpperCase() + words.slice(1)), input));
    const names = () => input.value.split(',').map((item) => item.trim()).filter(Boolean);
    return {name, value: list ? names : () => Number(input.value)};
  }

  async start() {
    this.complain('');
    const request = {state: this.stateOf()};
    for (const {name, value} of this.inputs) request[name] = value();
    const answer = await ask('/api/fit/start', request);
    if (answer.status !== 200) {
      this.complain(answer.json.error);
      return;
    }
    this.part('result').replaceChildren();
    this.show(answer.json);
    this.follow();
  }

  async stop() {
    const answer = await ask('/api/fit/stop', {});
    if (answer.status === 200) this.show(answer.json);
  }

  // Also after the page was loaded anew.
  async follow() {
    if (this.following) return;
    this.following = true;
    for (;;) {
      const answer = await ask('/api/fit');
      if (answer.status !== 200) break;
      this.show(answer.json);
      const {state} = answer.json;
      if (state !== 'running' && state !== 'stopping') {
        if (state === 'done' && this.started) this.finish(answer.json.result);
        break;
      }
      this.started = true;
      await new Promise((wake) => setTimeout(wake, kPollMs));
    }
    this.following = false;
    this.started = false;
  }

  show(status) {
    const running = status.state === 'running' || status.state === 'stopping';
    if (running) this.started = true;
    this.root.dataset.state = status.state;
    this.part('start').disabled = running;
    this.part('stop').disabled = status.state !== 'running';
    const words = {running: 'Running', stopping: 'Stopping', done: 'Done', stopped: 'Stopped', failed: 'Failed'};
    const tracing = running && status.frames_traced < status.frames;
    this.part('status').textContent = status.state === 'none' ? ''
        : `${words[status.state]}, ${status.elapsed_s.toFixed(1)} s${status.error ? `: ${status.error}` : ''}`;
    const bar = this.part('progress');
    bar.hidden = !running;
    if (tracing) {
      bar.max = status.frames;
      bar.value = status.frames_traced;
    } else {
      bar.removeAttribute('value');  // the number of iterations is not known beforehand
    }
    const doing = tracing ? `tracing frame ${status.frames_traced + 1} of ${status.frames}` : '';
    this.part('lines').textContent = [...status.lines.slice(-6), doing].filter(Boolean).join('\n');
  }

  finish(result) {
    this.found(result.parameters);
    const figure = (value) => (value === null ? 'none' : value.toFixed(3));
    const cells = (name, ...texts) =>
        make('tr', {}, make('th', {scope: 'row'}, name), ...texts.map((text) => make('td', {}, text)));
    const table = (names, rows) =>
        make('table', {}, make('thead', {}, make('tr', {}, ...names.map((name) => make('th', {scope: 'col'}, name)))),
             make('tbody', {}, ...rows));
    const values = result.fitted.map((p) => cells(p.name, short(p.initial, 4), short(p.value, 4),
                                                  p.sigma === null ? '\u2013' : short(p.sigma, 2),
                                                  p.status === 'free' ? '' : p.status.replace('_', ' ')));
    const {before, after, frames_held_out: heldOut} = result;
    const frames = result.judged_on_held_out ? `the held-out frames ${heldOut.join(', ')}`
                                             : 'the fitted frames, because no frame is held out';
    const figures = [['Expected image: IoU', 'iou'], ['intensity error', 'intensity_error'],
                     ['intensity error, whole image', 'intensity_error_whole']];
    this.part('result').replaceChildren(
        ...result.warnings.map((sentence) => make('p', {class: 'fault'}, `Warning: ${sentence}.`)),
        make('p', {}, `The sliders now show the fitted values. Undo restores the earlier ones. Evaluated on ${frames}:`),
        table(['', 'before', 'after'],
              figures.map(([label, name]) => cells(label, figure(before[name]), figure(after[name])))),
        make('details', {}, make('summary', {}, `${values.length} values`),
             make('div', {class: 'scroll', tabindex: '0'},
                  table(['parameter', 'before', 'fitted', 'standard error', ''], values))),
        ...(result.left_open.length > 0 ? [make('p', {}, 'Not identifiable:')] : []),
        ...result.left_open.map((sentence) => make('p', {class: 'soft'}, sentence)));
  }
}
