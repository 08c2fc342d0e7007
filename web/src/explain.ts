// The causes of the difference between two runs: runs of B with one group of parameters as in A.
import { frameCycles } from "./changes";
import { thousands } from "./dom";
import type { Machine, Parameter, Report, Run } from "./protocol";
import type { Source } from "./session";
import type { State } from "./state";

interface Side { run: Run; state: State; source: Source }
type Setting = [key: string, value: string];

export interface Cause { group: string; by: number | undefined }
export interface Explained { text: string; causes: Cause[] }

/** Maximum number of FIFOs that have a group each, and of runs that fix derived values. */
const [FIFOS, PASSES] = [6, 4];
const WORK = "work parameters";

const valueOf = (config: unknown, key: string): unknown =>
  key.split(".").reduce<unknown>((at, part) => (at as Record<string, unknown> | undefined)?.[part], config);
const asOption = (value: unknown): string => (typeof value === "string" ? value : JSON.stringify(value));
const same = (a: unknown, b: unknown): boolean => JSON.stringify(a) === JSON.stringify(b);

/** Returns the settings of these parameters in `to` that differ in `from`. */
function settings(parameters: Parameter[], from: Report, to: Report): Setting[] {
  const differing = parameters.filter(({ key }) => !same(valueOf(from.config, key), valueOf(to.config, key)));
  return differing.map(({ key }) => [key, asOption(valueOf(to.config, key))]);
}

/** Groups parameters by memory, cache or FIFO, or by the first part of the key. */
function groups(parameters: Parameter[]): Map<string, Parameter[]> {
  const group = ({ key }: Parameter) => key.split(".").slice(0, /^(memory|cache|fifo)\./.test(key) ? 2 : 1).join(".");
  const fifos = new Set(parameters.map(group).filter(name => name.startsWith("fifo.")));
  const joined = (name: string) => (name.startsWith("fifo.") && fifos.size > FIFOS ? "fifo" : name);
  return Map.groupBy(parameters, parameter => joined(group(parameter)));
}

/** Measures and words the causes. `run` returns the report of a side with more settings. */
export async function explain<S extends Side>(
  a: S, b: S, machine: Machine | undefined, run: (side: S, set: Setting[]) => Promise<Report>,
): Promise<Explained> {
  const [before, after] = [a.run.report, b.run.report];
  const causes = machine && before.machine === after.machine ? await measured(a, b, machine, run) : [];
  return { text: words(before, after, causes), causes };
}

async function measured<S extends Side>(a: S, b: S, machine: Machine, run: (side: S, set: Setting[]) => Promise<Report>): Promise<Cause[]> {
  const [before, after] = [a.run.report, b.run.report];
  /** Returns the cycles of a side with the values that these parameters have in `target`; nothing if the run is incomplete. */
  const cycles = async (side: S, parameters: Parameter[], target: Report) => {
    const set = settings(parameters, side.run.report, target);
    for (let pass = 0; pass < PASSES; pass++) {
      const report = await run(side, set);
      if (report.outcome.kind !== "complete") return undefined;
      // Some values follow from others, such as the cycles of a memory from its part.
      const others = machine.parameters.filter(parameter => !parameters.includes(parameter));
      const more = [...settings(parameters, report, target), ...settings(others, report, side.run.report)];
      if (more.length === 0) return frameCycles(report);
      set.push(...more);
    }
    return undefined;
  };
  const differing = machine.parameters.filter(({ key }) => !same(valueOf(before.config, key), valueOf(after.config, key)));
  const timing = groups(differing.filter(({ effect }) => effect === "timing"));
  const causes: Cause[] = [];
  const add = (group: string, then: number | undefined) => causes.push({ group, by: then === undefined ? then : frameCycles(after) - then });
  for (const [group, parameters] of timing) add(group, await cycles(b, parameters, before));
  const isOtherWork = a.source !== b.source || !same(a.state.view, b.state.view);
  if (isOtherWork || differing.some(({ effect }) => effect === "work")) {
    add(WORK, await cycles(a, machine.parameters.filter(({ effect }) => effect === "timing"), after));
  }
  const size = ({ by }: Cause) => (by === undefined ? Infinity : Math.abs(by));
  causes.sort((x, y) => size(y) - size(x));
  return [...causes, { group: "interaction", by: frameCycles(after) - frameCycles(before) - sum(causes) }];
}

const sum = (causes: Cause[]): number => causes.reduce((all, { by }) => all + (by ?? 0), 0);
const signed = (n: number): string => (n > 0 ? `+${thousands(n)}` : thousands(n));
const percent = (share: number): string => signed(Math.round(1000 * share) / 10);

/** Describes the change of the cycles and its causes. The last cause is the interaction. */
function words(a: Report, b: Report, causes: Cause[]): string {
  const [before, after] = [frameCycles(a), frameCycles(b)];
  const delta = after - before;
  const relative = before === 0 ? "" : ` (${percent(delta / before)} %)`;
  const head = delta === 0
    ? `Both runs take ${thousands(after)} cycles`
    : `B takes ${thousands(Math.abs(delta))} ${delta > 0 ? "more" : "fewer"} cycles${relative}`;
  const sentences = [];
  if (a.machine !== b.machine) {
    sentences.push(`The machines differ: A is ${a.machine}, B is ${b.machine}. Units and figures with the same name may mean different things.`);
  }
  if (a.input.sha256 !== b.input.sha256 && a.input.sha256 && b.input.sha256) sentences.push("The inputs differ.");
  return [...sentences, `${head}${causesInWords(causes, before)}.`].join(" ");
}

function causesInWords(causes: Cause[], before: number): string {
  const shares = causes.slice(0, -1);
  const left = causes.at(-1)?.by ?? 0;
  const inseparable = shares.filter(({ by }) => by === undefined).map(({ group }) => group).join(" and ");
  const counts = shares.filter(({ by }) => by);
  if (counts.length === 1 && left === 0 && !inseparable) return `, all due to ${counts[0]!.group}`;
  const isListed = (by: number) => Math.abs(by) * 1000 >= before;
  // If all causes are small, all are listed.
  const listed = counts.some(({ by }) => isListed(by!)) ? counts.filter(({ by }) => isListed(by!)) : counts;
  let other = sum(counts) - sum(listed);
  const parts = listed.map(({ group, by }) => `${group}: ${signed(by!)}`);
  if (inseparable) parts.push(left === 0 ? `${inseparable}: not separable` : `${inseparable} (not separable): ${signed(left)}`);
  else if (isListed(left) || (parts.length === 0 && left !== 0)) parts.push(`interaction: ${signed(left)}`);
  else other += left;
  if (other !== 0) parts.push(`other: ${signed(other)}`);
  return parts.length === 0 ? "" : `. Causes: ${parts.join("; ")}`;
}
