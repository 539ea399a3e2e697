/** Number formatting. The rules are those of `text.rs` in feeler-report, so that static and interactive parts agree. */

/** Formats a number with three significant digits (integer parts are never rounded) and a typographic minus sign. A dash for NaN. */
export function significant(value: number): string {
  if (value === 0) return "0";
  if (Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value < 0 ? "\u2212∞" : "∞";
  const magnitude = Math.abs(value);
  const decimals = Math.min(Math.max(2 - Math.floor(Math.log10(magnitude)), 0), 9);
  const digits = magnitude.toFixed(decimals);
  const text = digits.includes(".") ? digits.replace(/\.?0+$/, "") : digits;
  return value < 0 && text !== "0" ? `\u2212${text}` : text;
}

/** Formats a value in SI units, multiplied by `scale`, with `unit`. Returns a dash if the value is unknown. */
export function quantity(value: number, unit: string, scale = 1): string {
  if (!Number.isFinite(value)) return "–";
  return unit ? `${significant(value * scale)}\u00a0${unit}` : significant(value * scale);
}

/** Formats a time in hundredths of a second, because rows are 10 ms apart. */
export function moment(seconds: number): string {
  return Number.isFinite(seconds) ? `${signed(seconds, 2)}\u00a0s` : "–";
}

/** Formats a tick label with as many decimals as the tick spacing `step`. */
export function tick(value: number, step: number): string {
  let decimals = 0;
  const whole = (scaled: number) => Math.abs(scaled - Math.round(scaled)) < 1e-6;
  while (decimals < 9 && !whole(step * 10 ** decimals)) decimals++;
  return signed(value, decimals);
}

function signed(value: number, decimals: number): string {
  const text = Math.abs(value).toFixed(decimals);
  return value < 0 && Number(text) !== 0 ? `\u2212${text}` : text;
}
