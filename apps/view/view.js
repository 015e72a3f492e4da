// The page of `sonarcal view`: what is to be seen is one plain object, `state` (apps/view/view_state.h); every
// control changes it, everything that is shown follows from it, and undo puts an earlier one back.
import {ask, greyOf, Latest} from './server.js';
import {Controls, make, short} from './controls.js';
import {Fit} from './fit.js';
import {Images} from './images.js';
import {Player} from './player.js';
import {kMaterialColours, World} from './scene.js';

const kMaxUndo = 200;
const kFollowMs = 1000;  // over which images are counted
const kCompareMs = 700;  // between two comparisons while a slider moves

const byId = (id) => document.getElementById(id);
const copy = (value) => JSON.parse(JSON.stringify(value));

// What the console and the tests may look at.
const view = {state: null, images: null, sequence: 0, shown: 0, compared: 0, figures: null};
window.view = view;

let session;
let start;        // the state at the start
let undone = [];
let done = [];    // earlier states, as text
let settled = ''; // the state when the hand last left a control
let controls;
let images;
let world = null;
let recordedFrame = -1;
let firstFigures = null;
let lastCompared = 0;
const client = Math.random().toString(36).slice(2);
const times = [];

function complain(sentence) {
  byId('fault').textContent = sentence;
  byId('fault').hidden = !sentence;
}

function poseOf(state) {
  return state.poses[state.frame] || session.frames[state.frame].pose;
}

// --- the state and its past

function change(set, isDone) {
  set(view.state);
  if (isDone) settle();
  follow();
}

function settle() {
  const now = JSON.stringify(view.state);
  if (now === settled) return;
  done.push(settled);
  if (done.length > kMaxUndo) done.shift();
  undone = [];
  settled = now;
  showPast();
}

function go(from, to) {
  settle();  // what is half done counts as a step
  if (!from.length) return;
  to.push(settled);
  settled = from.pop();
  view.state = JSON.parse(settled);
  showPast();
  follow();
}

const undo = () => go(done, undone);
const redo = () => {
  if (undone.length) go(undone, done);
};

function showPast() {
  byId('undo').disabled = !done.length;
  byId('redo').disabled = !undone.length;
}

// --- what follows from it

function follow() {
  const {state} = view;
  controls.show(state);
  byId('model').value = state.parameters.model;
  byId('noise').checked = state.noise;
  byId('seed').value = state.seed;
  byId('seed').disabled = !state.noise;
  showPose();
  showFrame();
  if (world) world.setPose(poseOf(state));
  drawing.want();
  showRecorded.want();
}

const drawing = new Latest(async () => {
  const sequence = ++view.sequence;
  const answer = await ask('/api/render', {...view.state, client, sequence});
  if (answer.status === 204) return;  // a newer one was asked for
  if (answer.status !== 200) {
    complain(answer.json.error);
    document.body.classList.add('stale');
    view.shown = view.compared = sequence;
    return;
  }
  document.body.classList.remove('stale');
  complain('');
  const simulated = greyOf(answer);
  images.set({simulated});
  view.images = images;
  if (world) {
    const elevation = view.state.sonar.elevation_beam_width_deg ?? session.sonar.elevation_beam_width_deg;
    world.setWedge(simulated.axes, elevation);
    world.setImage(images.texture());
    world.draw();
  }
  showRate(answer.json);
  view.shown = sequence;
  // A hand on a slider wants images first, and figures now and then.
  if (session.recorded && (!drawing.wanted || performance.now() - lastCompared > kCompareMs)) comparing.want();
});

function showRate({milliseconds, traced}) {
  const now = performance.now();
  times.push(now);
  while (times[0] < now - kFollowMs) times.shift();
  view.rate = times.length > 1 ? (1000 * (times.length - 1)) / (now - times[0]) : 0;
  byId('rate').textContent = `${milliseconds.toFixed(0)} ms${traced ? '' : ', no ray cast'}` +
      (times.length > 3 ? `; ${view.rate.toFixed(0)} images a second` : '');
}

const comparing = new Latest(async () => {
  const sequence = view.shown;
  lastCompared = performance.now();
  const answer = await ask('/api/compare', {...view.state, client, sequence});
  if (answer.status !== 200) {
    byId('compared').textContent = answer.json.error;
    images.set({regions: null});
  } else {
    view.figures = answer.json;
    firstFigures ??= answer.json;
    images.set({regions: {values: new Uint8Array(answer.data), bins: answer.json.bins, beams: answer.json.beams}});
    showFigures(answer.json);
  }
  view.compared = sequence;
});

function showFigures(figures) {
  const lines = [['Ns/Nr', (f) => f.ns_over_nr], ['Na/Ns', (f) => f.na_over_ns], ['Na/Nr', (f) => f.na_over_nr],
                 ['IoU', (f) => f.iou], ['Intensity error, polar', (f) => f.intensity_error.polar],
                 ['Intensity error, fan', (f) => f.intensity_error.fan],
                 ['Log-likelihood, nats per pixel', (f) => f.nats_per_pixel]];
  const text = (value) => (value === null ? 'none' : value.toFixed(3));
  byId('figures').replaceChildren(...lines.map(([label, of]) =>
      make('tr', {}, make('th', {scope: 'row'}, label), make('td', {class: 'now'}, text(of(figures))),
           make('td', {}, text(of(firstFigures))))));
  byId('compared').textContent =
      [`${view.state.noise ? 'Sample with noise' : 'Expected image'} against the ${images.real} frame.`,
       `Object by ${session.segmentation}${session.object ? ` in the box of '${session.object}'` : ''}:`,
       `${figures.ns} pixels simulated, ${figures.nr} ${images.real}.`,
       ...figures.notes].join(' ');
}

const showRecorded = new Latest(async () => {
  const {frame} = view.state;
  if (!session.recorded || frame === recordedFrame) return;
  const answer = await ask('/api/recorded', {frame});
  if (answer.status !== 200) {
    complain(answer.json.error);
    return;
  }
  recordedFrame = frame;
  images.set({recorded: greyOf(answer), regions: null});
});

// --- pose and frames

const kPose = [['x', 'X', 'm'], ['y', 'Y', 'm'], ['z', 'Z (up)', 'm'], ['yaw', 'Heading (left +)', '\u00b0'],
               ['pitch', 'Pitch (up +)', '\u00b0'], ['roll', 'Roll (right side down +)', '\u00b0']];
const kAngles = {yaw: 'yaw_deg', pitch: 'pitch_deg', roll: 'roll_deg'};
const kAxes = {x: 0, y: 1, z: 2};

function partOfPose(pose, key) {
  return key in kAngles ? pose[kAngles[key]] : pose.position_m[kAxes[key]];
}

function movePose(key, value, isDone) {
  change((state) => {
    const pose = copy(poseOf(state));
    if (key in kAngles) pose[kAngles[key]] = value;
    else pose.position_m[kAxes[key]] = value;
    state.poses[state.frame] = pose;
  }, isDone);
}

function buildPose() {
  for (const [key, label, unit] of kPose) {
    const limits = key === 'pitch' ? [-90, 90] : key in kAngles ? [-180, 180] : null;
    const number = make('input', {type: 'number', step: key in kAngles ? '0.5' : '0.05', id: `pose-${key}`});
    const slider = make('input', {type: 'range', step: 'any', 'aria-label': `${label}, slider`});
    const reach = world ? world.size / 2 : 5;
    const range = limits || [-reach, reach].map((by) => partOfPose(session.frames[0].pose, key) + by);
    [slider.min, slider.max] = range.map(String);
    const fixed = (value) => Number(value.toFixed(key in kAngles ? 2 : 3));
    slider.addEventListener('input', () => movePose(key, fixed(Number(slider.value)), false));
    slider.addEventListener('change', () => movePose(key, fixed(Number(slider.value)), true));
    number.addEventListener('change', () => {
      const value = Number(number.value);
      const [low, high] = limits || [-1e5, 1e5];
      if (number.value.trim() !== '' && value >= low && value <= high) movePose(key, value, true);
      else complain(`${label}: '${number.value}', expected a number from ${low} to ${high}.`);
    });
    byId('pose').append(make('div', {class: 'row'}, make('label', {for: number.id}, label), number,
                             make('span', {class: 'unit'}, unit), slider));
  }
}

function showPose() {
  const pose = poseOf(view.state);
  for (const [key] of kPose) {
    const number = byId(`pose-${key}`);
    const slider = number.parentElement.querySelector('input[type="range"]');
    const value = partOfPose(pose, key);
    if (document.activeElement !== number || Number(number.value) !== value) number.value = short(value, 6);
    slider.min = String(Math.min(Number(slider.min), value));
    slider.max = String(Math.max(Number(slider.max), value));
    slider.value = String(value);
  }
  const moved = view.state.frame in view.state.poses;
  byId('put-back').disabled = !moved;
  byId('moved').textContent = moved ? 'Moved by hand.' : session.poses_given ? 'As given.' : 'Put before the scene.';
}

function showFrame() {
  const {frame} = view.state;
  const {name, time_s: time} = session.frames[frame];
  byId('frame').value = String(frame);
  byId('frame').setAttribute('aria-valuetext', name);
  byId('frame-name').textContent =
      `${name} (${frame + 1} of ${session.frames.length})${time === undefined ? '' : `, ${time.toFixed(2)} s`}`;
}

function goToFrame(frame, isDone) {
  const last = session.frames.length - 1;
  change((state) => { state.frame = Math.min(last, Math.max(0, frame)); }, isDone);
}

// --- files

function download(name, blob) {
  const address = URL.createObjectURL(blob);
  const link = make('a', {href: address, download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

async function save(write) {
  const answer = await ask(write ? '/api/save' : '/api/files', view.state);
  if (answer.status !== 200) {
    complain(answer.json.error);
    return;
  }
  const {files, command, folder} = answer.json;
  if (!write) {
    for (const [name, text] of Object.entries(files)) download(name, new Blob([text], {type: 'application/json'}));
  }
  const names = write ? files : Object.keys(files);
  byId('saved').textContent = `${write ? `Written into ${folder}` : 'Downloaded'}: ${names.join(', ')}.`;
  byId('command').textContent = command;
  byId('command').hidden = false;
}

// Name of a file that holds what a picture shows.
function nameOf(picture, extension) {
  return `${picture.name}_${String(view.state.frame).padStart(4, '0')}.${extension}`;
}

function savePictures() {
  for (const picture of images.views) {
    picture.canvas.toBlob((blob) => download(nameOf(picture, 'png'), blob), 'image/png');
  }
}

function listenToPlayer() {
  const player = new Player(
      () => view.shown === view.sequence && !drawing.wanted,
      () => {
        const {frame} = view.state;
        if (frame + 1 < session.frames.length) goToFrame(frame + 1, false);
        return frame + 1 < session.frames.length;
      },
      (playing, recording) => {
        byId('play').textContent = playing ? 'Pause' : 'Play';
        byId('play').setAttribute('aria-pressed', String(playing));
        byId('video').setAttribute('aria-pressed', String(recording));
        if (!playing) settle();
      });
  view.player = player;
  const [fan] = images.views;
  byId('play').addEventListener('click', () => {
    if (player.timer) {
      player.stop();
      return;
    }
    if (view.state.frame + 1 === session.frames.length) goToFrame(0, true);
    player.play();
  });
  byId('video').hidden = !Player.records;
  byId('video').addEventListener('click', () => {
    if (player.recorder) player.stop();
    else player.record(fan.canvas, (blob, extension) => download(nameOf(fan, extension), blob));
  });
}

// --- the start

function listen() {
  byId('search').addEventListener('input', (event) => {
    byId('nothing').hidden = controls.search(event.target.value, view.state);
  });
  byId('picture').addEventListener('click', savePictures);
  listenToPlayer();
  byId('undo').addEventListener('click', undo);
  byId('redo').addEventListener('click', redo);
  byId('reset').addEventListener('click', () => {
    change(() => { view.state = {...copy(start), frame: view.state.frame}; }, true);
  });
  byId('model').addEventListener('change', (event) => {
    change((state) => { state.parameters.model = event.target.value; }, true);
  });
  byId('noise').addEventListener('change', (event) => {
    change((state) => { state.noise = event.target.checked; }, true);
  });
  byId('seed').addEventListener('change', (event) => {
    const seed = Number(event.target.value);
    if (Number.isInteger(seed) && seed >= 0 && seed < 2 ** 31) change((state) => { state.seed = seed; }, true);
    else complain(`Seed '${event.target.value}', expected a whole number from 0 to ${2 ** 31 - 1}.`);
  });
  byId('frame').addEventListener('input', (event) => goToFrame(Number(event.target.value), false));
  byId('frame').addEventListener('change', (event) => goToFrame(Number(event.target.value), true));
  byId('before').addEventListener('click', () => goToFrame(view.state.frame - 1, true));
  byId('after').addEventListener('click', () => goToFrame(view.state.frame + 1, true));
  byId('put-back').addEventListener('click', () => change((state) => { delete state.poses[state.frame]; }, true));
  byId('download').addEventListener('click', () => save(false));
  byId('write').addEventListener('click', () => save(true));
  document.addEventListener('keydown', (event) => {
    const typing = event.target.matches('input[type="number"], input[type="search"], textarea');
    const key = event.key.toLowerCase();
    if ((event.ctrlKey || event.metaKey) && !event.altKey && (key === 'z' || key === 'y')) {
      event.preventDefault();
      if (typing) event.target.blur();
      if (key === 'y' || event.shiftKey) redo();
      else undo();
    } else if (!typing && !event.ctrlKey && !event.altKey && (event.key === 'PageUp' || event.key === 'PageDown')) {
      event.preventDefault();
      goToFrame(view.state.frame + (event.key === 'PageUp' ? -1 : 1), true);
    }
  });
}

async function startWorld() {
  try {
    world = new World(byId('world'));
  } catch {
    byId('no-world').hidden = false;
    return;
  }
  view.world = world;
  const answer = await ask('/api/scene');
  if (answer.status !== 200) {
    complain(answer.json.error);
    return;
  }
  world.setMesh(answer);
  const {triangles, triangles_in_scene: all} = answer.json;
  if (triangles < all) byId('mesh-note').textContent = `${triangles} of the scene's ${all} triangles are drawn here.`;
  for (const button of document.querySelectorAll('[data-look]')) {
    button.addEventListener('click', () => world.look(button.dataset.look));
  }
  byId('show-sheet').addEventListener('change', (event) => world.setImageShown(event.target.checked));
  byId('both-sides').addEventListener('change', (event) => world.setBothSides(event.target.checked));
}

function describe() {
  const {recorded} = session;
  const tail = (path) => path.split('/').pop();
  byId('what').textContent = `${session.sonar.name} in ${tail(session.scene)}`;
  byId('what').title = session.scene;
  document.title = `${tail(session.scene)} \u2013 sonarcal view`;
  const real = recorded && recorded.synthetic ? 'Synthetic' : 'Recorded';
  byId('recorded').textContent = recorded ? `${real}: ${tail(recorded.name)}` : 'No recording beside it';
  document.querySelector('[data-part="real"]').textContent = real;
  byId('recorded').title = recorded ? recorded.name : '';
  byId('recorded').classList.toggle('synthetic', Boolean(recorded && recorded.synthetic));
  document.body.classList.toggle('alone', !recorded);
  byId('frame').max = String(session.frames.length - 1);
  byId('frames').hidden = session.frames.length < 2;
  byId('write').hidden = !session.out;
  if (session.out) byId('write').textContent = `Write into ${tail(session.out)}/`;
  byId('version').textContent = session.version;
  for (const swatch of document.querySelectorAll('.swatch[data-material]')) {
    const index = session.material_names.indexOf(swatch.dataset.material);
    if (index >= 0) swatch.style.setProperty('--colour', kMaterialColours[index % kMaterialColours.length]);
  }
}

async function begin() {
  const answer = await ask('/api/session');
  if (answer.status !== 200) {
    complain(answer.status === 403 ? 'Open the whole address that sonarcal view printed, with what stands behind #.'
                                   : answer.json.error);
    return;
  }
  session = answer.json;
  start = {parameters: session.parameters, sonar: {}, frame: 0, poses: {}, noise: false, seed: 1};
  view.state = copy(start);
  view.session = session;
  settled = JSON.stringify(view.state);
  images = new Images(byId('pictures'), session);
  byId('pictures').addEventListener('change', () => {
    if (!world || !images.simulated) return;
    world.setImage(images.texture());
    world.draw();
  });
  controls = new Controls(byId('groups'), session, change);
  describe();
  await startWorld();
  buildPose();
  listen();
  follow();
  if (world) world.look('outside');
  if (session.recorded) {
    const take = (parameters) => change((state) => { state.parameters = parameters; }, true);
    const fit = new Fit(byId('fit'), session.fit_options, () => view.state, take, complain);
    fit.follow();
  }
  document.body.dataset.ready = 'yes';
}

begin();
