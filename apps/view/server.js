// What the page asks of the program (apps/view/view_api.h). The token of the printed address goes with every
// request, in a header that pages of other sites may not set.

const kToken = location.hash.slice(1);

// {status, json, data}: `data` are the bytes behind the JSON of a framed answer, else empty.
export async function ask(path, body) {
  const options = {headers: {'X-Sonarcal-Token': kToken}, cache: 'no-store'};
  if (body !== undefined) {
    options.method = 'POST';
    options.headers['Content-Type'] = 'application/json';
    options.body = JSON.stringify(body);
  }
  let answer;
  try {
    answer = await fetch(path, options);
  } catch {
    return {status: 0, json: {error: 'The program does not answer: it has ended, or its machine is asleep.'}};
  }
  if (answer.status === 204) return {status: 204, json: {}, data: new ArrayBuffer(0)};
  const type = answer.headers.get('Content-Type') || '';
  if (type.startsWith('application/json')) return {status: answer.status, json: await answer.json()};
  if (!type.startsWith('application/octet-stream')) {
    return {status: answer.status, json: {error: (await answer.text()).trim()}};
  }
  const bytes = await answer.arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  return {status: answer.status, json, data: bytes.slice(4 + length)};
}

// Grey values, bins x beams, of a framed image.
export function greyOf(answer) {
  const {bins, beams, bytes, full_scale: fullScale, axes} = answer.json;
  const values = bytes === 2 ? new Uint16Array(answer.data) : new Uint8Array(answer.data);
  return {bins, beams, fullScale, axes, values};
}

// One question at a time, and after it the newest that was asked meanwhile, if any: what a slider passes on its
// way is never waited for.
export class Latest {
  constructor(run) {
    this.run = run;
    this.busy = false;
    this.wanted = false;
  }

  async want() {
    this.wanted = true;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.wanted) {
        this.wanted = false;
        await this.run();
      }
    } finally {
      this.busy = false;
    }
  }
}
