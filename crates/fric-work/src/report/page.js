"use strict";
// Makes the plots of a page answer: values under the mouse, one time axis for all that go over time, cables and models on and off.
// The page shows everything without it, as SVG and tables; the numbers are those of the element `fric-plots`.
(() => {
  const source = document.getElementById("fric-plots");
  if (!source || typeof uPlot === "undefined") return;
  const page = JSON.parse(source.textContent);
  const root = document.documentElement;
  const color = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();
  const element = (tag, attributes = {}, ...children) => {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
  };

  // ---- numbers

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  function decode(of) {
    if (of.f32) return new Float32Array(bytes(of.f32));
    if (of.u16 !== undefined) {
      const codes = new Uint16Array(bytes(of.u16));
      return Float32Array.from(codes, (code) => (code === 65535 ? NaN : of.least + of.step * code));
    }
    return Float64Array.from(of, (value) => (value === null ? NaN : value));
  }
  const xs = page.xs.map(decode);

  // Least and greatest of 2, 4, 8 … intervals, so that a drawing never takes more points than it has pixels.
  function pyramid(least, greatest) {
    const levels = [[least, greatest]];
    while (levels[levels.length - 1][0].length > 512) {
      const [low, high] = levels[levels.length - 1];
      const count = (low.length + 1) >> 1;
      const [lower, higher] = [new Float32Array(count), new Float32Array(count)];
      for (let place = 0; place < count; place++) {
        const [a, b] = [2 * place, Math.min(2 * place + 1, low.length - 1)];
        lower[place] = low[a] <= low[b] || low[b] !== low[b] ? low[a] : low[b];
        higher[place] = high[a] >= high[b] || high[b] !== high[b] ? high[a] : high[b];
      }
      levels.push([lower, higher]);
    }
    return levels;
  }
  function firstAtLeast(values, wanted) {
    let [from, to] = [0, values.length];
    while (from < to) {
      const middle = (from + to) >> 1;
      if (values[middle] < wanted) from = middle + 1; else to = middle;
    }
    return from;
  }
  const orGap = (value) => (value !== value ? null : value);

  // ---- what is shown

  const timed = page.plots.filter((plot) => plot.x.time);
  const whole = [0, 0];
  for (const plot of timed) {
    const times = xs[plot.xs];
    if (times.length) whole[1] = Math.max(whole[1], times[times.length - 1]);
  }
  // Zooming in ends at a few samples.
  const SHORTEST_SAMPLES = 4;
  const intervals = timed.map((plot) => xs[plot.xs].length - 1).filter((count) => count > 0);
  const shortest = SHORTEST_SAMPLES * whole[1] / Math.max(SHORTEST_SAMPLES, ...intervals);
  let view = whole.slice();
  const shut = { cables: new Set(), roles: new Set() };
  const live = [];
  const byId = new Map();
  const hiddenByBar = (trace) => shut.roles.has(trace.role) || (trace.cable !== null && shut.cables.has(trace.cable));
  const hiddenHere = (shown, trace) => shown.shut.has(trace) || hiddenByBar(trace);
  function tellLegend(shown) {
    for (const [trace, key] of shown.keys) {
      key.setAttribute("aria-pressed", String(!hiddenHere(shown, trace)));
      key.disabled = hiddenByBar(trace);
    }
  }

  function setView(from, to) {
    const length = Math.min(Math.max(to - from, shortest), whole[1] - whole[0]);
    const start = Math.min(Math.max(0.5 * (from + to - length), whole[0]), whole[1] - length);
    view = [start, start + length];
    tell();
    for (const shown of live) if (shown.plot.x.time) shown.stale = true;
    later();
  }
  function zoom(factor, about = 0.5 * (view[0] + view[1])) {
    setView(about - (about - view[0]) * factor, about + (view[1] - about) * factor);
  }
  const pan = (share) => setView(view[0] + share * (view[1] - view[0]), view[1] + share * (view[1] - view[0]));

  // A plot is drawn where it comes near the screen.
  function isNear(figure) {
    const { top, bottom, width } = figure.getBoundingClientRect();
    return width > 0 && bottom > -400 && top < window.innerHeight + 400;
  }
  let waiting = false;
  function later() {
    if (waiting) return;
    waiting = true;
    const run = () => {
      if (!waiting) return;
      waiting = false;
      for (const shown of live) if (shown.stale && isNear(shown.figure)) draw(shown);
    };
    // With the next frame, or soon where no frames are drawn.
    requestAnimationFrame(run);
    setTimeout(run, 100);
  }

  // ---- one plot

  // The points of a plot within the view, and their columns: least and greatest of a band are two.
  function columns(shown) {
    const { plot } = shown;
    const all = xs[plot.xs];
    let [from, to, level] = [0, all.length, 0];
    if (plot.x.time) {
      from = Math.max(0, firstAtLeast(all, view[0]) - 1);
      to = Math.min(all.length, firstAtLeast(all, view[1]) + 1);
      const most = Math.max(2 * shown.width(), 200);
      while ((to - from) >> level > most && level + 1 < shown.depth) level++;
    }
    const [first, last] = [from >> level, ((to - 1) >> level) + 1];
    const times = [];
    for (let place = first; place < last; place++) times.push(all[place << level]);
    const slice = (values) => Array.from(values.subarray(first, last), orGap);
    const made = [times];
    for (const trace of plot.traces) {
      const levels = trace.levels[Math.min(level, trace.levels.length - 1)];
      for (const values of levels) made.push(slice(values));
    }
    return made;
  }

  function prepare(plot) {
    for (const trace of plot.traces) {
      const { y, half, least, greatest } = trace.values;
      if (least) {
        trace.levels = pyramid(decode(least), decode(greatest));
      } else if (half) {
        const [mean, off] = [decode(y), decode(half)];
        trace.levels = [[mean, mean.map((value, place) => value - off[place]), mean.map((value, place) => value + off[place])]];
        trace.mean = mean; trace.half = off;
      } else if (plot.x.time) {
        const values = decode(y);
        trace.levels = pyramid(values, values);
      } else {
        trace.levels = [[decode(y)]];
      }
    }
    return Math.max(1, ...plot.traces.map((trace) => trace.levels.length));
  }

  function text(plot, value) {
    return value === null || value === undefined || value !== value ? "–" : Number(value.toFixed(plot.digits) * 1).toFixed(plot.digits).replace(/^-(0\.?0*)$/, "$1").replace("-", "−");
  }
  const withUnit = (axis, number) => (axis.unit ? `${number} ${axis.unit}` : number);
  const shortX = (plot, value) => (plot.x.time ? value.toFixed(view[1] - view[0] < 2 ? 4 : 3) : String(Number(value.toPrecision(4))).replace("-", "−"));

  // Values lie over the chart, on the side where the mouse is not, so that they move nothing.
  function readout(shown) {
    const { plot, chart, box } = shown;
    const at = chart.cursor.idx;
    const isOver = at !== null && at !== undefined && chart.cursor.left >= 0;
    box.hidden = !isOver;
    if (!isOver) return;
    shown.place.textContent = `${plot.x.name} ${withUnit(plot.x, shortX(plot, chart.data[0][at]))}`;
    let column = 1;
    for (const [trace, output] of shown.outputs) {
      const count = trace.levels[0].length;
      const values = chart.data.slice(column, column + count).map((one) => one[at]);
      column += count;
      let words;
      if (trace.half) words = values[0] === null ? "–" : `${text(plot, values[0])} ± ${text(plot, trace.half[at])}`;
      else if (count === 1 || text(plot, values[0]) === text(plot, values[1])) words = text(plot, values[0]);
      else words = `${text(plot, values[0])} … ${text(plot, values[1])}`;
      output.textContent = withUnit(plot.y, words);
      output.parentElement.hidden = hiddenHere(shown, trace);
    }
    const over = chart.over;
    const isLeft = chart.cursor.left > 0.5 * over.clientWidth;
    box.style.top = `${over.offsetTop + 4}px`;
    box.style.left = isLeft ? `${over.offsetLeft + 4}px` : "";
    box.style.right = isLeft ? "" : `${shown.area.clientWidth - over.offsetLeft - over.clientWidth + 4}px`;
  }

  function marks(chart, plot) {
    const { ctx, bbox } = chart;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const at = (x) => chart.valToPos(x, "x", true);
    for (const [from, to] of plot.looks) {
      ctx.globalAlpha = 0.16;
      ctx.fillStyle = color("flag");
      const width = Math.max(at(to) - at(from), 2);
      ctx.fillRect(at(from), bbox.top, width, bbox.height);
    }
    ctx.globalAlpha = 0.75;
    ctx.fillStyle = color("soft");
    for (const [from, to] of plot.strips) ctx.fillRect(at(from), bbox.top + bbox.height - 5 * uPlot.pxRatio, Math.max(at(to) - at(from), 1), 5 * uPlot.pxRatio);
    ctx.globalAlpha = 1;
    ctx.strokeStyle = ctx.fillStyle = color("text");
    ctx.lineWidth = uPlot.pxRatio;
    ctx.font = `${12 * uPlot.pxRatio}px system-ui, sans-serif`;
    ctx.setLineDash([2 * uPlot.pxRatio, 3 * uPlot.pxRatio]);
    const line = (x0, y0, x1, y1) => { ctx.beginPath(); ctx.moveTo(x0, y0); ctx.lineTo(x1, y1); ctx.stroke(); };
    for (const [x, words] of plot.uprights) {
      line(at(x), bbox.top, at(x), bbox.top + bbox.height);
      ctx.textAlign = at(x) > bbox.left + 0.7 * bbox.width ? "right" : "left";
      ctx.fillText(words, at(x) + (ctx.textAlign === "left" ? 4 : -4) * uPlot.pxRatio, bbox.top + 12 * uPlot.pxRatio);
    }
    for (const [y, words] of plot.levels) {
      const height = chart.valToPos(y, "y", true);
      line(bbox.left, height, bbox.left + bbox.width, height);
      ctx.textAlign = "right";
      ctx.fillText(words, bbox.left + bbox.width - 4 * uPlot.pxRatio, height - 4 * uPlot.pxRatio);
    }
    ctx.restore();
  }

  // Powers of ten, with 2 and 5 times these where there is room; round steps in a range so short that it holds fewer than two of them.
  function decades(least, greatest, most) {
    const exponents = [];
    for (let one = Math.floor(Math.log10(least)); one <= Math.ceil(Math.log10(greatest)); one++) exponents.push(one);
    const ticks = (factors) => exponents.flatMap((one) => factors.map((factor) => Number(`${factor}e${one}`))).filter((tick) => tick >= least && tick <= greatest);
    const all = ticks([1, 2, 5]);
    if (all.length >= 2) return all.length <= most || ticks([1]).length < 2 ? all : ticks([1]);
    const raw = (greatest - least) / Math.max(most, 2);
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= raw);
    const even = [];
    for (let place = Math.ceil(least / step); place * step <= greatest; place++) even.push(place * step);
    return even;
  }

  const heightOf = (plot) => plot.height + 30;
  function options(shown) {
    const { plot } = shown;
    const series = [{}];
    const bands = [];
    for (const trace of plot.traces) {
      const stroke = () => color(trace.color);
      const faint = () => color(trace.color) + "38";
      const solid = { stroke, width: 1.8, dash: trace.dashed ? [6, 4] : undefined, points: { show: false } };
      const first = series.length;
      if (trace.values.half) {
        series.push(solid, { stroke: null, points: { show: false } }, { stroke: null, points: { show: false } });
        bands.push({ series: [first + 2, first + 1], fill: faint });
      } else if (trace.levels[0].length === 2) {
        series.push({ ...solid, width: 1 }, { ...solid, width: 1 });
        bands.push({ series: [first + 1, first], fill: stroke });
      } else {
        series.push(solid);
      }
    }
    const axis = (of, most) => ({
      stroke: () => color("soft"), font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", labelSize: 20, size: of === plot.x ? 32 : of.log ? 66 : 56,
      label: `${of.name}${of.unit ? ` [${of.unit}]` : ""}${of.log ? ", logarithmic" : ""}`,
      values: (chart, ticks) => ticks.map((tick) => String(Number(tick.toPrecision(6))).replace("-", "−")),
      ...(of.log ? { splits: (chart, place, least, greatest) => decades(least, greatest, most()), filter: (chart, ticks) => ticks } : {}),
      grid: { stroke: () => color("line"), width: 1 }, ticks: { stroke: () => color("line"), width: 1, size: 4 },
    });
    return {
      width: shown.width(), height: heightOf(plot), series, bands, legend: { show: false },
      scales: {
        x: { time: false, distr: plot.x.log ? 3 : 1, range: plot.x.time ? () => view.slice() : undefined },
        y: { distr: plot.y.log ? 3 : 1, range: (chart, least, greatest) => heights(plot, chart, least, greatest) },
      },
      axes: [axis(plot.x, () => shown.width() / 56), axis(plot.y, () => plot.height / 34)],
      cursor: {
        y: false, drag: { x: true, y: false, setScale: !plot.x.time },
        sync: plot.x.time ? { key: "time", setSeries: false, filters: { pub: (kind) => kind === "mousemove" || kind === "mouseleave" } } : undefined,
        bind: { mousedown: (chart, target, handler) => (event) => (event.shiftKey ? drag(chart, plot, event) : handler(event)),
                dblclick: (chart, target, handler) => (event) => (plot.x.time ? setView(...whole) : handler(event)) },
      },
      hooks: {
        setSelect: [(chart) => {
          const { left, width } = chart.select;
          if (!plot.x.time || width < 3) return;
          const [from, to] = [chart.posToVal(left, "x"), chart.posToVal(left + width, "x")];
          chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          setView(from, to);
        }],
        setCursor: [() => readout(shown)],
        draw: [(chart) => {
          marks(chart, plot);
          [shown.figure.dataset.from, shown.figure.dataset.to] = [chart.scales.x.min, chart.scales.x.max];
        }],
      },
    };
  }

  // Plots that are compared keep their scale; what is zoomed into can be spread to the height.
  let fits = false;
  function heights(plot, chart, least, greatest) {
    if (!fits || least === null || plot.y.log) return plot.y.span;
    const margin = 0.06 * (greatest - least) || 1e-9;
    return [least - margin, greatest + margin];
  }

  function drag(chart, plot, event) {
    event.preventDefault();
    const [start, from, perPixel] = [event.clientX, view.slice(), (view[1] - view[0]) / chart.over.clientWidth];
    if (!plot.x.time) return;
    const move = (now) => setView(from[0] - (now.clientX - start) * perPixel, from[1] - (now.clientX - start) * perPixel);
    const end = () => { document.removeEventListener("mousemove", move); document.removeEventListener("mouseup", end); };
    document.addEventListener("mousemove", move);
    document.addEventListener("mouseup", end);
  }

  // Two fingers spread or move the time axis; one scrolls the page.
  function touch(chart, plot) {
    let last = null;
    const fingers = (event) => {
      const [a, b] = [event.touches[0].clientX, event.touches[1].clientX].map((x) => x - chart.over.getBoundingClientRect().left);
      return { middle: chart.posToVal(0.5 * (a + b), "x"), apart: Math.max(Math.abs(a - b), 10) };
    };
    chart.over.addEventListener("touchmove", (event) => {
      if (event.touches.length !== 2) return;
      event.preventDefault();
      const now = fingers(event);
      if (last) {
        const [factor, moved] = [last.apart / now.apart, last.middle - now.middle];
        setView(now.middle - (now.middle - view[0]) * factor + moved, now.middle + (view[1] - now.middle) * factor + moved);
      }
      last = { apart: now.apart, middle: chart.posToVal(0.5 * (event.touches[0].clientX + event.touches[1].clientX) - chart.over.getBoundingClientRect().left, "x") };
    }, { passive: false });
    chart.over.addEventListener("touchend", () => { last = null; });
  }

  function draw(shown) {
    shown.stale = false;
    const data = columns(shown);
    if (!shown.chart) {
      shown.chart = new uPlot(options(shown), data, shown.area);
      const over = shown.chart.over;
      over.addEventListener("wheel", (event) => {
        if (!shown.plot.x.time || !(event.ctrlKey || event.metaKey || event.shiftKey)) return;
        event.preventDefault();
        if (event.shiftKey) return pan(0.1 * Math.sign(event.deltaY || event.deltaX));
        zoom(event.deltaY > 0 ? 1.25 : 0.8, shown.chart.posToVal(event.clientX - over.getBoundingClientRect().left, "x"));
      }, { passive: false });
      if (shown.plot.x.time) touch(shown.chart, shown.plot);
    } else {
      shown.chart.setData(data, shown.plot.x.time);
    }
    let column = 1;
    for (const trace of shown.plot.traces) {
      const isShown = !hiddenHere(shown, trace);
      for (let part = 0; part < trace.levels[0].length; part++, column++) {
        if (shown.chart.series[column].show !== isShown) shown.chart.setSeries(column, { show: isShown });
      }
    }
    if (!shown.plot.x.time) shown.chart.redraw(false);
  }

  const swatch = (trace) => element("span", { class: `key${trace.dashed ? " dashed" : ""}`, style: `background: var(--${trace.color})` });
  // A long list of values stands in columns.
  const MOST_ROWS = 9;
  function show(plot) {
    const figure = document.getElementById(plot.id);
    const place = element("output", { class: "at" });
    const box = element("div", { class: "readout", hidden: "" }, place);
    const legend = element("div", { class: "switches", role: "group", "aria-label": "Lines of the chart" });
    const area = element("div", { class: "area", role: "group", "aria-label": plot.caption }, box);
    const shown = { plot, figure, place, box, area, shut: new Set(), keys: new Map(), outputs: new Map(), stale: true, depth: prepare(plot) };
    for (const trace of plot.traces) {
      const button = element("button", { type: "button", "aria-pressed": "true" }, swatch(trace), trace.name);
      button.addEventListener("click", () => {
        if (!shown.shut.delete(trace)) shown.shut.add(trace);
        tellLegend(shown);
        draw(shown);
      });
      shown.keys.set(trace, button);
      legend.append(button);
      const output = element("output");
      shown.outputs.set(trace, output);
      box.append(element("div", {}, swatch(trace), trace.name, " ", output));
    }
    box.style.gridTemplateRows = `repeat(${Math.min(plot.traces.length, MOST_ROWS) + 1}, auto)`;
    // Charts that are not drawn yet take their height too.
    area.style.minHeight = `${heightOf(plot)}px`;
    shown.width = () => Math.max(Math.floor(area.clientWidth), 240);
    if (plot.x.time) {
      area.tabIndex = 0;
      area.addEventListener("keydown", (event) => {
        const act = { ArrowLeft: () => pan(-0.2), ArrowRight: () => pan(0.2), "+": () => zoom(0.5), "-": () => zoom(2), 0: () => setView(...whole) }[event.key];
        if (!act) return;
        event.preventDefault();
        act();
      });
    }
    figure.querySelector(".chart").before(element("div", { class: "live" }, legend, area));
    figure.classList.add("is-live");
    live.push(shown);
    byId.set(plot.id, shown);
    resized.observe(area);
    figure.shown = shown;
  }
  const resized = new ResizeObserver((entries) => {
    for (const entry of entries) {
      const { shown } = entry.target.closest("figure");
      if (!shown.chart || shown.chart.width === shown.width()) continue;
      shown.chart.setSize({ width: shown.width(), height: shown.chart.height });
      shown.stale = true;
    }
    later();
  });

  // ---- the bar

  const span = element("output", { class: "span" });
  function tell() {
    const digits = view[1] - view[0] < 2 ? 3 : 1;
    span.textContent = `${view[0].toFixed(digits)} … ${view[1].toFixed(digits)} s`;
  }
  function refresh() {
    for (const shown of live) {
      shown.stale = true;
      tellLegend(shown);
    }
    later();
  }
  const button = (label, title, act) => {
    const made = element("button", { type: "button", title, "aria-label": title }, label);
    made.addEventListener("click", act);
    return made;
  };
  // The first words of a legend, `before` of `before: given model`, name what has the same role in all charts.
  const roleName = (trace) => trace.name.split(/[:,]/)[0];
  function toggle(label, closed, what, also = () => {}) {
    const made = element("button", { type: "button", "aria-pressed": "true", "data-toggle": label }, label);
    made.addEventListener("click", () => {
      if (!closed.delete(what)) closed.add(what);
      made.setAttribute("aria-pressed", String(!closed.has(what)));
      also(closed.has(what));
      refresh();
    });
    return made;
  }
  function bar() {
    const groups = [];
    if (timed.length) {
      const fit = element("button", { type: "button", "aria-pressed": "false", title: "Spread what is shown to the height of each chart" }, "fit heights");
      fit.addEventListener("click", () => { fits = !fits; fit.setAttribute("aria-pressed", String(fits)); refresh(); });
      groups.push(element("span", { class: "group", role: "group", "aria-label": "Time axis" }, button("←", "Earlier", () => pan(-0.5)), button("→", "Later", () => pan(0.5)),
        button("+", "Zoom in", () => zoom(0.5)), button("−", "Zoom out", () => zoom(2)), button("all", "The whole log", () => setView(...whole)), span, fit));
    }
    const names = new Map();
    for (const trace of page.plots.flatMap((plot) => plot.traces)) if (/^(before|after)$/.test(trace.role) && !names.has(trace.role)) names.set(trace.role, roleName(trace));
    if (names.size > 1) {
      groups.push(element("span", { class: "group", role: "group", "aria-label": "Models" }, ...[...names].map(([role, name]) => toggle(name, shut.roles, role))));
    }
    if (page.cables.length > 1) {
      const ofCable = (cable) => (isShut) => document.querySelectorAll(`[data-cable="${cable}"]`).forEach((part) => { part.hidden = isShut; });
      groups.push(element("span", { class: "group cables", role: "group", "aria-label": "Cables" }, ...page.cables.map((name, cable) => toggle(name, shut.cables, cable, ofCable(cable)))));
    }
    const nav = document.querySelector("nav");
    const bars = element("div", { class: "bars" });
    (nav || document.querySelector("[data-evidence]")).after(bars);
    if (nav) bars.append(nav);
    if (groups.length) bars.append(element("div", { class: "tools", role: "toolbar", "aria-label": "Charts" }, ...groups));
    const inTime = "Those over time also: shift and drag to move; with ctrl the wheel zooms, with the keyboard ← → + − 0.";
    bars.after(element("p", { class: "soft hint" }, `Charts: drag to zoom, double click for all.${timed.length ? ` ${inTime}` : ""}`));
    // What a link leads to stands below the bars.
    const measure = () => {
      const isSticky = getComputedStyle(bars).position === "sticky";
      root.style.setProperty("--bars", `${isSticky ? bars.offsetHeight : 0}px`);
    };
    new ResizeObserver(measure).observe(bars);
    measure();
    tell();
  }

  document.addEventListener("click", (event) => {
    const link = event.target.closest("[data-look]");
    if (!link) return;
    event.preventDefault();
    const [from, to] = link.dataset.look.split(" ").map(Number);
    const margin = Math.max(0.5 * (to - from), 0.002 * whole[1]);
    setView(from - margin, to + margin);
    const target = document.getElementById(link.getAttribute("href").slice(1));
    if (target) target.scrollIntoView({ block: "center" });
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => live.forEach((shown) => shown.chart && shown.chart.redraw(false)));

  bar();
  page.plots.forEach(show);
  document.addEventListener("scroll", later, { passive: true });
  later();
})();
