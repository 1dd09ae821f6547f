// A canvas that is drawn again when the signals it reads change, at most once a frame.
import { effect, useEffect, useRef } from "./html.js";
import { theme } from "./theme.js";

/**
 * Return a ref for a canvas. `read` reads the signals that matter; `draw` draws the canvas.
 * `every`: ms between two drawings at least.
 */
export function useCanvas(read, draw, every = 0) {
  const canvas = useRef(null);
  const drawing = useRef(draw);
  drawing.current = draw;
  useEffect(() => {
    let frame = 0;
    let last = -Infinity;
    const paint = (now) => {
      frame = 0;
      if (now - last < every) return void (frame = requestAnimationFrame(paint));
      last = now;
      if (canvas.current?.clientWidth) drawing.current(canvas.current);
    };
    const soon = () => (frame ||= requestAnimationFrame(paint));
    const stop = effect(() => {
      theme.value;
      read();
      soon();
    });
    const watcher = new ResizeObserver(soon);
    watcher.observe(canvas.current);
    return () => {
      stop();
      watcher.disconnect();
      cancelAnimationFrame(frame);
    };
  }, []);
  return canvas;
}
