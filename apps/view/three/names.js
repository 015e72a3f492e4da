// What the page uses of three.js. scripts/bundle_three.sh makes three.js in this folder from it.
export {
  BoxGeometry, BufferAttribute, BufferGeometry, DataTexture, DirectionalLight, DoubleSide, Euler, FrontSide, Group,
  HemisphereLight, LineBasicMaterial, LineSegments, LinearFilter, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  MeshPhongMaterial, PerspectiveCamera, Quaternion, RGBAFormat, SRGBColorSpace, Scene, Vector3, WebGLRenderer
} from 'three';
export {OrbitControls} from 'three/addons/controls/OrbitControls.js';
