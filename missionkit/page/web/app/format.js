// Numbers and times as words. An unknown value is a dash, never NaN.

const DASH = "–";

/** A number with three significant digits, and its unit. */
export function number(value, unit = "") {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  const size = Math.abs(value);
  const decimals = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 || size === 0 ? 2 : 3;
  const text = value.toFixed(decimals).replace("-", "−");
  return unit ? `${text} ${unit}` : text;
}

/** Seconds as "12.3 s" or "4:05". */
export function seconds(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  if (Math.abs(value) < 100) return `${value.toFixed(1)} s`;
  const whole = Math.round(value);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/** Time of a flight, "1:02.35". */
export function clock(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  const hundredths = Math.round(Math.max(value, 0) * 100);
  const minutes = Math.floor(hundredths / 6000);
  return `${minutes}:${((hundredths % 6000) / 100).toFixed(2).padStart(5, "0")}`;
}

/** A share of one as "80 %". */
export function percent(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  return `${Math.round(100 * value)} %`;
}

/** At most so many letters: a canvas has no ellipsis of its own. */
export function shortened(text, letters) {
  return text.length <= letters ? text : `${text.slice(0, Math.max(letters - 1, 1))}…`;
}
