// A button that does nothing on a click: it wants to be held, and released inside.
import { html, useEffect, useRef, useState } from "./html.js";
import { DANGEROUS, HOLD, expired, press, progress, release } from "./hold_press.js";

/**
 * One action.
 *
 * label: what it does, in a word. offered: whether it may be confirmed now; a press is withdrawn
 * when that ends. dangerous: needs 1.5 s. onConfirm({held, at}): ms held, and when released
 * (performance.now()). onHint(sentence): why a press did nothing.
 */
export function HoldButton({ label, note, kind, offered, dangerous, onConfirm, onHint }) {
  const button = useRef(null);
  const held = useRef(null);
  const [shown, show] = useState(null); // null, or {share, outside}
  const needs = dangerous ? DANGEROUS : HOLD;

  function begin(event) {
    if (!offered) return onHint(`${label} is not offered now.`);
    if (held.current) return;
    held.current = press(event.timeStamp, needs);
    show({ share: 0, outside: false });
  }

  function cancel(sentence) {
    if (!held.current) return;
    held.current = null;
    show(null);
    if (sentence) onHint(sentence);
  }

  function end(event, inside) {
    if (!held.current) return;
    const pressed = held.current;
    held.current = null;
    show(null);
    const said = release(pressed, event.timeStamp, inside);
    if (said === "confirmed") {
      onConfirm({ held: Math.round(event.timeStamp - pressed.at), at: event.timeStamp });
    } else onHint(hints(label, needs)[said]);
  }

  useEffect(() => {
    if (!offered) cancel(`${label} is no longer offered. Nothing was sent.`);
  }, [offered]);

  useEffect(() => {
    if (!shown) return undefined;
    const frame = requestAnimationFrame((now) => {
      if (!held.current) return;
      if (expired(held.current, now)) cancel(hints(label, needs).expired);
      else show({ ...shown, share: progress(held.current, now) });
    });
    return () => cancelAnimationFrame(frame);
  }, [shown]);

  const inside = (event) => contains(button.current.getBoundingClientRect(), event);
  const ready = shown?.share >= 1;
  return html`<button
    ref=${button}
    type="button"
    class=${`hold ${kind}${shown ? " pressed" : ""}${ready ? " ready" : ""}${shown?.outside ? " outside" : ""}`}
    aria-disabled=${offered ? "false" : "true"}
    aria-description=${`hold ${needs / 1000} s, then release`}
    onPointerDown=${(event) => {
      if (event.button !== 0) return;
      button.current.setPointerCapture(event.pointerId);
      begin(event);
    }}
    onPointerMove=${(event) => {
      const outside = !inside(event);
      if (shown && outside !== shown.outside) show({ ...shown, outside });
    }}
    onPointerUp=${(event) => end(event, inside(event))}
    onPointerCancel=${() => cancel(`The press was interrupted. Nothing was sent.`)}
    onContextMenu=${(event) => event.preventDefault()}
    onKeyDown=${(event) => {
      if (event.key === "Escape") cancel(hints(label, needs).outside);
      if (!isPress(event)) return;
      event.preventDefault();
      if (!event.repeat) begin(event);
    }}
    onKeyUp=${(event) => {
      if (!isPress(event)) return;
      event.preventDefault();
      end(event, true);
    }}
    onBlur=${() => cancel(`The press was interrupted. Nothing was sent.`)}
  >
    <span class="fill" aria-hidden="true" style=${{ transform: `scaleX(${shown?.share ?? 0})` }}></span>
    <span class="word">${label}</span>
    <span class="small">${said(shown, ready, note, needs)}</span>
  </button>`;
}

function said(shown, ready, note, needs) {
  if (shown?.outside) return "release cancels";
  if (ready) return "release to send";
  if (shown) return "keep holding …";
  return note || `hold ${needs / 1000} s`;
}

function isPress(event) {
  return event.key === " " || event.key === "Enter";
}

function contains(box, { clientX: x, clientY: y }) {
  return x >= box.left && x <= box.right && y >= box.top && y <= box.bottom;
}

function hints(label, needs) {
  return {
    short: `Hold ${label} for ${needs / 1000} s, then release. Nothing was sent.`,
    outside: `Cancelled. Nothing was sent.`,
    expired: `${label} was held for more than 5 s. Nothing was sent.`,
  };
}
