// The panel of the fit: starts it from where the controls stand, shows how far it is, and hands over what it
// found.
import {ask} from './server.js';
import {make, short} from './controls.js';

const kPollMs = 400;

export class Fit {
  // `stateOf`: what to start from; `found(parameters)`: what to do with the values found; `complain(sentence)`.
  constructor(root, stateOf, found, complain) {
    this.part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.stateOf = stateOf;
    this.found = found;
    this.complain = complain;
    this.root = root;
    this.part('start').addEventListener('click', () => this.start());
    this.part('stop').addEventListener('click', () => this.stop());
  }

  async start() {
    this.complain('');
    const hold = this.part('hold').value.split(',').map((name) => name.trim()).filter(Boolean);
    const answer = await ask('/api/fit/start', {
      state: this.stateOf(),
      hold,
      starts: Number(this.part('starts').value),
      max_iterations: Number(this.part('iterations').value),
    });
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
      bar.removeAttribute('value');  // how many steps a solver takes nobody knows
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
    const judged = result.judged_on_held_out ? `frames ${heldOut.join(', ')}, which the fit did not see`
                                             : 'the frames it was fitted to, as none is held out';
    const figures = [['Expected image: IoU', 'iou'], ['intensity error', 'intensity_error'],
                     ['intensity error, whole image', 'intensity_error_whole']];
    this.part('result').replaceChildren(
        ...result.warnings.map((sentence) => make('p', {class: 'fault'}, `Warning: ${sentence}.`)),
        make('p', {}, `Its values are in the sliders now; Undo puts the earlier ones back. Judged on ${judged}:`),
        table(['', 'before', 'after'],
              figures.map(([label, name]) => cells(label, figure(before[name]), figure(after[name])))),
        make('details', {}, make('summary', {}, `${values.length} values`),
             make('div', {class: 'scroll', tabindex: '0'},
                  table(['parameter', 'before', 'fitted', 'sigma', ''], values))),
        ...(result.left_open.length > 0 ? [make('p', {}, 'Not identifiable:')] : []),
        ...result.left_open.map((sentence) => make('p', {class: 'soft'}, sentence)));
  }
}
