"use strict";
// What moves, what is said in words and what is drawn. Every number of the filter comes from the exported functions.

const RANGE = [-3, 3]; // of A, in the plots over A
const SAMPLES = 240;

// ---------------------------------------------------------------------------------------------------- numbers
/** Return the value of a slider: a multiple of 1/per, or a power of ten whose exponent is one; 0 is exactly 0. */
function valueOf(position, scale, per) {
  return scale === "decades" ? Math.pow(10, position / per) : position / per;
}

/** Return the position of a slider at a value. */
function positionOf(value, scale, per) {
  return Math.round(per * (scale === "decades" ? Math.log10(value) : value));
}

/** Return a number as text with four significant digits. */
function shown(x) {
  if (Number.isNaN(x)) return "not defined";
  if (!Number.isFinite(x)) return x > 0 ? "beyond what numbers here can hold" : "−∞";
  const size = Math.abs(x);
  const far = x !== 0 && (size >= 1e5 || size < 1e-3);
  const [digits, power] = far ? x.toExponential(3).split("e") : [x.toPrecision(4), ""];
  const raised = [...power.replace("+", "")].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("");
  return (String(Number(digits)) + (far ? `·10${raised}` : "")).replace("-", "−");
}

// ---------------------------------------------------------------------------------------------------- the filters
/** Return the values of the filter in continuous time, and in words what is special about them. */
function continuous(p) {
  const plant = [p.A, p.C, p.W, p.V];
  const P = care_covariance(...plant);
  return {
    values: {
      P,
      K: care_gain(...plant),
      loop: care_closed_loop(...plant),
      end: riccati_transient(...plant, p.P0, p.T),
      limit: limit(p, p.W, p.A === 0, P),
    },
    words: p.C === 0 ? unseen(p) : p.W === 0 ? unexcited(p) : "",
  };
}

/** Return the values of the filter in discrete time, and in words what is special about them. */
function discrete(p) {
  const plant = [p.A, p.C, p.Q, p.R];
  const M = dare_covariance(...plant);
  return {
    values: {
      M,
      plus: dare_filtered_covariance(...plant),
      L: dare_gain(...plant),
      loop: dare_closed_loop(...plant),
      end: riccati_recursion(...plant, p.P0, p.T),
      limit: limit(p, p.Q, Math.abs(p.A) === 1, M),
    },
    words: p.C === 0 ? unseenSteps(p) : p.Q === 0 ? unexcitedSteps(p) : p.A === 0 ? FORGETFUL : "",
  };
}

/** Return what the covariance tends to, NaN if it grows without bound; some starts stay what they are. */
function limit(p, noise, boundary, steady) {
  const stays = noise === 0 && (p.P0 === 0 || (boundary && p.C === 0));
  return stays ? p.P0 : steady;
}

function unseen(p) {
  if (p.A < 0) return "C = 0: the output does not see the state, and the gain is 0. The state is stable by itself.";
  const none =
    "Not defined here: C = 0, so the output does not see the state, and A ≥ 0, so the state is not stable by itself. " +
    "No gain makes the error stable, and there is no steady covariance. ";
  if (p.W === 0 && p.P0 === 0) return none + "Started without error and not excited, P(t) stays 0.";
  if (p.W === 0 && p.A === 0) return none + "Nothing drives the state: P(t) stays at P(0).";
  return none + "P(t) grows without bound.";
}

function unexcited(p) {
  if (p.A < 0) return "W = 0: nothing excites the stable state. Its error dies out by itself, and the gain is 0.";
  if (p.A === 0 && p.P0 === 0) return "W = 0, A = 0: a double root, at 0. Started without error, P(t) stays 0.";
  if (p.A === 0) return "W = 0, A = 0: a double root, at 0. P(t) falls to it like 1/t, not exponentially.";
  if (p.P0 === 0)
    return (
      "W = 0, P(0) = 0: the state is unstable but neither excited nor uncertain, and P(t) stays 0. " +
      "The smallest error at the start would lead to the stabilising solution P instead."
    );
  return "W = 0: nothing excites the unstable state. The optimal gain mirrors the pole: A − KC = −A.";
}

const FORGETFUL = "A = 0: the state keeps nothing of its past, and one step leads to the steady covariance.";

function unseenSteps(p) {
  const size = Math.abs(p.A);
  if (size < 1) return "C = 0: the output does not see the state, and the gain is 0. The state is stable by itself.";
  const none =
    "Not defined here: C = 0, so the output does not see the state, and |A| ≥ 1, so the state is not stable by " +
    "itself. No gain makes the error stable, and there is no steady covariance. ";
  if (p.Q === 0 && p.P0 === 0) return none + "Started without error and not excited, the covariance stays 0.";
  if (p.Q === 0 && size === 1) return none + "Nothing drives the state: the covariance stays what it was.";
  return none + "The covariance grows without bound.";
}

function unexcitedSteps(p) {
  const size = Math.abs(p.A);
  if (size < 1) return "Q = 0: nothing excites the stable state. Its error dies out by itself, and the gain is 0.";
  if (size === 1 && p.P0 === 0) return "Q = 0, |A| = 1: a double root, at 0. Started without error, it stays 0.";
  if (size === 1) return "Q = 0, |A| = 1: a double root, at 0. The covariance falls to it like 1/k, not exponentially.";
  if (p.P0 === 0)
    return (
      "Q = 0, no error at the start: the state is unstable but neither excited nor uncertain, and the covariance stays " +
      "0. The smallest error at the start would lead to the stabilising solution instead."
    );
  return "Q = 0: nothing excites the unstable state. The optimal gain mirrors the pole: A − LC = 1/A.";
}

// ---------------------------------------------------------------------------------------------------- samples
/** Return points of a function; ``power`` gathers them at the left. */
function sample(f, [low, high], power = 1) {
  return Array.from({ length: SAMPLES + 1 }, (_, i) => {
    const x = low + (high - low) * Math.pow(i / SAMPLES, power);
    return [x, f(x)];
  });
}

/** Return the values of a sequence, from 0 to the last step. */
function sequence(f, last) {
  return Array.from({ length: last + 1 }, (_, k) => [k, f(k)]);
}

/** Return the intervals in which a function is not defined. */
function gaps(points) {
  const found = [];
  points.forEach(([x, y], i) => {
    if (!Number.isNaN(y)) return;
    if (i > 0 && Number.isNaN(points[i - 1][1])) found[found.length - 1][1] = x;
    else found.push([x, x]);
  });
  return found;
}

/** Return the height of a plot: all of the curves, but not all of one that leaves for infinity at a gap. */
function height(curves, others) {
  const finite = curves.map((points) => points.map((p) => p[1]).filter(Number.isFinite).sort((a, b) => a - b));
  const tops = finite.filter((v) => v.length).map((v, i) => {
    const whole = v[v.length - 1];
    return gaps(curves[i]).length ? Math.min(whole, 4 * v[v.length >> 1]) : whole;
  });
  return 1.12 * Math.max(...tops, ...others.filter(Number.isFinite), 0) || 1;
}

/** Return round numbers between two, at most ``most`` and one. */
function ticks(low, high, most) {
  const rough = (high - low) / most;
  const unit = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = unit * [1, 2, 5, 10].find((m) => m * unit >= rough);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); k++) found.push(k * step);
  return found;
}

// ---------------------------------------------------------------------------------------------------- drawings
const FRAME = { left: 46, right: 388, top: 26, bottom: 236 };

/** Return the inside of a drawing: axes, gaps, levels, curves, marks. */
function drawing(plot) {
  const { left, right, top, bottom } = FRAME;
  const [low, high] = plot.range;
  const max = height(plot.curves, [...plot.marks, ...plot.levels].map((m) => m.y));
  const x = (v) => round(left + ((right - left) * (v - low)) / (high - low));
  const y = (v) => round(bottom - (bottom - top) * Math.min(v / max, 1));
  const out = [];
  for (const v of ticks(0, max, 5)) {
    out.push(`<path class="grid" d="M${left} ${y(v)}H${right}"/>`, text(left - 6, y(v) + 4, shown(v), "end"));
  }
  for (const v of ticks(low, high, 8)) {
    out.push(`<path class="tick" d="M${x(v)} ${bottom}v4"/>`, text(x(v), bottom + 18, shown(v), "middle"));
  }
  for (const [from, to] of gaps(plot.curves[0])) {
    out.push(`<rect class="gap" x="${x(from)}" y="${top}" width="${x(to) - x(from)}" height="${bottom - top}"/>`);
    out.push(text((x(from) + x(to)) / 2, (top + bottom) / 2, "not defined", "middle"));
  }
  out.push(`<path class="axis" d="M${left} ${top}V${bottom}H${right}"/>`);
  if (plot.at !== undefined) out.push(`<path class="here" d="M${x(plot.at)} ${top}V${bottom}"/>`);
  for (const level of plot.levels.filter((m) => Number.isFinite(m.y))) {
    out.push(`<path class="level" d="M${left} ${y(level.y)}H${right}"/>`);
    out.push(text(right - 2, y(level.y) + (y(level.y) < top + 20 ? 15 : -5), level.label, "end"));
  }
  plot.curves.forEach((points, i) => out.push(`<path class="curve c${i}" d="${line(points, x, y, max)}"/>`));
  for (const [u, v] of (plot.dots ? plot.curves[0] : []).filter((point) => point[1] <= max)) {
    out.push(`<circle class="dot c0" cx="${x(u)}" cy="${y(v)}" r="2.6"/>`);
  }
  const marks = plot.marks.filter((mark) => Number.isFinite(mark.y));
  const [dx, anchor] = plot.rising && x(plot.at) > left + 90 ? [-9, "end"] : [9, "start"];
  const heights = apart(marks.map((mark) => y(mark.y) - 8));
  marks.forEach((mark, i) => {
    out.push(`<circle class="mark c${i}" cx="${x(mark.x)}" cy="${y(mark.y)}" r="4.5"/>`);
    out.push(text(x(mark.x) + dx, heights[i], mark.label, anchor, `c${i}`));
  });
  return out.join("") + text(left - 38, 13, plot.ylabel, "start", "name") + text(right, 270, plot.xlabel, "end", "name");
}

/** Return the heights of labels, from the top down, so that none lies on another or on the axis. */
function apart(heights) {
  const found = [];
  for (const v of heights) found.push(Math.max(v, FRAME.top + 10, (found.at(-1) ?? 0) + 15));
  const shift = Math.max(0, (found.at(-1) ?? 0) - (FRAME.bottom - 6));
  return found.map((v) => v - shift);
}

/** Return a curve as a path, interrupted where it is not defined or has left the frame. */
function line(points, x, y, max) {
  const inside = (i) => points[i] !== undefined && points[i][1] <= max;
  return points
    .map(([u, v], i) => {
      if (Number.isNaN(v) || !(inside(i - 1) || inside(i) || inside(i + 1))) return "";
      const joined = i > 0 && !Number.isNaN(points[i - 1][1]) && (inside(i - 1) || inside(i));
      return `${joined ? "L" : "M"}${x(u)} ${y(v)}`;
    })
    .join("");
}

function text(x, y, content, anchor, kind = "") {
  return `<text class="${kind}" x="${round(x)}" y="${round(y)}" text-anchor="${anchor}">${content}</text>`;
}

function round(v) {
  return Math.round(10 * v) / 10;
}

/** Return what both transients show: the start, the limit, and the steady covariance where it is not reached. */
function transient(p, steady, limit) {
  const missed = steady !== limit && !Number.isNaN(steady);
  const end = Number.isNaN(limit) ? "it grows without bound." : `its limit is ${shown(limit)}.`;
  return {
    range: [0, p.T],
    marks: [{ x: 0, y: p.P0, label: "" }],
    levels: [
      { y: limit, label: `limit ${shown(limit)}` },
      ...(missed ? [{ y: steady, label: `steady ${shown(steady)}, not reached` }] : []),
    ],
    words: `Covariance over time, from ${shown(p.P0)} at the start; ${end}`,
  };
}

/** Return the drawings of a panel by name, each with what it shows in words. */
const PLOTS = {
  continuous: (p, { P, limit }) => ({
    state: {
      range: RANGE, at: p.A, rising: true, xlabel: "A", ylabel: "P",
      curves: [sample((A) => care_covariance(A, p.C, p.W, p.V), RANGE)],
      marks: [{ x: p.A, y: P, label: `P = ${shown(P)}` }], levels: [],
      words: `Error covariance P over A; at A = ${shown(p.A)} it is ${shown(P)}.`,
    },
    time: {
      ...transient(p, P, limit), xlabel: "t", ylabel: "P(t)",
      curves: [sample((t) => riccati_transient(p.A, p.C, p.W, p.V, p.P0, t), [0, p.T], 2)],
    },
  }),
  discrete: (p, { M, plus, limit }) => ({
    state: {
      range: RANGE, at: p.A, rising: p.A > 0, xlabel: "A", ylabel: "covariance",
      curves: [
        sample((A) => dare_covariance(A, p.C, p.Q, p.R), RANGE),
        sample((A) => dare_filtered_covariance(A, p.C, p.Q, p.R), RANGE),
      ],
      marks: [
        { x: p.A, y: M, label: `before ${shown(M)}` },
        { x: p.A, y: plus, label: `after ${shown(plus)}` },
      ],
      levels: [],
      words: `Over A, at A = ${shown(p.A)}: before the measurement ${shown(M)}, after it ${shown(plus)}.`,
    },
    time: {
      ...transient(p, M, limit), xlabel: "k", ylabel: "covariance", dots: true,
      curves: [sequence((k) => riccati_recursion(p.A, p.C, p.Q, p.R, p.P0, k), p.T)],
    },
  }),
};
const FILTERS = { continuous, discrete };

// ---------------------------------------------------------------------------------------------------- the page
function inputs(panel) {
  return [...panel.querySelectorAll("input[type=range]")];
}

function parameters(panel) {
  return Object.fromEntries(
    inputs(panel).map((i) => [i.name, valueOf(Number(i.value), i.dataset.scale, Number(i.dataset.per))]),
  );
}

function refresh(panel) {
  const kind = panel.dataset.panel;
  const p = parameters(panel);
  const { values, words } = FILTERS[kind](p);
  for (const input of inputs(panel)) {
    const value = shown(p[input.name]);
    panel.querySelector(`output[for="${input.id}"]`).textContent = value;
    input.setAttribute("aria-valuetext", `${value} ${input.dataset.unit}`);
  }
  for (const [name, value] of Object.entries(values)) {
    const place = panel.querySelector(`[data-value="${name}"]`);
    place.textContent = name === "limit" && Number.isNaN(value) ? "none" : shown(value);
    place.classList.toggle("undefined", Number.isNaN(value));
  }
  panel.querySelector(".words").textContent = words;
  for (const [name, plot] of Object.entries(PLOTS[kind](p, values))) {
    const svg = panel.querySelector(`svg[data-plot="${name}"]`);
    svg.innerHTML = drawing(plot);
    svg.setAttribute("aria-label", plot.words);
  }
}

function set(panel, values) {
  for (const input of inputs(panel)) {
    const { scale, per } = input.dataset;
    input.value = input.name in values ? positionOf(values[input.name], scale, Number(per)) : input.defaultValue;
  }
  refresh(panel);
}

if (typeof document !== "undefined") {
  for (const panel of document.querySelectorAll("[data-panel]")) {
    panel.addEventListener("input", () => refresh(panel));
    for (const button of panel.querySelectorAll("button[data-set]")) {
      button.addEventListener("click", () => set(panel, JSON.parse(button.dataset.set)));
    }
    refresh(panel);
  }
}
