// Plays a baked animation as three.js does: node play_glb.mjs MODULES FILE.glb OUT SECONDS...
// Writes OUT/NAME.f32, the vertices of each mesh at those times (T, V, 3), and OUT/NAME.u32, its triangles.
import { readFileSync, writeFileSync } from 'node:fs';

const [modules, file, out, ...times] = process.argv.slice(2);
globalThis.self = globalThis; // what the loader wants of a browser; pictures it leaves alone, with a word on stderr
const THREE = await import(`${modules}/node_modules/three/build/three.module.js`);
const { GLTFLoader } = await import(`${modules}/node_modules/three/examples/jsm/loaders/GLTFLoader.js`);

const data = readFileSync(file);
const loader = new GLTFLoader();
const gltf = await loader.parseAsync(data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength), '');
const mixer = new THREE.AnimationMixer(gltf.scene);
const action = mixer.clipAction(gltf.animations[0]).setLoop(THREE.LoopOnce);
action.clampWhenFinished = true;
action.play();
const meshes = [];
gltf.scene.traverse((object) => object.isMesh && meshes.push(object));
const frames = meshes.map(() => []);
for (const time of times.map(Number)) {
  mixer.setTime(time);
  gltf.scene.updateMatrixWorld(true);
  meshes.forEach((mesh, m) => {
    const count = mesh.geometry.attributes.position.count;
    const frame = new Float32Array(3 * count);
    const vertex = new THREE.Vector3();
    for (let v = 0; v < count; ++v)
      mesh.getVertexPosition(v, vertex).applyMatrix4(mesh.matrixWorld).toArray(frame, 3 * v);
    frames[m].push(frame);
  });
}
meshes.forEach((mesh, m) => {
  writeFileSync(`${out}/${mesh.name}.f32`, Buffer.concat(frames[m].map((f) => Buffer.from(f.buffer))));
  writeFileSync(`${out}/${mesh.name}.u32`, Buffer.from(Uint32Array.from(mesh.geometry.index.array).buffer));
});
