// The texts of other languages than English, with sentences that servers and robots say. Loaded where one is chosen.
type Texts = Record<string, string>;

const LANGUAGES: Record<string, () => Promise<{ default: Texts }[]>> = {
  de: () => Promise.all([import("./texts/de.json"), import("./texts/sentences.de.json")]),
  es: () => Promise.all([import("./texts/es.json"), import("./texts/sentences.es.json")]),
};

/** The texts of a language, and what says an English text in it. */
export async function load(language: string): Promise<[Texts, (english: string) => string]> {
  const [texts, sentences] = await LANGUAGES[language]!();
  return [texts!.default, translator(sentences!.default)];
}

/** What says in a language what a server or robot says in English, as far as it has the sentences: templates such as
 *  "I don't see {name}".
 */
function translator(own: Texts): (english: string) => string {
  const patterns = Object.entries(own).map(([english, said]): [RegExp, string] => {
    const plain = english.replace(/[.?()]/g, "\\$&");
    return [new RegExp(`^${plain.replace(/\{(\w+)\}/g, "(?<$1>.+)")}$`), said];
  });
  const whole = (english: string): string | null => {
    for (const [pattern, said] of patterns) {
      const found = pattern.exec(english);
      if (found) return said.replace(/\{(\w+)\}/g, (_, name: string) => value(found.groups![name]!));
    }
    return null;
  };
  // Kinds of things, such as "place, person or door", are said in the language; names and examples stay.
  const value = (english: string): string => {
    const parts = english.split(/(, | or )/).map((part) => (part === ", " ? part : part === " or " ? ` ${whole("or")} ` : whole(part)));
    return parts.includes(null) ? english : parts.join("");
  };
  const ending = (english: string): string => english.replace(/(?<=: )[^:]+$/, (end) => whole(end) ?? end); // "go to lab: it is not true"
  return (english) => whole(english) ?? english.split(/(\n|(?<=[.!?]) (?=[A-Z]))/).map((part) => whole(part) ?? ending(part)).join("");
}
