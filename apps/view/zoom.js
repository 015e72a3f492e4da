// Zooms into a picture: the wheel about the pointer, dragging with the button held, a double click to see all.

const kMaxZoom = 16;

export class Zoom {
  constructor(frame, inner) {
    this.frame = frame;
    this.inner = inner;
    this.reset();
    frame.addEventListener('wheel', (event) => {
      event.preventDefault();
      const box = frame.getBoundingClientRect();
      this.by(Math.exp(-0.002 * event.deltaY), event.clientX - box.left, event.clientY - box.top);
    }, {passive: false});
    frame.addEventListener('dblclick', () => this.reset());
    frame.addEventListener('pointermove', (event) => {
      if (!(event.buttons & 1) || this.scale === 1) return;
      this.move(this.x + event.movementX, this.y + event.movementY);
    });
  }

  by(factor, x, y) {
    const scale = Math.min(kMaxZoom, Math.max(1, this.scale * factor));
    const growth = scale / this.scale;
    this.scale = scale;
    this.move(x - growth * (x - this.x), y - growth * (y - this.y));
  }

  // Keeps the frame filled.
  move(x, y) {
    const {clientWidth: width, clientHeight: height} = this.frame;
    this.x = Math.min(0, Math.max(width * (1 - this.scale), x));
    this.y = Math.min(0, Math.max(height * (1 - this.scale), y));
    this.show();
  }

  reset() {
    [this.scale, this.x, this.y] = [1, 0, 0];
    this.show();
  }

  show() {
    this.inner.style.transform = this.scale === 1 ? '' : `translate(${this.x}px, ${this.y}px) scale(${this.scale})`;
  }
}
