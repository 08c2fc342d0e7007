// Dropped files in this browser's database, for a reload of the page.
import type { Dropped } from "./files";

const [DATABASE, TABLE] = ["basrelief", "files"];
/** Maximum number of kept models. */
const MOST = 4;

const result = <T>(request: IDBRequest<T>): Promise<T> => new Promise((done, failed) => {
  request.onsuccess = () => done(request.result);
  request.onerror = () => failed(request.error);
});

async function table(mode: IDBTransactionMode): Promise<IDBObjectStore> {
  const open = indexedDB.open(DATABASE, 1);
  open.onupgradeneeded = () => open.result.createObjectStore(TABLE, { autoIncrement: true });
  const database = await result(open);
  const opened = database.transaction(TABLE, mode);
  opened.oncomplete = () => database.close();
  return opened.objectStore(TABLE);
}

/** Keeps a model, and only the last few models. A browser without a database keeps nothing. */
export async function keepFiles(files: Dropped): Promise<void> {
  try {
    const kept = await table("readwrite");
    await result(kept.add(files));
    const keys = await result(kept.getAllKeys());
    await Promise.all(keys.slice(0, -MOST).map(key => result(kept.delete(key))));
  } catch {
    // The page works without it, and a reload names the file.
  }
}

/** Returns the last kept model with this name. */
export async function keptFiles(name: string): Promise<Dropped | undefined> {
  try {
    const all = await result((await table("readonly")).getAll() as IDBRequest<Dropped[]>);
    return all.findLast(files => files.name === name);
  } catch {
    return undefined;
  }
}
