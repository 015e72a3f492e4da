// Plays frames one after the other, each as soon as the one before has been shown long enough, and records what a
// canvas shows meanwhile.

const kFrameMs = 400;     // that a frame is shown at least
const kVideoRate = 1000 / kFrameMs;
const kKinds = ['video/webm;codecs=vp9', 'video/webm', 'video/mp4'];

export class Player {
  // `isShown()`: whether the frame that was asked for is to be seen. `next()` goes on and returns false at the
  // last frame. `showState(playing, recording)`: called when either changes.
  constructor(isShown, next, showState) {
    this.isShown = isShown;
    this.next = next;
    this.showState = showState;
    this.timer = 0;
    this.recorder = null;
  }

  static get records() {
    return typeof MediaRecorder !== 'undefined' && kKinds.some((kind) => MediaRecorder.isTypeSupported(kind));
  }

  play() {
    if (this.timer) return;
    let since = performance.now();
    this.timer = setInterval(() => {
      if (!this.isShown()) since = performance.now();
      if (performance.now() - since < kFrameMs) return;
      since = performance.now();
      if (!this.next()) this.stop();
    }, kFrameMs / 8);
    this.tell();
  }

  // Calls save(blob, extension) once the frames have been played or stop() was called.
  record(canvas, save) {
    const kind = kKinds.find((each) => MediaRecorder.isTypeSupported(each));
    const parts = [];
    this.recorder = new MediaRecorder(canvas.captureStream(4 * kVideoRate), {mimeType: kind});
    this.recorder.ondataavailable = (event) => parts.push(event.data);
    this.recorder.onstop = () => save(new Blob(parts, {type: kind}), kind.includes('mp4') ? 'mp4' : 'webm');
    this.recorder.start();
    this.play();
  }

  stop() {
    clearInterval(this.timer);
    this.timer = 0;
    if (this.recorder) this.recorder.stop();
    this.recorder = null;
    this.tell();
  }

  tell() {
    this.showState(Boolean(this.timer), Boolean(this.recorder));
  }
}
