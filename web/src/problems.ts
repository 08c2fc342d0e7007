// Messages above the results. Each kind has one message, which the user can dismiss.
import { byId, el } from "./dom";

const KINDS = ["input", "run", "warning"] as const;
const now = new Map<(typeof KINDS)[number], string>();

/** Shows the message of a kind, or removes it. */
export function problem(kind: (typeof KINDS)[number], text: string | undefined): void {
  if (text) now.set(kind, text);
  else now.delete(kind);
  const place = byId("problem");
  place.hidden = now.size === 0;
  place.firstElementChild!.replaceChildren(...KINDS.flatMap(kind => (now.has(kind) ? [el("span", { "data-kind": kind }, `${now.get(kind)} `)] : [])));
}

export function dismissed(): void {
  for (const kind of KINDS) problem(kind, undefined);
}

/** Returns the reason that an error gives. */
export function why(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
