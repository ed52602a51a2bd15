// What report/viewer.js needs of three.js 0.187.0 (MIT, three.LICENSE beside this file). The bundle is made anew with
//     npm install three@0.187.0 esbuild@0.28.2
//     npx esbuild three.entry.js --bundle --minify --format=iife --global-name=THREE --target=es2020 --outfile=three.bundle.js
//     gzip -9n three.bundle.js
// and comes out the same to the byte.
export {
  BackSide, Box3, BufferAttribute, BufferGeometry, Color, AlwaysStencilFunc, DecrementWrapStencilOp, DirectionalLight, DoubleSide,
  FrontSide, Group, HemisphereLight, IncrementWrapStencilOp, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, NotEqualStencilFunc, PerspectiveCamera, Plane, PlaneGeometry, Quaternion, Raycaster, Scene, Sphere, Vector3,
  WebGLRenderer, ZeroStencilOp,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
