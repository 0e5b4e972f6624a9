// What the page asks the server for. Every question names itself as the page's; the token is a cookie.

export class Refused extends Error {
  constructor(message, status = null) {
    super(message);
    this.status = status;
  }
}
export const TAB = Math.random().toString(36).slice(2);

async function ask(address, options = {}) {
  let answer;
  try {
    answer = await fetch(address, { ...options, headers: { "x-vmach": "1", ...options.headers } });
  } catch {
    throw new Refused("the workbench does not answer: was it closed?");
  }
  if (answer.ok) return answer;
  const told = await answer.json().catch(() => ({}));
  throw new Refused(told.error ?? `the server answers ${answer.status}`, answer.status);
}

export const get = async (address) => (await ask(address)).json();
export const post = async (address, what = {}) =>
  (await ask(address, { method: "POST", body: JSON.stringify(what) })).json();
export const put = async (address, what) =>
  (await ask(address, { method: "PUT", body: JSON.stringify(what) })).json();
export const send = async (file, name = file.name) =>
  (await ask("/api/files/" + encodeURIComponent(name), { method: "PUT", body: file })).json();
export const bytes = async (address) => new Uint8Array(await (await ask(address)).arrayBuffer());

// A record and an array of float32.
async function unframed(answer) {
  const buffer = await answer.arrayBuffer(), length = new DataView(buffer).getUint32(0, true);
  const record = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return [record, new Float32Array(buffer, 4 + length)];
}
export const framed = async (address) => unframed(await ask(address));
export const postFramed = async (address, what) =>
  unframed(await ask(address, { method: "POST", body: JSON.stringify(what) }));
export const query = (values) => new URLSearchParams(
  Object.entries(values).filter(([, value]) => value !== null && value !== undefined)).toString();
// The address of a result in the folder: its name may have any character.
const inAddress = (name) => name.split("/").map(encodeURIComponent).join("/");
export const showAddress = (name) => "/show/" + inAddress(name);
export const downloadAddress = (name) => "/download/" + inAddress(name);
