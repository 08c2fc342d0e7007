"use strict";
// Moves what the page has drawn, and shows what is known of a point. Positions, colours and words stand in the element `sweep`.
(() => {
  const get = (id) => document.getElementById(id);
  const { box, whole, columns, names, rows, parallel } = JSON.parse(get("sweep").textContent);
  const plot = get("plot");
  if (!plot) return;
  const [left, top, width, height] = box;
  const svg = plot.querySelector("svg");
  const dots = [...svg.querySelectorAll(".point")];
  const classes = dots.map((dot) => dot.getAttribute("class").replace(" off", ""));
  const [across, upright, colour] = ["across", "upright", "colour"].map(get);
  const off = (element, hidden) => element?.classList.toggle("off", hidden);
  let [current, kept] = [-1, false];

  const place = (row) => {
    const [x, y] = [across, upright].map((select) => columns[select.value].at[row]);
    return x === null || y === null ? null : [left + (x / whole) * width, top + (1 - y / whole) * height];
  };

  function draw() {
    const shown = [`x-${across.value}`, `y-${upright.value}`, `line-${across.value}-${upright.value}`];
    for (const each of svg.querySelectorAll('[id^="x-"], [id^="y-"], [id^="line-"]')) off(each, !shown.includes(each.id));
    for (const scale of document.querySelectorAll(".colours")) scale.hidden = scale.id !== `colours-${colour.value}`;
    const colours = columns[colour.value]?.colours;
    dots.forEach((dot, row) => {
      const at = place(row);
      const level = colours && colours[row] !== "-" ? ` level-${colours[row]}` : "";
      dot.setAttribute("class", classes[row] + level + (at ? "" : " off"));
      if (at) [["cx", at[0]], ["cy", at[1]]].forEach(([name, value]) => dot.setAttribute(name, value));
    });
    mark();
  }

  // The point that is looked at, in both drawings.
  function mark() {
    const at = current < 0 ? null : place(current);
    off(get("cursor"), !at);
    if (at) [["cx", at[0]], ["cy", at[1]]].forEach(([name, value]) => get("cursor").setAttribute(name, value));
    const thread = get("thread");
    if (!thread || current < 0) return;
    let pen = "M";
    const path = parallel.axes.map(([column, x, spread]) => {
      const y = (spread ?? columns[column].at)[current];
      const step = y === null ? "" : `${pen}${x} ${parallel.top + (1 - y / whole) * parallel.height}`;
      pen = y === null ? "M" : "L";
      return step;
    });
    thread.setAttribute("d", path.join(""));
    off(thread, false);
  }

  // The buttons in the table of the front: each shows the number of its point.
  const buttons = [...document.querySelectorAll("button[data-id]")];
  const numberOf = new Map(buttons.map((button) => [button.dataset.id, button.textContent]));

  const make = (name, text) => Object.assign(document.createElement(name), { textContent: text });

  // Gone where there is no such file.
  function pictured(picture) {
    const image = Object.assign(new Image(), { src: picture, alt: "image of this point" });
    image.addEventListener("error", () => image.remove());
    return image;
  }

  function show(row) {
    current = row;
    const { id, picture, best, tie, default: isDefault, values } = rows[row];
    const number = numberOf.get(id);
    const rank = best ? `${number ? `Point ${number}, ` : ""}Pareto-optimal` : tie ? "Equal to a Pareto-optimal point" : "Not Pareto-optimal";
    const point = get("point");
    const here = place(row)?.join();
    const same = rows.filter((_, other) => place(other)?.join() === here).length;
    const hash = make("details", "");
    hash.append(make("summary", "Hash"), make("code", id));
    point.replaceChildren(make("h3", `${rank}${isDefault ? ", default" : ""}`), hash);
    if (here && same > 1) point.append(make("p", `One of ${same} points at this place.`));
    if (picture) point.append(pictured(picture));
    const list = make("dl", "");
    names.forEach((name, at) => list.append(make("dt", name), make("dd", values[at])));
    point.append(list);
    point.hidden = false;
    for (const button of buttons) button.closest("tr").classList.toggle("current", button.dataset.id === id);
    mark();
  }

  // The point nearest to a place on the screen, if it is near; the one that is looked at, if hardly another is nearer: where a
  // pointer was pressed is told in whole pixels.
  function nearest(event) {
    const here = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const distance = (row) => {
      const at = place(row);
      return at ? Math.hypot(at[0] - here.x, at[1] - here.y) : Infinity;
    };
    let [found, least] = [-1, 24];
    rows.forEach((_, row) => {
      // Of equal ones the last, which is drawn above the others.
      const away = distance(row);
      if (away <= least) [found, least] = [row, away];
    });
    return found >= 0 && current >= 0 && distance(current) <= least + 2 ? current : found;
  }

  // Points from left to right; with `front` only Pareto-optimal points.
  function order(front) {
    const all = rows.map((_, row) => [row, place(row)]).filter(([row, at]) => at && (!front || rows[row].best));
    return all.sort(([, a], [, b]) => a[0] - b[0] || a[1] - b[1]).map(([row]) => row);
  }

  function step(key) {
    const all = order(key === "ArrowUp" || key === "ArrowDown");
    const at = all.indexOf(current);
    const last = all.length - 1;
    const to = { Home: 0, End: last, ArrowLeft: at - 1, ArrowUp: at - 1 }[key] ?? at + 1;
    if (last >= 0) show(all[Math.min(Math.max(to, 0), last)]);
  }

  plot.addEventListener("pointermove", (event) => {
    const row = kept ? -1 : nearest(event);
    if (row >= 0 && row !== current) show(row);
  });
  plot.addEventListener("click", (event) => {
    const row = nearest(event);
    kept = row >= 0;
    if (kept) show(row);
  });
  plot.addEventListener("keydown", (event) => {
    if (["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End"].includes(event.key)) {
      event.preventDefault();
      kept = true;
      step(event.key);
    } else if (event.key === "Enter" || event.key === "Escape") {
      kept = event.key === "Enter";
    }
  });
  const byId = new Map(rows.map(({ id }, row) => [id, row]));
  for (const button of buttons) {
    const row = byId.get(button.dataset.id);
    for (const kind of ["focus", "pointerenter", "click"]) button.addEventListener(kind, () => row !== undefined && show(row));
  }
  get("choose").addEventListener("change", draw);
  get("choose").hidden = false;
  draw();
  const front = order(true);
  if (rows.length > 0) show(front.length > 0 ? front[Math.floor(front.length / 2)] : 0);
})();
