"use strict";

(() => {
  const byId = (id) => document.getElementById(id);
  const all = (selector) => document.querySelectorAll(selector);
  const page = JSON.parse(byId("page-data").textContent);
  const state = { variant: page.primary, tolerance: page.tolerance_index, picked: null };
  let scene = null;

  const toleranceUm = () => page.thresholds_um[state.tolerance];
  const short = (value) => String(Number(value.toPrecision(3)));
  const signed = (um) => {
    const plus = page.variants[state.variant].is_signed ? "+" : "";
    const text = page.decimals === null ? Math.abs(um).toExponential(1) : Math.abs(um).toFixed(page.decimals);
    return (Number(text) === 0 ? "" : um < 0 ? "−" : plus) + text;
  };

  function element(tag, text, className) {
    const made = document.createElement(tag);
    if (text !== undefined) made.textContent = text;
    if (className) made.className = className;
    return made;
  }

  // ---- figures, tables, histograms: these work without the map

  function showVariant(name) {
    const before = page.variants[state.variant].range_um;
    state.variant = name;
    if (page.variants[name].range_um !== before) { // another scale: deviations, or measured minus predicted
      byId("range").value = standardAt();
      showRange();
    }
    for (const block of all("[data-for]")) block.hidden = block.dataset.for !== name;
    scene?.show(name);
    makeMarks();
    fillFlag();
  }

  function showTolerance(index) {
    state.tolerance = index;
    const um = toleranceUm();
    byId("tolerance-text").textContent = short(um);
    byId("tolerance").setAttribute("aria-valuetext", short(um) + " µm");
    for (const text of all(".tolerance-value")) text.textContent = short(um);
    for (const cell of all("[data-outside]")) {
      const { weight, outside } = page.variants[cell.dataset.outside];
      cell.textContent = weight ? ((100 * outside[index]) / weight).toFixed(2) + " %" : "–";
    }
    for (const svg of all("svg[data-end-um]")) {
      const half = Math.min(320, (320 * um) / Number(svg.dataset.endUm));
      const band = svg.querySelector(".band");
      band.setAttribute("x", 320 - half);
      band.setAttribute("width", 2 * half);
      svg.querySelectorAll("line.limit").forEach((line, i) => {
        for (const end of ["x1", "x2"]) line.setAttribute(end, 320 + (2 * i - 1) * half);
      });
    }
    scene?.setLook({ tolerance: um });
    placeLimits();
  }

  function placeLimits() {
    const share = toleranceUm() / rangeUm();
    for (const limit of all("#ramp .limit")) {
      limit.hidden = share > 1 || !page.variants[state.variant].is_signed;
      limit.style.top = `calc(${50 - 50 * share * Number(limit.dataset.sign)}% - 1px)`;
    }
  }

  // ---- colour scale: the slider runs from a tenth of the standard range to all there is

  function rangeUm() {
    const { range_um, largest_um } = page.variants[state.variant];
    const low = range_um / 10, ratio = Math.max(largest_um, 2 * range_um) / low, at = Number(byId("range").value);
    if (at === standardAt()) return range_um;
    return Number((low * ratio ** (at / 100)).toPrecision(2));
  }

  function standardAt() {
    const { range_um, largest_um } = page.variants[state.variant];
    return Math.round((100 * Math.log(10)) / Math.log(Math.max((10 * largest_um) / range_um, 20)));
  }

  function showRange() {
    const end = rangeUm();
    byId("range-text").textContent = short(end);
    byId("range").setAttribute("aria-valuetext", short(end) + " µm");
    const { is_signed } = page.variants[state.variant]; // sizes begin at 0 and take no sign
    byId("ticks").replaceChildren(...Array.from({ length: 9 }, (_, i) => {
      const value = end * (1 - i / (is_signed ? 4 : 8));
      const tick = element("li", value === 0 ? "0" : (!is_signed ? "" : value < 0 ? "−" : "+") + short(Math.abs(value)) + (i === 0 ? " µm" : ""));
      tick.style.top = 12.5 * i + "%";
      return tick;
    }));
    scene?.setLook({ range: end });
    placeLimits();
  }

  // ---- marks over the map: ten worst places, the picked point, the directions of the axes

  function makeMarks() {
    if (!scene) return;
    const worst = byId("worst-marks").checked ? page.variants[state.variant].worst : [];
    const marks = worst.map((point, i) => Object.assign(element("div", String(i + 1), "mark"), { point }));
    if (state.picked !== null) marks.unshift(Object.assign(element("div", "", "mark dot"), { point: pointAt(state.picked) }));
    byId("marks").replaceChildren(...marks, ...makeFlags());
    placeMarks();
    hideCovered();
  }

  // flags of the drawing stand away from the middle of the view, on a leader line
  function makeFlags() {
    if (!byId("drawing-flags")?.checked) return [];
    return page.flags.map(({ places, title, value, verdict }) => {
      const flag = Object.assign(element("div", undefined, "callout " + verdict), { point: places[0], places });
      const text = element("span", title);
      text.append(element("br"), value);
      flag.append(element("i"), text);
      return flag;
    });
  }

  function leanFlag(flag, x, y) {
    const view = byId("canvas");
    const angle = Math.atan2(y - view.clientHeight / 2, x - view.clientWidth / 2);
    const [, text] = flag.children;
    const inside = (at, size, room) => Math.max(size / 2 + 4, Math.min(room - size / 2 - 4, at));
    // flags are wider than high, and stay within the view
    const right = inside(x + 150 * Math.cos(angle), text.offsetWidth, view.clientWidth) - x;
    const down = inside(y + 60 * Math.sin(angle), text.offsetHeight, view.clientHeight) - y;
    drawLeader(flag, text, right, down);
  }

  // Flags that would cover each other are moved apart, up and down; none leaves the view.
  function parcelFlags() {
    const shown = [...byId("marks").children].filter((mark) => mark.matches(".callout") && mark.style.visibility !== "hidden");
    const boxes = shown.map((flag) => {
      const [, text] = flag.children, [x, y] = scene.toScreen(flag.point.at);
      return { flag, x, y, text, across: x + parseFloat(text.style.left), at: y + parseFloat(text.style.top), width: text.offsetWidth + 4, height: text.offsetHeight + 4 };
    }).sort((one, other) => one.at - other.at);
    const meet = (one, other) => Math.abs(one.across - other.across) < (one.width + other.width) / 2;
    for (const order of [boxes, [...boxes].reverse()])
      order.forEach((one, i) => order.slice(0, i).forEach((other) => {
        const room = (one.height + other.height) / 2, way = order === boxes ? 1 : -1;
        if (!meet(one, other) || way * (one.at - other.at) >= room) return;
        const bottom = byId("canvas").clientHeight - one.height / 2, wanted = other.at + way * room;
        one.at = Math.max(one.height / 2, Math.min(bottom, wanted));
      }));
    for (const { flag, x, y, text, across, at } of boxes) drawLeader(flag, text, across - x, at - y);
  }

  function drawLeader(flag, text, right, down) {
    const [line] = flag.children;
    line.style.width = Math.hypot(right, down) + "px";
    line.style.transform = `rotate(${Math.atan2(down, right)}rad)`;
    text.style.left = right + "px";
    text.style.top = down + "px";
  }

  function placeMarks() {
    for (const mark of byId("marks").children) {
      if (mark.places && !faces(mark.point)) mark.point = mark.places.find(faces) ?? mark.point;
      const [x, y] = scene.toScreen(mark.point.at);
      if (mark.classList.contains("callout")) leanFlag(mark, x, y);
      mark.style.transform = `translate(${x}px, ${y}px)`;
      mark.style.visibility = faces(mark.point) ? "" : "hidden";
    }
    parcelFlags();
    if (state.picked !== null) placeFlag();
    byId("triad").innerHTML = triad(scene);
  }

  const faces = ({ normal }) => dot(scene.axes()[2], normal) > 0.02;

  function hideCovered() {
    for (const mark of byId("marks").children) {
      if (scene.sees(mark.point.at)) continue;
      const seen = mark.places?.find((place) => faces(place) && scene.sees(place.at));
      if (!seen) mark.style.visibility = "hidden";
      else moveFlag(mark, seen);
    }
    parcelFlags();
  }

  function moveFlag(flag, place) {
    const [x, y] = scene.toScreen(place.at);
    flag.point = place;
    flag.style.transform = `translate(${x}px, ${y}px)`;
    flag.style.visibility = "";
    leanFlag(flag, x, y);
  }

  // ---- what a click finds

  const pointAt = (i) => ({
    at: Array.from(scene.model.points.subarray(3 * i, 3 * i + 3)),
    normal: Array.from(scene.model.pointNormals.subarray(3 * i, 3 * i + 3)),
  });

  function pickNear(place, normal) {
    const found = scene.model.nearestPoint(place, normal);
    state.picked = found < 0 ? null : found;
    fillFlag();
    makeMarks();
  }

  function fillFlag() {
    const flag = byId("flag"), i = state.picked;
    flag.hidden = i === null;
    if (i === null || !scene) return;
    const { model } = scene, c = model.columns;
    const rows = element("table");
    for (const [name, variant] of Object.entries(page.variants)) {
      const um = model.deviation("point:" + name, i);
      const row = element("tr", undefined, name === state.variant ? "shown" : "");
      row.append(element("td", variant.label),
        element("td", um === null ? model.statuses[c["status:" + name][i]] : signed(um) + " µm"));
      rows.append(row);
    }
    const line = c.point_line[i];
    const place = pointAt(i).at.map((x) => x.toFixed(2).replace("-", "−")).join(", ");
    flag.replaceChildren(
      element("p", `${model.ids[i]} · ${model.features[c.point_feature[i]]}`), rows,
      element("p", `at ${place} mm`),
      element("p", line > 0 ? `tool ${c.point_tool[i]}, line ${line}` : "no move made this point"),
      element("code", model.nc[line] ?? ""));
    placeFlag();
  }

  function placeFlag() {
    const flag = byId("flag"), view = byId("canvas"), { at, normal } = pointAt(state.picked), [x, y] = scene.toScreen(at);
    const inView = x >= 0 && y >= 0 && x <= view.clientWidth && y <= view.clientHeight;
    flag.style.visibility = inView && dot(scene.axes()[2], normal) > 0.02 ? "" : "hidden";
    const left = x + 16 + flag.offsetWidth > view.clientWidth ? x - 16 - flag.offsetWidth : x + 16;
    const top = Math.max(8, Math.min(view.clientHeight - flag.offsetHeight - 8, y - flag.offsetHeight / 2));
    flag.style.left = Math.max(8, left) + "px";
    flag.style.top = top + "px";
  }

  // ---- controls

  function pickAt(x, y) {
    const hit = scene.pick(x, y);
    if (hit) return pickNear(hit.place, hit.normal);
    state.picked = null;
    fillFlag();
    makeMarks();
  }

  function listenToControls() {
    for (const input of all("input[name=variant]")) input.addEventListener("change", () => showVariant(input.value));
    byId("tolerance").addEventListener("input", (event) => showTolerance(Number(event.target.value)));
    byId("range").addEventListener("input", showRange);
    byId("grey").addEventListener("change", (event) => scene.setLook({ greyWithin: event.target.checked }));
    byId("worst-marks").addEventListener("change", makeMarks);
    byId("drawing-flags")?.addEventListener("change", makeMarks);
    for (const button of all("button[data-at]")) button.addEventListener("click", () => {
      if (!scene) return;
      const [at, normal] = [button.dataset.at, button.dataset.normal].map((text) => text.split(" ").map(Number));
      scene.face({ at, normal });
      pickNear(at, normal);
      byId("stage").scrollIntoView({ block: "center" });
    });
    for (const button of all("[data-view]")) button.addEventListener("click", () => scene.home(...VIEWS[button.dataset.view]));
    for (const row of all("tr[data-worst]")) row.querySelector("button").addEventListener("click", () => {
      if (!scene) return;
      const point = page.variants[state.variant].worst[Number(row.dataset.worst)];
      scene.face(point);
      pickNear(point.at, point.normal);
      byId("stage").scrollIntoView({ block: "center" });
    });
  }

  function showView({ azimuth_rad, elevation_rad, zoom, target_mm, section }) {
    Object.assign(scene, { azimuth: azimuth_rad, elevation: elevation_rad, zoom, target: target_mm });
    scene.setLook({ section });
  }

  async function start() {
    byId("tolerance").max = page.thresholds_um.length - 1;
    byId("tolerance").value = state.tolerance;
    byId("range").value = standardAt();
    listenToControls();
    try {
      const model = new Model(await readPayload(byId("payload").textContent));
      byId("stage").hidden = false;
      scene = new Scene(byId("canvas"), model, page.colour_stops, page.unknown_colour);
      scene.onDraw = placeMarks;
      scene.onSettle = hideCovered;
      if (page.view) showView(page.view);
      listenToGestures(byId("canvas"), scene, pickAt);
      byId("still").hidden = true;
    } catch (error) {
      scene = null;
      byId("stage").hidden = true;
      byId("still-note").textContent = `The turnable map is not available in this browser: ${error.message}.`;
    }
    showRange();
    showTolerance(state.tolerance);
    showVariant(state.variant);
  }
  start();
})();
