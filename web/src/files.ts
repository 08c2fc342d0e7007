// Reads dropped or chosen files: a model or a display list, with its neighbouring files.

export interface Dropped { name: string; files: { name: string; at: [number, number] }[]; rest: Uint8Array<ArrayBuffer> }

interface Named { path: string; file: File }

const MAIN = [/\.glb$/i, /\.gltf$/i, /\.obj$/i, /\.(bdl|jsonl)(\.zst)?$/i];

async function inside(entry: FileSystemEntry): Promise<Named[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [{ path: entry.fullPath.replace(/^\//, ""), file }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const all: Named[] = [];
  // A folder is read in batches. An empty batch is the end.
  for (;;) {
    const part = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (part.length === 0) return all;
    all.push(...(await Promise.all(part.map(inside))).flat());
  }
}

export async function dropped(transfer: DataTransfer): Promise<Dropped> {
  const entries = [...transfer.items].map(item => item.webkitGetAsEntry()).filter(entry => entry !== null);
  const loose = [...transfer.files];
  return gathered(entries.length > 0 ? (await Promise.all(entries.map(inside))).flat() : loose.map(file => ({ path: file.name, file })));
}

export const chosen = (files: FileList): Promise<Dropped> =>
  gathered([...files].map(file => ({ path: file.webkitRelativePath || file.name, file })));

/** Opens the first file of the most preferred kind. The other files are named relative to its folder. */
async function gathered(all: Named[]): Promise<Dropped> {
  const sorted = all.toSorted((a, b) => (a.path < b.path ? -1 : 1));
  const main = MAIN.map(kind => sorted.find(({ path }) => kind.test(path))).find(found => found !== undefined) ?? sorted[0];
  if (!main) throw new Error("nothing was dropped; expected a GLB file, a glTF folder, an OBJ or a display list");
  const folder = main.path.slice(0, main.path.lastIndexOf("/") + 1);
  const near = sorted.filter(({ path }) => path.startsWith(folder));
  const contents = await Promise.all(near.map(async ({ file }) => new Uint8Array(await file.arrayBuffer())));
  const rest = new Uint8Array(contents.reduce((length, bytes) => length + bytes.length, 0));
  let at = 0;
  const files = near.map(({ path }, n) => {
    const bytes = contents[n]!;
    rest.set(bytes, at);
    at += bytes.length;
    return { name: path.slice(folder.length), at: [at - bytes.length, bytes.length] as [number, number] };
  });
  return { name: main.path.slice(folder.length), files, rest };
}
