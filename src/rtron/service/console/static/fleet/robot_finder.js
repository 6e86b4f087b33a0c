// A robot among very many, found by typing a part of its name.
import { html, useState } from "../html.js";

const MOST = 50;

// `onChange(name)` is called with a name that there is, or with "" where `empty` is a choice.
export function RobotFinder({ id, names, value, empty, hint, onChange }) {
  const [text, setText] = useState(null), wanted = (text ?? "").toLowerCase();
  const found = names.filter((name) => name.toLowerCase().includes(wanted)).slice(0, MOST);
  const take = (typed) => {
    const isName = names.includes(typed) || (empty && !typed);
    setText(isName ? null : typed);
    if (isName && typed !== value) onChange(typed);
  };
  return html`<input id=${id} list=${`${id}-names`} aria-label="Robot" placeholder=${empty ?? hint} value=${text ?? value} autocomplete="off" spellcheck="false"
    onFocus=${(e) => e.target.select()} onInput=${(e) => take(e.target.value)} onBlur=${() => setText(null)} />
    <datalist id=${`${id}-names`}>${found.map((name) => html`<option value=${name} />`)}</datalist>`;
}
