// What every view is written with. Names, reasons and messages are always text, never markup.
export { html, render, useState, useEffect, useLayoutEffect, useRef, useMemo, useCallback, Component } from "./vendor/preact.js";
