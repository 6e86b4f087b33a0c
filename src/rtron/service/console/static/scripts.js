// Scripts that some views alone need: each is loaded once, when the first of them asks for it.
const BASE = document.currentScript.src;
const loading = new Map();

export function loadScript(name) {
  if (!loading.has(name)) loading.set(name, load(new URL(name, BASE)).catch((error) => {
    loading.delete(name);
    throw error;
  }));
  return loading.get(name);
}

function load(src) {
  return new Promise((resolve, reject) => {
    const script = Object.assign(document.createElement("script"), { src, onload: resolve });
    script.onerror = () => {
      script.remove();
      reject(new Error("a part of the console could not be loaded"));
    };
    document.head.append(script);
  });
}
