'use strict';
// The page around the 3D view: the section at a station, chosen by slider, by a click on a plot or in the 3D view; and
// what a print must show.
(function () {
  const SVG = 'http://www.w3.org/2000/svg';
  const WIDTH = 390, HEIGHT = 330, LEFT = 58, RIGHT = 14, TOP = 10, BOTTOM = 40;
  const seams = JSON.parse(document.getElementById('sections').textContent);

  const element = (name, attributes, text) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  // Pairs of 16-bit steps, the largest being `reach`.
  const unpack = (base64, reach) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const steps = new Int16Array(bytes.buffer), points = [];
    for (let i = 0; i < steps.length; i += 2) points.push([steps[i] * reach / 32767, steps[i + 1] * reach / 32767]);
    return points;
  };
  const signed = (value) => {
    const size = Math.abs(value).toFixed(3);
    return (Number(size) === 0 ? '' : value < 0 ? '−' : '+') + size;
  };

  // ---------------------------------------------------------------------------------------------------- the section
  // Both axes at one scale, so that angles are true; as near as the points allow.
  function frameOf(points) {
    const low = [0, 1].map((k) => Math.min(...points.map((p) => p[k])));
    const high = [0, 1].map((k) => Math.max(...points.map((p) => p[k])));
    const inner = [WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM];
    const scale = Math.min(...[0, 1].map((k) => inner[k] / Math.max(1.08 * (high[k] - low[k]), 1e-3)));
    const middle = [0, 1].map((k) => (low[k] + high[k]) / 2);
    const half = inner.map((size) => size / 2 / scale);
    return { low: middle.map((m, k) => m - half[k]), high: middle.map((m, k) => m + half[k]),
      x: (u) => LEFT + inner[0] / 2 + scale * (u - middle[0]), y: (v) => TOP + inner[1] / 2 - scale * (v - middle[1]) };
  }

  function ticks(low, high) {
    const raw = (high - low) / 5, power = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = power * (raw / power < 1.5 ? 1 : raw / power < 3.5 ? 2 : raw / power < 7.5 ? 5 : 10);
    const places = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)), list = [];
    for (let k = Math.ceil(low / step); k * step <= high; ++k) list.push([k * step, (k * step).toFixed(places)]);
    return list;
  }

  function drawAxes(svg, frame) {
    const right = WIDTH - RIGHT, bottom = HEIGHT - BOTTOM;
    for (const [u, text] of ticks(frame.low[0], frame.high[0])) {
      svg.append(element('line', { class: 'grid', x1: frame.x(u), y1: TOP, x2: frame.x(u), y2: bottom }));
      svg.append(element('text', { class: 'tick middle', x: frame.x(u), y: bottom + 15 }, text));
    }
    for (const [v, text] of ticks(frame.low[1], frame.high[1])) {
      svg.append(element('line', { class: 'grid', x1: LEFT, y1: frame.y(v), x2: right, y2: frame.y(v) }));
      svg.append(element('text', { class: 'tick end', x: LEFT - 6, y: frame.y(v) + 3.5 }, text));
    }
    svg.append(element('line', { class: 'axis', x1: LEFT, y1: bottom, x2: right, y2: bottom }));
    svg.append(element('line', { class: 'axis', x1: LEFT, y1: TOP, x2: LEFT, y2: bottom }));
    svg.append(element('text', { class: 'label middle', x: (LEFT + right) / 2, y: HEIGHT - 6 }, 'right of travel, mm'));
    svg.append(element('text', { class: 'label middle', transform: `translate(13 ${(TOP + bottom) / 2}) rotate(-90)` },
      'into the air, mm'));
  }

  function drawSection(svg, section, reach) {
    const points = unpack(section.points, reach), traces = section.traces.map((trace) => unpack(trace, reach));
    const frame = frameOf([[0, 0], ...points, ...traces.flat()]);
    const at = ([u, v]) => `${frame.x(u).toFixed(1)} ${frame.y(v).toFixed(1)}`;
    svg.setAttribute('viewBox', `0 0 ${WIDTH} ${HEIGHT}`);
    svg.replaceChildren();
    drawAxes(svg, frame);
    traces.forEach((trace, k) => svg.append(
      element('path', { class: `flank${k + 1} trace`, d: 'M' + trace.map(at).join('L') })));
    svg.append(element('path', { class: 'measured', d: points.map((p) => `M${at(p)}h0`).join('') }));
    svg.append(element('path', { class: 'curve', d: `M${at([0, 0])}m-6 0h12m-6 -6v12` }));
  }

  // ------------------------------------------------------------------------------------------------- at which station
  const panels = [...document.querySelectorAll('figure.section')].map((figure) => ({
    seam: +figure.dataset.of, svg: figure.querySelector('svg'), slider: figure.querySelector('input'),
    note: figure.querySelector('output'), figure }));

  function markPlots(seam, station) {
    for (const svg of document.querySelectorAll(`#seam-${seam} .by-station svg[data-plot]`)) {
      const [left, right, low, high, top, bottom] = svg.dataset.plot.split(' ').map(Number);
      const x = left + (station - low) / (high - low) * (right - left);
      svg.querySelector('.here')?.remove();
      svg.append(element('line', { class: 'here', x1: x, y1: top, x2: x, y2: bottom }));
    }
  }

  function show(panel) {
    const { reach, sections } = seams[panel.seam], section = sections[+panel.slider.value];
    drawSection(panel.svg, section, reach);
    const count = unpack(section.points, reach).length;
    panel.slider.setAttribute('aria-valuetext', `station ${section.station.toFixed(1)} mm`);
    panel.note.textContent = `Station ${section.station.toFixed(1)} mm: deviation ${section.distance.toFixed(3)} ± ` +
      `${section.sigma.toFixed(3)} mm; from flank 1 ${signed(section.flanks[0])}, from flank 2 ` +
      `${signed(section.flanks[1])} mm. ${count} scan points within ±${section.half.toFixed(2)} mm; the cross is the curve.`;
    panel.figure.dataset.station = section.station;
    markPlots(panel.seam, section.station);
    document.dispatchEvent(new CustomEvent('seampath-station', { detail: { seam: panel.seam, station: section.station } }));
  }

  function choose(seam, station) {
    const panel = panels.find((p) => p.seam === seam);
    if (!panel || panel.figure.hidden) return;
    const gaps = seams[seam].sections.map((section) => Math.abs(section.station - station));
    panel.slider.value = gaps.indexOf(Math.min(...gaps));
    show(panel);
  }

  for (const panel of panels) {
    const sections = seams[panel.seam].sections;
    panel.figure.hidden = sections.length === 0;
    if (panel.figure.hidden) continue;
    panel.slider.max = sections.length - 1;
    panel.slider.addEventListener('input', () => show(panel));
    const worst = document.querySelector(`#seam-${panel.seam} button.place`);
    choose(panel.seam, worst ? +worst.dataset.station : sections[0].station);
    for (const figure of document.querySelectorAll(`#seam-${panel.seam} .by-station`)) {
      figure.addEventListener('click', (event) => {
        const svg = figure.querySelector('svg'), box = svg.getBoundingClientRect();
        const [left, right, low, high] = svg.dataset.plot.split(' ').map(Number);
        const x = (event.clientX - box.left) / box.width * svg.viewBox.baseVal.width;
        choose(panel.seam, low + (x - left) / (right - left) * (high - low));
      });
    }
  }
  for (const button of document.querySelectorAll('button.place')) {
    button.addEventListener('click', () => choose(+button.dataset.of, +button.dataset.station));
  }
  document.addEventListener('seampath-pick', (event) => choose(event.detail.seam, event.detail.station));
  document.body.classList.add('scripted');

  // ---------------------------------------------------------------------------------------------------- on paper
  // All seams are printed; what was folded on the screen folds again.
  let unfolded = [];
  addEventListener('beforeprint', () => {
    unfolded = [...document.querySelectorAll('details[id^="seam-"]:not([open])')];
    unfolded.forEach((details) => { details.open = true; });
  });
  addEventListener('afterprint', () => unfolded.forEach((details) => { details.open = false; }));
})();
