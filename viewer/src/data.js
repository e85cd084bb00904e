// data.js, which `doublet view` writes: {characters: [{name, glb, dofs}], clips: [{name, poses: [of each character]}],
// parameters: [{name, lower, upper, unit, meaning}]}; bytes in base64, poses (T, D) float64.

export function bytesOf(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** @returns {Float64Array[]} one a frame */
export function posesOf(text, dofs) {
  const all = new Float64Array(bytesOf(text).buffer);
  return Array.from({ length: all.length / dofs }, (_, t) => all.slice(t * dofs, (t + 1) * dofs));
}
