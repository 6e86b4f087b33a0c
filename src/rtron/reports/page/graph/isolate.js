// Names and reasons that strangers chose, as text that can neither hide nor turn around what stands beside it.
const UNSEEN = /[\p{Cc}\p{Cf}\p{Co}\p{Zl}\p{Zp}]/gu, LINES = "\n\t";
const RIGHT_TO_LEFT = "[\\u0590-\\u08ff\\ufb1d-\\ufdff\\ufe70-\\ufefc\\u{10800}-\\u{10fff}\\u{1e800}-\\u{1efff}]";
const TURNED = new RegExp(`${RIGHT_TO_LEFT}(?:.*${RIGHT_TO_LEFT})?`, "gu");
const PLAIN = /^[\x20-\x7e]*$/;

// Characters that are not seen are written out; what runs from right to left keeps to itself (UAX #9, isolates).
export function isolated(text) {
  if (PLAIN.test(text)) return text;
  const seen = text.replace(UNSEEN, (character) => LINES.includes(character) ? character : `\u27e8U+${character.codePointAt(0).toString(16).toUpperCase().padStart(4, "0")}\u27e9`);
  return seen.replace(TURNED, "\u2068$&\u2069");
}
