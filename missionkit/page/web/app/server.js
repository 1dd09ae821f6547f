// Requests to the server. Answers are data or a sentence that says what was wrong.

let csrf = "";

/** Ask for an answer in JSON; throws an Error whose message is the server's sentence. */
export async function get(path, values = {}) {
  const query = new URLSearchParams(values).toString();
  return answer(await fetch(query ? `${path}?${query}` : path, { cache: "no-store" }));
}

/** Send JSON; `wait` is how long an answer may take (ms). */
export async function post(path, body, wait = 10000) {
  const response = await fetch(path, {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-CSRF": csrf },
    body: JSON.stringify(body),
    signal: AbortSignal.timeout(wait),
  });
  return answer(response);
}

/** Open a session with the token of the address, or with the cookie of an earlier one. */
export async function openSession(token) {
  const session = await post("/api/session", token ? { token } : {});
  csrf = session.csrf ?? "";
  return session;
}

export class Refused extends Error {
  constructor(sentence, status) {
    super(sentence);
    this.status = status;
  }
}

async function answer(response) {
  const text = await response.text();
  let body = {};
  try {
    body = text ? JSON.parse(text) : {};
  } catch {
    body = { error: `the server's answer is not JSON (${response.status})` };
  }
  if (!response.ok || body.error) {
    throw new Refused(body.error ?? `the server answered ${response.status}`, response.status);
  }
  return body;
}
