// A slow path to a server: a proxy that limits the rate, adds latency, and notes the transfers.
import { createServer, request } from "node:http";

/** Bytes that are sent at a time, as in a packet. */
const PACKET = 1460;

export class SlowPath {
  /** Requests and their times [ms]: path, start, end and bytes of the answer. */
  transfers = [];
  /** Answers that wait for the line: what is left of them, and their transfers. */
  #waiting = [];
  #free = 0;

  /** Answers to other paths than those that `isSlow` selects pass at once. */
  constructor(target, { bitsPerSecond, latency, isSlow }) {
    Object.assign(this, { target: new URL(target), bitsPerSecond, latency, isSlow });
  }

  async listen() {
    this.server = createServer((asked, answer) => void this.#pass(asked, answer));
    await new Promise(done => this.server.listen(0, "127.0.0.1", done));
    return `http://127.0.0.1:${this.server.address().port}/`;
  }

  stop() {
    this.server.closeAllConnections();
    this.server.close();
  }

  /** Returns the transfers of paths with this start. */
  of(start) {
    return this.transfers.filter(({ path }) => path.startsWith(start));
  }

  #pass(asked, answer) {
    const isSlow = this.isSlow(asked.url);
    const transfer = { path: asked.url, start: Date.now(), end: undefined, bytes: 0 };
    this.transfers.push(transfer);
    setTimeout(() => {
      const { hostname, port } = this.target;
      const onward = request({ hostname, port, path: asked.url, headers: asked.headers }, reply => {
        answer.writeHead(reply.statusCode, reply.headers);
        const parts = [];
        reply.on("data", part => parts.push(part));
        reply.on("end", () => {
          const body = Buffer.concat(parts);
          if (isSlow) return this.#send({ body, answer, transfer });
          Object.assign(transfer, { end: Date.now(), bytes: body.length });
          answer.end(body);
        });
      });
      onward.on("error", () => answer.destroy());
      onward.end();
    }, isSlow ? this.latency : 0);
  }

  #send(transmission) {
    this.#waiting.push(transmission);
    if (this.#waiting.length === 1) {
      this.#free = Math.max(this.#free, performance.now());
      this.#next();
    }
  }

  /** Sends a packet of each answer in turn. */
  #next() {
    const sent = this.#waiting[0];
    if (!sent) return;
    const packet = sent.body.subarray(0, PACKET);
    this.#free += (8000 * packet.length) / this.bitsPerSecond;
    setTimeout(() => {
      this.#waiting.shift();
      sent.body = sent.body.subarray(PACKET);
      sent.transfer.bytes += packet.length;
      if (!sent.answer.destroyed) {
        sent.answer.write(packet);
        if (sent.body.length > 0) this.#waiting.push(sent);
        else {
          sent.transfer.end = Date.now();
          sent.answer.end();
        }
      }
      this.#next();
    }, Math.max(0, this.#free - performance.now()));
  }
}
