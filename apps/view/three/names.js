// Parts of three.js that the page uses. scripts/bundle_three.sh bundles them into the file three.js of this folder.
export {
  BoxGeometry, BufferAttribute, BufferGeometry, DataTexture, DirectionalLight, DoubleSide, Euler, FrontSide, Group,
  HemisphereLight, LineBasicMaterial, LineSegments, LinearFilter, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  MeshPhongMaterial, PerspectiveCamera, Quaternion, RGBAFormat, SRGBColorSpace, Scene, Vector3, WebGLRenderer
} from 'three';
export {OrbitControls} from 'three/addons/controls/OrbitControls.js';
