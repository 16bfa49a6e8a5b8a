// Keys are places; on a keyboard with other letters on them the help and the buttons show those
// letters instead.

interface KeyboardLayout {
  getLayoutMap?: () => Promise<ReadonlyMap<string, string>>;
}

/**
 * Rewrites the text of every `[data-code]`, where the browser tells what is printed on the keys.
 */
export async function label_keys(): Promise<void> {
  const keyboard = (navigator as Navigator & { keyboard?: KeyboardLayout }).keyboard;
  let layout: ReadonlyMap<string, string> | undefined;
  try {
    layout = await keyboard?.getLayoutMap?.();
  } catch {
    // Not allowed here (an embedded page): the letters of the most common layout stay.
  }
  if (layout === undefined) return;
  for (const key of Array.from(document.querySelectorAll<HTMLElement>("[data-code]"))) {
    const letter = layout.get(key.dataset["code"] ?? "");
    if (letter !== undefined && letter.trim().length === 1) key.textContent = letter.toUpperCase();
  }
}
