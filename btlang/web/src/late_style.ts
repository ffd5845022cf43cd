// Style sheets of screens that few people open, which come with them.
const adopted = new Set<string>();

/** Adds a style sheet to the page, once. */
export function addStyle(text: string): void {
  if (adopted.has(text)) return;
  adopted.add(text);
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(text);
  document.adoptedStyleSheets.push(sheet);
}
