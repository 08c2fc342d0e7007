// The inputs of the page: scene, machine, view and parameters.
import { controls, type Handlers } from "./controls";
import { byId, el } from "./dom";
import type { Catalogue, Machine } from "./protocol";
import { SIZES, type State } from "./state";

const value = (id: string, text: string | number): void => void (byId<HTMLInputElement>(id).value = String(text));

/** Shows the state in the choices and controls. */
export function fill(state: State, { machines, demos }: Catalogue, machine: Machine, handlers: Handlers): void {
  byId("machine").replaceChildren(...machines.map(({ name, about }) => el("option", { value: name, title: about }, name)));
  value("machine", machine.name);
  const isListed = demos.some(({ name }) => name === state.demo);
  const own = isListed ? [] : [el("option", { value: state.demo ?? "" }, state.demo ?? state.file ?? "")];
  byId("demo").replaceChildren(...own, ...demos.map(({ name, about }) => el("option", { value: name, title: about }, name)));
  value("demo", state.demo ?? "");
  const { size, frames = "", orbit = "", light } = state.view;
  const sizes = SIZES.some(([w, h]) => w === size[0] && h === size[1]) ? SIZES : [...SIZES, size];
  byId("size").replaceChildren(...sizes.map(([w, h]) => el("option", { value: `${w}x${h}` }, `${w} \u00d7 ${h}`)));
  value("size", size.join("x"));
  value("frames", frames);
  value("orbit", orbit);
  value("light", light ? angle(light) : 0);
  parameters(state, machine, handlers);
}

/** Shows the controls of the parameters that match the search. */
export function parameters(state: State, machine: Machine, handlers: Handlers): void {
  byId("controls").replaceChildren(...controls(machine, state.set, byId<HTMLInputElement>("search").value, handlers));
  resets(state);
}

/** Shows a button for each kind of change that can be reset. */
export function resets({ set, view }: State): void {
  byId("defaults").hidden = set.size === 0;
  byId("unlight").hidden = view.light === undefined;
}

export const round = (x: number, digits: number): number => Number(x.toFixed(digits));

/** Returns the direction of a light from above, by its angle around the scene. */
export function towards(degrees: number): [number, number, number] {
  const angle = (degrees * Math.PI) / 180;
  return [round(Math.sin(angle), 4), 0.9, round(Math.cos(angle), 4)];
}

const angle = ([x, , z]: [number, number, number]): number => Math.round((Math.atan2(x, z) * 180) / Math.PI);
