// Small plots as SVG: the bar of colours, the histogram, and energies of vesicles.

/** @param {number} value */
export function short(value) {
  if (!Number.isFinite(value)) return value === Infinity ? "∞" : "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(3) : String(Number(value.toPrecision(5)));
  return text.replace("-", "−");
}

/** A value with its error bar, if there is one. @param {number | null} value @param {number | null | undefined} error */
export function withError(value, error) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (error === undefined || error === null || Number.isNaN(error)) return short(value);
  const bar = error === Infinity ? "∞" : Number(error.toPrecision(2)).toString();
  return `${short(value)} ± ${bar}`;
}

/** The bar of colours between two values. @param {number[]} range @param {string} title @param {number[][]} map */
export function colourBar([low, high], title, map) {
  const stops = map.filter((_, i) => i % 15 === 0).map((colour) => `rgb(${colour.join(" ")})`);
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((part) => `<span>${short(low + part * (high - low))}</span>`);
  return `<p class="small">${title}</p><div class="colours" style="background:linear-gradient(to right,${stops.join(",")})"></div>
    <div class="ticks small">${ticks.join("")}</div>`;
}

/** How many values lie where in a range. @param {Float64Array} values @param {number[]} range @param {string} unit */
export function histogram(values, [low, high], unit) {
  const columns = 40;
  const counts = new Array(columns).fill(0);
  let [known, outside] = [0, 0];
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    known += 1;
    if (value < low || value > high) outside += 1;
    else counts[Math.min(columns - 1, Math.floor((columns * (value - low)) / (high - low)))] += 1;
  }
  const most = Math.max(...counts, 1);
  const bars = counts.map((count, i) => `<rect class="column" x="${9 * i}" y="${80 - (78 * count) / most}" width="8" height="${(78 * count) / most}"/>`);
  const label = `Histogram of ${known} values from ${short(low)} to ${short(high)} ${unit}, ${outside} outside`;
  return { label, svg: `<svg viewBox="0 0 360 98">${bars.join("")}<path class="axis" d="M0 80.5H360"/>
    <text y="94">${short(low)}</text><text x="180" y="94" text-anchor="middle">${outside ? `${outside} outside` : unit}</text><text x="360" y="94" text-anchor="end">${short(high)}</text></svg>` };
}

/** Energies over 8πκ against the reduced volume: branches of the theory, and a relaxation.
 * @param {{name: string, points: number[][]}[]} branches @param {number} volume @param {number[]} energies */
export function energies(branches, volume, energies) {
  const most = Math.max(2.4, Math.min(4, ...energies.slice(0, 1)));
  const x = (/** @type {number} */ v) => 34 + ((v - 0.45) / 0.55) * 320;
  const y = (/** @type {number} */ energy) => 140 - ((Math.min(energy, most) - 1) / (most - 1)) * 130;
  const colours = ["var(--accent)", "var(--faint)", "var(--ink)"];
  const curves = branches.map(({ name, points }, i) => {
    const shown = points.filter(([, energy]) => energy <= most);
    const line = shown.map(([v, energy]) => `${x(v).toFixed(1)} ${y(energy).toFixed(1)}`).join("L");
    return `<path class="curve" style="stroke:${colours[i % 3]}" stroke-dasharray="${["", "6 3", "2 3"][i % 3]}" d="M${line}"/>
      <path class="curve" style="stroke:${colours[i % 3]}" stroke-dasharray="${["", "6 3", "2 3"][i % 3]}" d="M${200} ${14 + 14 * i}h24"/><text x="230" y="${18 + 14 * i}">${name}</text>`;
  });
  const last = energies.at(-1) ?? 1;
  const marks = [0.5, 0.6, 0.7, 0.8, 0.9, 1].map((v) => `<text x="${x(v)}" y="154" text-anchor="middle">${v}</text>`);
  const rows = [1, 1.5, 2, ...(most > 2.5 ? [3] : [])].map((energy) => `<text x="28" y="${y(energy) + 4}" text-anchor="end">${energy}</text><path class="axis" d="M34 ${y(energy)}H354"/>`);
  return `<svg viewBox="0 0 360 172">${rows.join("")}${curves.join("")}
    <path class="trail" d="M${x(volume)} ${y(energies[0] ?? last)}V${y(last)}"/><circle class="here" cx="${x(volume)}" cy="${y(last)}" r="4"/>
    ${marks.join("")}<text x="194" y="168" text-anchor="middle">reduced volume</text><text x="34" y="8">energy / 8πκ</text></svg>`;
}
