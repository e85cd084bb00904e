// What is seen: light, ground, characters, camera.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  DynamicDrawUsage,
  Fog,
  GridHelper,
  Group,
  HemisphereLight,
  LinearFilter,
  Mesh,
  MeshStandardMaterial,
  NeutralToneMapping,
  PCFSoftShadowMap,
  PerspectiveCamera,
  SRGBColorSpace,
  Scene,
  ShaderChunk,
  Texture,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const SKY = 0xdde2e7;
const PLAIN = 0xb9a89a; // of a character without a texture
const APART = 1.1; // m, between two characters
const LIGHT_FROM = new Vector3(1.6, 3.4, 2.4);
/** From the best on; a machine that draws too slowly gets the next. ratio: pixels of the picture to one of the window. */
const QUALITIES = [
  { ratio: 2, shadow: 2048 },
  { ratio: 1, shadow: 1024 },
  { ratio: 0.6, shadow: 512 },
];

export class Stage {
  constructor(canvas) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFSoftShadowMap;
    this.renderer.toneMapping = NeutralToneMapping;
    this.scene = new Scene();
    this.scene.background = new Color(SKY);
    this.scene.fog = new Fog(SKY, 7, 22);
    this.camera = new PerspectiveCamera(32, 1, 0.05, 60);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.enableDamping = true;
    this.orbit.minDistance = 0.5;
    this.orbit.maxDistance = 14;
    this.orbit.maxPolarAngle = 0.53 * Math.PI;
    this.figures = [];
    this.quality = 0;
    this.centre = new Vector3(0, 1, 0);
    this.addLight();
    this.addGround();
    window.addEventListener("resize", () => this.resize());
  }

  addLight() {
    this.scene.add(new HemisphereLight(0xffffff, 0xb5aca2, 1.8), new AmbientLight(0xffffff, 0.35));
    this.sun = new DirectionalLight(0xfff4e6, 2.9);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.setScalar(QUALITIES[this.quality].shadow);
    this.sun.shadow.bias = -0.0006;
    this.sun.shadow.normalBias = 0.012;
    this.sun.shadow.radius = 5;
    Object.assign(this.sun.shadow.camera, { left: -2.2, right: 2.2, top: 2.2, bottom: -2.2, near: 0.5, far: 9 });
    this.scene.add(this.sun, this.sun.target);
  }

  addGround() {
    this.ground = new Group();
    const floor = new Mesh(new CircleGeometry(40, 64), new MeshStandardMaterial({ color: 0xd3d6d9, roughness: 1 }));
    floor.rotation.x = -Math.PI / 2;
    floor.receiveShadow = true;
    const grid = new GridHelper(40, 80, 0x9aa2aa, 0xb4bac1);
    grid.position.y = 0.001;
    grid.material.transparent = true;
    grid.material.opacity = 0.45;
    this.ground.add(floor, grid);
    this.scene.add(this.ground);
  }

  /** @param opened what the worker says of a character that it has opened */
  async addFigure(opened) {
    const figure = new Figure(opened, await textureOf(opened.texture));
    this.figures.push(figure);
    this.scene.add(figure.group);
    this.figures.forEach((one, i) => (one.group.position.x = APART * (i - (this.figures.length - 1) / 2)));
    return figure;
  }
  removeFigure(figure) {
    this.scene.remove(figure.group);
    figure.dispose();
    this.figures = this.figures.filter((one) => one !== figure);
    this.figures.forEach((one, i) => (one.group.position.x = APART * (i - (this.figures.length - 1) / 2)));
  }

  /** The camera's first place: in front, a little above, everybody in view. */
  home() {
    if (!this.figures[0]?.extent) return; // with the first picture it comes again
    this.isStale = true;
    const { low, height } = this.figures[0].extent;
    this.ground.position.y = low;
    this.middle = low + 0.5 * height;
    this.centre.copy(this.figures[0].centre).setY(this.middle).setX(this.placeOfAll());
    const free = this.freePart();
    const width = 0.75 * height + APART * (this.figures.length - 1);
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    const distance = Math.max((0.62 * height) / (half * free.height), (0.5 * width) / (half * this.camera.aspect * free.width));
    this.orbit.target.copy(this.centre);
    this.camera.position.copy(this.centre).add(new Vector3(0.3, 0.16, 0.94).multiplyScalar(distance));
  }
  placeOfAll() {
    return this.figures.reduce((sum, one) => sum + one.centre.x + one.group.position.x, 0) / this.figures.length;
  }

  /** Shares of the window that the panel leaves free. */
  freePart() {
    const panel = document.getElementById("panel").getBoundingClientRect();
    const below = panel.width > 0.9 * innerWidth;
    return below
      ? { width: 1, height: Math.max(0.4, panel.top / innerHeight) }
      : { width: Math.max(0.4, panel.left / innerWidth), height: 1 };
  }

  resize() {
    this.isStale = true; // the picture
    const free = this.freePart();
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, QUALITIES[this.quality].ratio));
    this.renderer.setSize(innerWidth, innerHeight, false);
    this.camera.aspect = innerWidth / innerHeight;
    // The middle of the picture is that of its free part.
    const x = (innerWidth * (1 - free.width)) / 2;
    const y = (innerHeight * (1 - free.height)) / 2;
    this.camera.setViewOffset(innerWidth, innerHeight, x, y, innerWidth, innerHeight);
    this.camera.updateProjectionMatrix();
  }

  /** Less to draw, if there is less. */
  lighten() {
    if (this.quality + 1 === QUALITIES.length) return;
    this.quality += 1;
    this.sun.shadow.mapSize.setScalar(QUALITIES[this.quality].shadow);
    this.sun.shadow.map?.dispose();
    this.sun.shadow.map = null;
    this.resize();
  }

  /** The camera goes along with the characters, calmly. */
  follow(seconds) {
    const to = new Vector3(this.placeOfAll(), this.middle, this.figures[0].centre.z);
    const way = to.sub(this.centre).multiplyScalar(1 - Math.exp(-3 * seconds));
    this.centre.add(way);
    this.orbit.target.add(way);
    this.camera.position.add(way);
  }

  /** @param hasMoved whether anything but the camera has */
  draw(hasMoved) {
    if (!this.orbit.update() && !hasMoved && !this.isStale) return;
    this.isStale = false;
    this.sun.target.position.copy(this.centre);
    this.sun.position.copy(this.centre).add(LIGHT_FROM);
    this.ground.position.x = Math.round(this.centre.x * 2) / 2; // whole cells of the grid
    this.ground.position.z = Math.round(this.centre.z * 2) / 2;
    this.renderer.render(this.scene, this.camera);
  }

  /** Pixels of the point over a figure's head. */
  above(figure) {
    const { low, height } = figure.extent;
    const at = figure.centre.clone().add(figure.group.position).setY(low + 1.05 * height).project(this.camera);
    return { x: ((at.x + 1) / 2) * innerWidth, y: ((1 - at.y) / 2) * innerHeight };
  }
}

async function textureOf(file) {
  if (file.length === 0) return null;
  const image = await createImageBitmap(new Blob([file]), { colorSpaceConversion: "none" });
  const texture = new Texture(image);
  texture.flipY = false; // glTF's convention
  texture.colorSpace = SRGBColorSpace;
  texture.generateMipmaps = false; // a picture that somebody has painted may be of any colour between the charts
  texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** A character as it is drawn: its surface, and the body under it. */
class Figure {
  /** Another picture on the first surface. @param {Uint8Array} file */
  async setTexture(file) {
    const { material } = this.meshes[0];
    const map = await textureOf(file);
    material.map?.dispose();
    material.map = map;
    material.color.set(0xffffff);
    material.needsUpdate = true;
  }

  /** What the graphics card has of it goes. */
  dispose() {
    for (const { geometry, material } of this.meshes) {
      material.map?.dispose();
      material.dispose();
      geometry.dispose();
    }
  }

  constructor({ shapes, bodyColour }, map) {
    this.group = new Group();
    this.centre = new Vector3();
    this.extent = undefined; // of the first frame that is shown: until then nothing has a place
    const surface = new MeshStandardMaterial({ map, color: map ? 0xffffff : PLAIN, roughness: 0.95, side: DoubleSide });
    surface.shadowSide = DoubleSide;
    surface.onBeforeCompile = stayInTriangle;
    const body = new MeshStandardMaterial({ color: new Color(...bodyColour), roughness: 0.8 });
    this.meshes = shapes.map((shape, which) => meshOf(shape, which === 0 ? surface : body));
    this.group.add(...this.meshes);
  }

  /** Between two simulated frames. */
  show(before, after, share) {
    this.meshes.forEach(({ geometry }, which) => {
      for (const [name, values] of [["position", "positions"], ["normal", "normals"]]) {
        const attribute = geometry.attributes[name];
        mix(before[which][values], after[which][values], share, attribute.array);
        attribute.needsUpdate = true;
      }
    });
    const places = this.meshes[0].geometry.attributes.position.array;
    const few = 48; // 16 vertices
    let count = 0;
    this.centre.set(0, 0, 0);
    for (let i = 0; i + 2 < places.length; i += few, ++count) {
      this.centre.x += places[i];
      this.centre.y += places[i + 1];
      this.centre.z += places[i + 2];
    }
    this.centre.divideScalar(count);
    this.extent ??= extentOf(places);
  }
}

/** Of vertices (V * 3) along +Y, m. */
function extentOf(places) {
  let low = Infinity, high = -Infinity;
  for (let i = 1; i < places.length; i += 3) {
    low = Math.min(low, places[i]);
    high = Math.max(high, places[i]);
  }
  return { low, height: high - low };
}

/** Multisampling else looks the colour of an edge up beyond it, where in the image there is another triangle. */
function stayInTriangle(shader) {
  const centroid = (chunk, way) => ShaderChunk[chunk].replace("varying vec2 vMapUv", `centroid ${way} vec2 vMapUv`);
  shader.vertexShader = shader.vertexShader.replace("#include <uv_pars_vertex>", centroid("uv_pars_vertex", "out"));
  shader.fragmentShader = shader.fragmentShader.replace("#include <uv_pars_fragment>", centroid("uv_pars_fragment", "in"));
}

function meshOf({ triangles, texcoords }, material) {
  const geometry = new BufferGeometry();
  const count = (3 * texcoords.length) / 2;
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.setAttribute("uv", new BufferAttribute(texcoords, 2));
  for (const name of ["position", "normal"])
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(count), 3).setUsage(DynamicDrawUsage));
  const mesh = new Mesh(geometry, material);
  mesh.castShadow = mesh.receiveShadow = true;
  mesh.frustumCulled = false; // its bounds change with every frame
  return mesh;
}

function mix(a, b, share, out) {
  for (let i = 0; i < out.length; ++i) out[i] = a[i] + share * (b[i] - a[i]);
}
