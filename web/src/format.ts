/**
 * Numbers as a reader would write them. One rule, the same as `text.rs` of feeler-report has, so that page and program
 * say the same.
 */

/** Three significant digits (whole numbers to all), with a true minus sign. */
export function significant(value: number): string {
  if (value === 0 || !Number.isFinite(value)) return "0";
  const magnitude = Math.abs(value);
  const decimals = Math.min(Math.max(2 - Math.floor(Math.log10(magnitude)), 0), 9);
  const digits = magnitude.toFixed(decimals);
  const text = digits.includes(".") ? digits.replace(/\.?0+$/, "") : digits;
  return value < 0 && text !== "0" ? `\u2212${text}` : text;
}

/** A value in SI units with its unit, in which it is `scale` times as large; a dash where it is not known. */
export function quantity(value: number, unit: string, scale = 1): string {
  if (!Number.isFinite(value)) return "–";
  return unit ? `${significant(value * scale)}\u00a0${unit}` : significant(value * scale);
}

/** A moment of a run. Rows are 10 ms apart, so it has hundredths: three digits would give many rows one name. */
export function moment(seconds: number): string {
  return Number.isFinite(seconds) ? `${signed(seconds, 2)}\u00a0s` : "–";
}

/** A tick's label: as many decimals as its distance from its neighbours, `step`, has. */
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
