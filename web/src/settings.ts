// What the page remembers in this browser and what its address asks for. Storage may be forbidden
// and then throws.

export interface PageOptions {
  /** Start playing without the help or a click (tests). */
  autostart: boolean;
  /** Fixed size of the view in pixels; null fits the window. */
  size: { width: number; height: number } | null;
  name: string;
}

export function page_options(search: string): PageOptions {
  const parameters = new URLSearchParams(search);
  const width = even_within(parameters.get("w"), 160, 1920);
  const height = even_within(parameters.get("h"), 90, 1080);
  return {
    autostart: parameters.has("autostart"),
    size: width !== null && height !== null ? { width, height } : null,
    name: (parameters.get("name") ?? "").slice(0, 24),
  };
}

function even_within(text: string | null, min: number, max: number): number | null {
  if (text === null || !/^\d{1,5}$/.test(text)) return null;
  return Math.min(max, Math.max(min, Number(text) & ~1));
}

export type Store = "localStorage" | "sessionStorage";

export function remember(store: Store, key: string, value: string): void {
  try {
    window[store].setItem(`aureole.${key}`, value);
  } catch {
    // A private window or a full store: the page works, it only forgets.
  }
}

export function recall(store: Store, key: string): string | null {
  try {
    return window[store].getItem(`aureole.${key}`);
  } catch {
    return null;
  }
}
