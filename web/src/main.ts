// The start of the page.
import { Client } from "./client";
import { byId } from "./dom";
import { compiled } from "./load";
import { Page } from "./page";
import { problem, why } from "./problems";

export interface Embedded { wasm(): Promise<ReadableStream<Uint8Array>>; worker(): Worker }

export async function page(embedded: Embedded): Promise<void> {
  try {
    const client = new Client(embedded.worker, await compiled(embedded.wasm()));
    await new Page(client).begin();
  } catch (error) {
    byId("answered").textContent = "";
    problem("input", why(error));
  }
  byId("loading").hidden = true;
}
