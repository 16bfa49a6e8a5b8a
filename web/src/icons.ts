// Small line drawings for the things that can be thrown, chosen by what their name says.

const drawings: ReadonlyArray<readonly [RegExp, string]> = [
  [/ball|sphere|marble/i, '<circle cx="12" cy="12" r="7.5"/><path d="M8 9.2a5 5 0 0 1 3-2.4"/>'],
  [
    /barrel|cylinder|drum|log|\bcan\b/i,
    '<ellipse cx="12" cy="6" rx="6" ry="2.5"/><path d="M6 6v12c0 1.4 2.7 2.5 6 2.5s6-1.1 6-2.5V6"/>',
  ],
  [/capsule|pill/i, '<rect x="7.5" y="3.5" width="9" height="17" rx="4.5"/><path d="M7.5 12h9"/>'],
  [
    /hull|rock|stone|gem|crystal|convex/i,
    '<path d="M12 3.5 19 9l-2 9.5H7L5 9z"/><path d="M5 9h14M12 3.5 9.5 9l2.5 9.5L14.5 9z"/>',
  ],
  [
    /compound|jack|dumb|hammer|cross|star/i,
    '<circle cx="6.5" cy="12" r="3.2"/><circle cx="17.5" cy="12" r="3.2"/><path d="M9.7 12h4.6"/>',
  ],
  [
    /domino|plank|slab|board/i,
    '<path d="M8 4.5h6l2.5 2v13h-6L8 17.5z"/><path d="m8 4.5 2.5 2h6M10.5 6.5v13"/>',
  ],
];

const box =
  '<path d="m12 3.5 7.5 4.2v8.6L12 20.5l-7.5-4.2V7.7z"/><path d="m4.5 7.7 7.5 4.3 7.5-4.3M12 12v8.5"/>';

export function icon_of(name: string): SVGSVGElement {
  const drawing = drawings.find(([pattern]) => pattern.test(name))?.[1] ?? box;
  const holder = document.createElement("div");
  holder.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true">${drawing}</svg>`;
  return holder.firstElementChild as SVGSVGElement;
}
