// Figures of a report: a wheel, a drag, two fingers or keys zoom, a pointer or the arrow keys read values. Without it they are pictures.
"use strict";
(() => {
  const tip = document.createElement("div");
  tip.className = "readout";
  tip.setAttribute("role", "status");
  document.body.append(tip);
  const minus = text => String(text).replace(/-/g, "\u2212");
  // A label "angle [rad]" as name and unit.
  const parted = label => { const m = /^(.*?)\s*\[(.*?)\]/.exec(label); return m ? [m[1], " " + m[2]] : [label, ""]; };
  const written = (at, from, to, isLog) => {
    if (isLog) return minus(Number((10 ** at).toPrecision(3)));
    const fine = Math.abs(to - from) / 2000, most = Math.max(Math.abs(from), Math.abs(to));
    if (!(fine > 0) || fine < 1e-9 || most >= 1e6) return minus(at.toPrecision(4));
    return minus(at.toFixed(Math.max(0, Math.min(9, Math.ceil(-Math.log10(fine))))));
  };
  const coordinate = (panel, axis, place) => {
    const [box, ...ends] = panel, [from, to] = ends[axis];
    const share = axis ? (box[3] - place) / (box[3] - box[1]) : (place - box[0]) / (box[2] - box[0]);
    return written(from + share * (to - from), from, to, panel[3][axis]);
  };
  const inside = (box, x, y) => x >= box[0] && x <= box[2] && y >= box[1] && y <= box[3];

  function interactive(svg) {
    const data = JSON.parse(svg.dataset.readout);
    const [full] = [svg.viewBox.baseVal].map(b => ({ x: b.x, y: b.y, w: b.width, h: b.height }));
    let view = { ...full }, series = null, drag = null, cursor = null, points = [];
    const ring = document.createElementNS(svg.namespaceURI, "circle");
    const frame = document.createElementNS(svg.namespaceURI, "rect");
    for (const [mark, colour] of [[ring, "#D55E00"], [frame, "#0072B2"]]) {
      mark.setAttribute("fill", "none"); mark.setAttribute("stroke", colour); mark.style.display = "none";
      mark.setAttribute("pointer-events", "none"); svg.append(mark);
    }
    // Vertices of lines and dots that have a name, by colour; every figure without names has one nameless series.
    const read = () => {
      series = new Map();
      const known = Object.keys(data.names).length > 0;
      for (const shape of svg.querySelectorAll("polyline, path.dots, circle[fill^='#']")) {
        const colour = shape.tagName === "circle" ? shape.getAttribute("fill") : shape.getAttribute("stroke");
        if (known && !(colour in data.names)) continue;
        const text = shape.getAttribute("points") || shape.getAttribute("d") || `${shape.getAttribute("cx")},${shape.getAttribute("cy")}`;
        const found = [...text.matchAll(/(-?\d+),(-?\d+)/g)].map(m => [Number(m[1]), Number(m[2])]);
        if (!known && found.length < 3) continue;
        series.set(colour, (series.get(colour) || []).concat(found));
      }
    };
    const scale = () => view.w / svg.getBoundingClientRect().width;
    const toDrawing = event => { const b = svg.getBoundingClientRect(); return [view.x + (event.clientX - b.left) * scale(), view.y + (event.clientY - b.top) * scale()]; };
    const kept = [...svg.querySelectorAll("polyline, line, path.dots, text")].flatMap(e => ["font-size", "stroke-width", "stroke-dasharray"]
      .filter(name => e.hasAttribute(name)).map(name => [e, name, e.getAttribute(name).split(" ").map(Number)]));
    const range = document.createElement("span");
    function show(next) {
      const w = Math.max(full.w / 60, Math.min(full.w, next.w)), h = w * full.h / full.w, by = full.w / w;
      view = { w, h, x: Math.max(full.x, Math.min(full.x + full.w - w, next.x)), y: Math.max(full.y, Math.min(full.y + full.h - h, next.y)) };
      svg.setAttribute("viewBox", `${view.x} ${view.y} ${w} ${h}`);
      // Lines and words stay as large as they are; what is drawn moves apart.
      for (const [e, name, sizes] of kept) e.setAttribute(name, sizes.map(size => size / by).join(" "));
      const middle = [view.x + w / 2, view.y + h / 2];
      const panel = data.panels.find(p => inside(p[0], ...middle)) || data.panels.find(p => p[0][0] < view.x + w && p[0][2] > view.x && p[0][1] < view.y + h && p[0][3] > view.y);
      const span = (axis, from, to, low, high) => { const [name, unit] = parted(panel[4][axis]); return `${name} ${coordinate(panel, axis, Math.max(low, from))} to ${coordinate(panel, axis, Math.min(high, to))}${unit}`; };
      range.textContent = by < 1.01 || !panel ? "" : `${span(0, view.x, view.x + w, panel[0][0], panel[0][2])}; ${span(1, Math.min(view.y + h, panel[0][3]), Math.max(view.y, panel[0][1]), -1e9, 1e9)}`;
      svg.style.touchAction = by > 1.01 ? "none" : "pan-y";
    }
    const zoom = ([x, y], by) => show({ w: view.w / by, x: x - (x - view.x) / by, y: y - (y - view.y) / by });
    const reset = () => show(full);
    const hide = () => { tip.style.display = "none"; ring.style.display = "none"; };
    function say(words, [x, y]) {
      tip.textContent = words;
      tip.style.display = "block";
      const b = svg.getBoundingClientRect(), left = b.left + (x - view.x) / scale(), top = b.top + (y - view.y) / scale();
      tip.style.left = Math.max(4, Math.min(innerWidth - tip.offsetWidth - 4, left + 14)) + "px";
      tip.style.top = (top + 18 + tip.offsetHeight > innerHeight ? top - 14 - tip.offsetHeight : top + 18) + "px";
    }
    // The nearest point within reach, with what else is drawn at its abscissa; else the words of a spot.
    function look([x, y], reach) {
      if (!series) read();
      const panel = data.panels.find(p => inside(p[0], x, y));
      let best = null;
      if (panel) for (const [colour, all] of series) for (const p of all) {
        const far = Math.hypot(p[0] - x, reach === Infinity ? 0 : p[1] - y);
        if (inside(panel[0], ...p) && (!best || far < best.far)) best = { far, p, colour };
      }
      if (best && best.far <= reach) {
        const [name, unit] = parted(panel[4][0]), rows = [`${name} ${coordinate(panel, 0, best.p[0])}${unit}`];
        const order = [...series].sort((a, b) => (b[0] === best.colour) - (a[0] === best.colour));
        for (const [colour, all] of order) {
          let near = colour === best.colour ? best.p : null;
          if (!near) for (const p of all) if (inside(panel[0], ...p) && Math.abs(p[0] - best.p[0]) <= 12 && (!near || Math.abs(p[0] - best.p[0]) < Math.abs(near[0] - best.p[0]))) near = p;
          const [what, of] = parted(panel[4][1]);
          if (near) rows.push(`${data.names[colour] || what}: ${coordinate(panel, 1, near[1])}${of}`);
        }
        for (const [name, value] of [["cx", best.p[0]], ["cy", best.p[1]], ["r", 6 * scale()], ["stroke-width", 2 * scale()]]) ring.setAttribute(name, value);
        ring.style.display = "";
        return say(rows.join("\n"), best.p);
      }
      ring.style.display = "none";
      const spot = data.spots.find(s => inside(s[0], x, y));
      spot ? say(spot[1], [x, y]) : hide();
    }
    // Two fingers: what lies between them stays between them.
    const fingers = new Map();
    const lifted = event => fingers.delete(event.pointerId);
    function pinched(event) {
      if (!fingers.has(event.pointerId)) return false;
      const apart = () => { const [a, b] = [...fingers.values()]; return b ? [Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), { clientX: (a.clientX + b.clientX) / 2, clientY: (a.clientY + b.clientY) / 2 }] : [0]; };
      const [before] = apart();
      fingers.set(event.pointerId, event);
      const [now, middle] = apart();
      if (!before || !now) return false;
      drag = null; frame.style.display = "none"; hide();
      zoom(toDrawing(middle), now / before);
      return true;
    }
    svg.addEventListener("pointermove", event => {
      if (pinched(event)) return;
      const at = toDrawing(event);
      if (!drag) return look(at, 60 * scale());
      hide();
      if (drag.pans) return show({ ...view, x: view.x + drag.at[0] - at[0], y: view.y + drag.at[1] - at[1] });
      const [x, y] = [Math.min(at[0], drag.at[0]), Math.min(at[1], drag.at[1])];
      drag.box = [x, y, Math.abs(at[0] - drag.at[0]), Math.abs(at[1] - drag.at[1])];
      ["x", "y", "width", "height"].forEach((name, k) => frame.setAttribute(name, drag.box[k]));
      frame.setAttribute("stroke-width", 1.5 * scale()); frame.style.display = "";
    });
    svg.addEventListener("pointerdown", event => {
      if (event.pointerType === "touch") fingers.set(event.pointerId, event);
      const zoomed = view.w < 0.99 * full.w;
      if (event.button !== 0 || (event.pointerType === "touch" && !zoomed)) return look(toDrawing(event), 60 * scale());
      drag = { at: toDrawing(event), pans: zoomed };
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointercancel", event => { lifted(event); drag = null; });
    svg.addEventListener("pointerup", event => {
      lifted(event);
      const box = drag && drag.box;
      drag = null; frame.style.display = "none";
      if (!box || box[2] < 10 * scale() || box[3] < 4 * scale()) return;
      const w = Math.max(box[2], box[3] * full.w / full.h), h = w * full.h / full.w;
      show({ w, x: box[0] + (box[2] - w) / 2, y: box[1] + (box[3] - h) / 2 });
    });
    // What a finger has read stays until the page moves or another place is touched.
    svg.addEventListener("pointerleave", event => { lifted(event); if (event.pointerType !== "touch") hide(); });
    addEventListener("scroll", hide, { passive: true });
    svg.addEventListener("dblclick", reset);
    // The wheel belongs to the page until the figure is chosen by a click, by the keyboard or with Ctrl.
    svg.addEventListener("wheel", event => {
      if (!event.ctrlKey && document.activeElement !== svg) return;
      if (event.deltaY > 0 && view.w > 0.99 * full.w) return;
      event.preventDefault(); hide(); zoom(toDrawing(event), Math.exp(-event.deltaY * 0.002));
    }, { passive: false });
    svg.addEventListener("keydown", event => {
      const middle = [view.x + view.w / 2, view.y + view.h / 2], zoomed = view.w < 0.99 * full.w;
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (event.key === "+" || event.key === "=") zoom(middle, 1.5);
      else if (event.key === "-") zoom(middle, 1 / 1.5);
      else if (event.key === "0" || event.key === "Escape") { reset(); hide(); }
      else if (step && zoomed && event.shiftKey) show({ ...view, x: view.x + step[0] * view.w / 8, y: view.y + step[1] * view.h / 8 });
      else if (step && step[0]) {
        const panel = data.panels.find(p => inside(p[0], ...middle)) || data.panels[0];
        if (panel) { cursor = Math.max(panel[0][0], Math.min(panel[0][2], (cursor ?? panel[0][0]) + step[0] * (panel[0][2] - panel[0][0]) / 100)); look([cursor, (panel[0][1] + panel[0][3]) / 2], Infinity); }
        else { points = data.spots; cursor = ((cursor ?? -1) + step[0] + points.length) % points.length; const [box, words] = points[cursor]; say(words, [box[0], box[3]]); }
      } else return;
      event.preventDefault();
    });
    svg.addEventListener("blur", hide);
    svg.setAttribute("tabindex", "0"); svg.style.touchAction = "pan-y";
    const bar = document.createElement("div");
    bar.className = "tools";
    for (const [words, name, act] of [["+", "zoom in", () => zoom([view.x + view.w / 2, view.y + view.h / 2], 1.5)], ["\u2212", "zoom out", () => zoom([view.x + view.w / 2, view.y + view.h / 2], 1 / 1.5)], ["reset", "reset zoom", reset]]) {
      const button = document.createElement("button");
      button.textContent = words; button.title = name; button.setAttribute("aria-label", name); button.onclick = act;
      bar.append(button);
    }
    bar.append(range);
    svg.after(bar);
    addEventListener("beforeprint", () => { reset(); hide(); });
  }
  document.querySelectorAll("figure svg[data-readout]").forEach(interactive);
})();
