// The scene in 3D with the sonar in it: the mesh in the colours of its materials, what the sonar can see as a
// wedge, and the simulated fan laid where it was seen. World: metres, Z up; sonar: X right, Y ahead, Z up.

import * as THREE from './three.js';

// After Okabe and Ito, in an order that keeps neighbours apart; also the swatches of the parameters.
export const kMaterialColours = ['#b8b2a7', '#56b4e9', '#e69f00', '#009e73', '#cc79a7', '#d55e00', '#0072b2',
                                 '#f0e442'];
const kArcSteps = 24;
const kRadians = Math.PI / 180;

export function worldFromSonar(pose) {
  // Yaw about Z, pitch about the new X, roll about the new Y, as in core/types/pose.h.
  const turn = new THREE.Euler(pose.pitch_deg * kRadians, pose.roll_deg * kRadians, pose.yaw_deg * kRadians, 'ZXY');
  return new THREE.Matrix4().compose(new THREE.Vector3(...pose.position_m), new THREE.Quaternion().setFromEuler(turn),
                                     new THREE.Vector3(1, 1, 1));
}

function outerEdges(azimuths) {
  const n = azimuths.length;
  if (n < 2) return [azimuths[0] - 0.5, azimuths[0] + 0.5];
  return [azimuths[0] - (azimuths[1] - azimuths[0]) / 2, azimuths[n - 1] + (azimuths[n - 1] - azimuths[n - 2]) / 2];
}

function direction(azimuthDeg, elevationDeg, range) {
  const a = azimuthDeg * kRadians;
  const e = elevationDeg * kRadians;
  return [range * Math.cos(e) * Math.sin(a), range * Math.cos(e) * Math.cos(a), range * Math.sin(e)];
}

function geometryOf(positions, attributes = {}) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
  for (const [name, {values, size}] of Object.entries(attributes)) {
    geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(values), size));
  }
  return geometry;
}

export class World {
  // Throws where the browser has no WebGL.
  constructor(host) {
    this.host = host;
    this.renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: false});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'The scene in 3D: drag or Shift and arrow keys turn, wheel or + and - come ' +
                                      'nearer, right drag or arrow keys shift');
    host.prepend(canvas);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.02, 2000);
    this.camera.up.set(0, 0, 1);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x7788a0, 2.4));
    const lamp = new THREE.DirectionalLight(0xffffff, 1.7);
    lamp.position.set(-0.4, 0.5, 1);
    lamp.target.position.set(0, 0, -1);
    this.camera.add(lamp, lamp.target);
    this.scene.add(this.camera);
    this.orbit = new THREE.OrbitControls(this.camera, canvas);
    this.orbit.keyRotateSpeed = 10;  // some 6 degrees per key press in a view of 600 pixels
    this.orbit.addEventListener('change', () => this.draw());
    this.orbit.addEventListener('start', () => { this.place = ''; });  // the hand has it now
    this.orbit.listenToKeyEvents(canvas);
    canvas.addEventListener('keydown', (event) => this.comeNearer(event));
    this.sonar = new THREE.Group();
    this.sonar.matrixAutoUpdate = false;
    this.scene.add(this.sonar);
    this.addBody();
    this.centre = new THREE.Vector3();
    this.size = 10;
    new ResizeObserver(() => this.resize()).observe(host);
  }

  // By + and -. OrbitControls shifts by the arrow keys, and turns by them with Shift.
  comeNearer(event) {
    const factor = {'+': 0.9, '-': 1 / 0.9}[event.key];
    if (!factor) return;
    event.preventDefault();
    event.stopPropagation();
    this.camera.position.sub(this.orbit.target).multiplyScalar(factor).add(this.orbit.target);
    this.orbit.update();
    this.draw();
  }

  addBody() {
    const body = new THREE.Mesh(new THREE.BoxGeometry(0.22, 0.3, 0.16),
                                new THREE.MeshLambertMaterial({color: 0xd55e00}));
    body.position.set(0, -0.15, 0);
    this.sonar.add(body);
  }

  // A framed answer of /api/scene.
  setMesh({json, data}) {
    const floats = new Float32Array(data, 0, 3 * json.vertices);
    const indices = new Uint32Array(data, 12 * json.vertices, 3 * json.triangles);
    const materials = new Uint16Array(data, 12 * json.vertices + 12 * json.triangles, json.triangles);
    const position = new THREE.BufferAttribute(floats, 3);
    this.meshes = json.material_names.map((name, material) => {
      const own = [];
      for (let i = 0; i < materials.length; ++i) {
        if (materials[i] === material) own.push(indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]);
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', position);
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(own), 1));
      const colour = kMaterialColours[material % kMaterialColours.length];
      const look = new THREE.MeshPhongMaterial({color: colour, flatShading: true, shininess: 8});
      const mesh = new THREE.Mesh(geometry, look);
      this.scene.add(mesh);
      return mesh;
    });
    if (json.lowest_m) {
      const low = new THREE.Vector3(...json.lowest_m);
      const high = new THREE.Vector3(...json.highest_m);
      this.centre = low.clone().add(high).multiplyScalar(0.5);
      this.size = Math.max(1, high.distanceTo(low));
    }
    this.camera.far = 20 * this.size;
    this.camera.updateProjectionMatrix();
  }

  // Walls seen from behind hide nothing, unless they are to.
  setBothSides(both) {
    for (const mesh of this.meshes) {
      mesh.material.side = both ? THREE.DoubleSide : THREE.FrontSide;
      mesh.material.needsUpdate = true;
    }
    this.draw();
  }

  // What the sonar can see, and the sheet its image is laid on.
  setWedge(axes, elevationDeg) {
    const key = `${axes.range_m} ${axes.azimuth_deg} ${elevationDeg}`;
    if (key === this.wedgeKey) return;
    this.wedgeKey = key;
    for (const old of [this.wedge, this.sheet]) {
      if (!old) continue;
      this.sonar.remove(old);
      old.geometry.dispose();
    }
    const [near, far] = axes.range_m;
    const [left, right] = outerEdges(axes.azimuth_deg);
    const half = elevationDeg / 2;
    const lines = [];
    for (const elevation of [-half, half]) {
      for (const azimuth of [left, right]) {
        lines.push(...direction(azimuth, elevation, 0), ...direction(azimuth, elevation, far));
      }
      for (let i = 0; i < kArcSteps; ++i) {
        const at = (step) => left + ((right - left) * step) / kArcSteps;
        lines.push(...direction(at(i), elevation, far), ...direction(at(i + 1), elevation, far));
      }
    }
    for (const azimuth of [left, right]) {
      lines.push(...direction(azimuth, -half, far), ...direction(azimuth, half, far));
    }
    this.wedge = new THREE.LineSegments(geometryOf(lines), new THREE.LineBasicMaterial({color: 0xd55e00}));
    const beams = axes.azimuth_deg;
    const edges = [left, ...beams.slice(1).map((azimuth, i) => (azimuth + beams[i]) / 2), right];
    const positions = [];
    const places = [];
    const faces = [];
    edges.forEach((azimuth, i) => {
      positions.push(...direction(azimuth, 0, near), ...direction(azimuth, 0, far));
      places.push(i / beams.length, 0, i / beams.length, 1);
      if (i > 0) faces.push(2 * i - 2, 2 * i - 1, 2 * i, 2 * i, 2 * i - 1, 2 * i + 1);
    });
    const geometry = geometryOf(positions, {uv: {values: places, size: 2}});
    geometry.setIndex(faces);
    // Over everything else: a sonar's echoes hide in no floor.
    this.sheet = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({transparent: true, side: THREE.DoubleSide,
                                                                        depthTest: false}));
    this.sheet.visible = this.showsImage !== false;
    this.sonar.add(this.wedge, this.sheet);
  }

  setImage({bytes, bins, beams}) {
    if (!this.texture || this.texture.image.width !== beams || this.texture.image.height !== bins) {
      if (this.texture) this.texture.dispose();
      this.texture = new THREE.DataTexture(bytes, beams, bins, THREE.RGBAFormat);
      this.texture.magFilter = this.texture.minFilter = THREE.LinearFilter;
      this.texture.colorSpace = THREE.SRGBColorSpace;
    }
    this.texture.image.data = bytes;
    this.texture.needsUpdate = true;
    if (this.sheet.material.map !== this.texture) {
      this.sheet.material.map = this.texture;
      this.sheet.material.needsUpdate = true;
    }
  }

  setImageShown(shown) {
    this.showsImage = shown;
    if (this.sheet) this.sheet.visible = shown;
    this.draw();
  }

  setPose(pose) {
    this.sonar.matrix.copy(worldFromSonar(pose));
    this.sonar.matrixWorldNeedsUpdate = true;
    if (this.place === 'sonar' || this.place === 'behind') this.look(this.place);
  }

  // From outside, from above, from behind the sonar, or through its eye.
  look(place) {
    this.place = place;
    const at = new THREE.Vector3().setFromMatrixPosition(this.sonar.matrix);
    const point = (x, y, z) => new THREE.Vector3(x, y, z).applyMatrix4(this.sonar.matrix);
    this.camera.up.set(0, 0, 1);
    if (place === 'sonar') {
      this.camera.position.copy(point(0, 0.02, 0));
      this.orbit.target.copy(point(0, 4, 0));
    } else if (place === 'behind') {
      this.camera.position.copy(point(0, -3.2, 1.7));
      this.orbit.target.copy(point(0, 3, 0));
    } else if (place === 'above') {
      const middle = this.centre.clone().add(at).multiplyScalar(0.5);
      this.orbit.target.copy(middle);
      this.camera.position.copy(middle).add(new THREE.Vector3(0, -0.001, 0.95 * this.size));
    } else {
      const middle = this.centre.clone().add(at).multiplyScalar(0.5);
      this.orbit.target.copy(middle);
      this.camera.position.copy(middle).add(new THREE.Vector3(-0.3, -0.46, 0.42).multiplyScalar(this.size));
    }
    this.orbit.update();
    this.draw();
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.host;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // With the next picture of the screen, however often it is asked for.
  draw() {
    if (this.drawing) return;
    this.drawing = true;
    requestAnimationFrame(() => {
      this.drawing = false;
      this.renderer.render(this.scene, this.camera);
    });
  }
}
