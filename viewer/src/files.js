// Files that are dropped on the page, and one that is saved.

const JSON_CHUNK = 20; // where the text of a .glb begins

/** Is this a .glb with a character of doublet in it? */
export function isCharacter(bytes) {
  if (bytes.length < JSON_CHUNK || new TextDecoder().decode(bytes.slice(0, 4)) !== "glTF") return false;
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  return new TextDecoder().decode(bytes.slice(JSON_CHUNK, JSON_CHUNK + length)).includes('"DOUBLET_character"');
}

/** Calls take(name, bytes) for each file, one after the other, those of another drop after those of the one before. */
export function acceptFiles(element, take, onProblem) {
  const hint = document.getElementById("drop");
  let last = Promise.resolve();
  const takeAll = async (files) => {
    for (const file of files) {
      try {
        await take(file.name, new Uint8Array(await file.arrayBuffer()));
      } catch (error) {
        onProblem(error.message.startsWith("/") ? error.message.slice(1) : error.message);
      }
    }
  };
  element.addEventListener("dragover", (event) => {
    event.preventDefault();
    hint.hidden = false;
  });
  element.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) hint.hidden = true;
  });
  element.addEventListener("drop", (event) => {
    event.preventDefault();
    hint.hidden = true;
    const files = [...event.dataTransfer.files];
    last = last.then(() => takeAll(files));
  });
}

export function save(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  Object.assign(document.createElement("a"), { href: address, download: name }).click();
  URL.revokeObjectURL(address);
}
