// What all who are logged in need: which robots there are, what they do, and the emergency stop.
const CONFIRMED = 1000; // milliseconds in which a robot has to say that it was stopped
const OLD = 2; // seconds after which a reading is shown as old
const OVER = ["completed", "failed", "canceled", "killed", "error", "skipped"];
const alertText = document.querySelector("[role=alert]");
const robots = new Map();
let csrf = "";
let stopPort = 0;

const send = (path, data, signal) =>
  fetch(path, {
    method: "POST",
    headers: { "content-type": "application/json", "x-csrf-token": csrf },
    body: JSON.stringify(data),
    signal,
  });

const done = async (answer) => {
  if (!(await answer).ok) throw new Error();
};

async function stop(robot) {
  const signal = AbortSignal.timeout(CONFIRMED);
  const ways = [done(send("/api/stop", { robot }, signal))];
  if (stopPort) {
    const place = `${location.protocol}//${location.hostname}:${stopPort}/api/stop`;
    const headers = { "content-type": "text/plain" }; // so that the browser sends it without asking first
    ways.push(done(fetch(place, { method: "POST", credentials: "include", headers, body: JSON.stringify({ robot, csrf }), signal })));
  }
  try {
    await Promise.any(ways);
    alertText.textContent = `${robot} is stopped.`;
  } catch {
    alertText.textContent = `${robot} HAS NOT CONFIRMED THE STOP: stop it where it stands.`;
  }
}

async function release(robot) {
  const answer = await send("/api/commands", { command: "release", robot });
  alertText.textContent = answer.ok ? "" : (await answer.json()).text;
}

function shown(name) {
  if (!robots.has(name)) {
    const section = document.querySelector("template").content.firstElementChild.cloneNode(true);
    section.querySelector("h2").textContent = name;
    section.querySelector(".stop").addEventListener("click", () => stop(name));
    section.querySelector(".release").addEventListener("click", () => release(name));
    const list = document.querySelector("#robots");
    if (robots.size === 0) list.replaceChildren();
    list.append(section);
    robots.set(name, { section, tasks: new Map(), state: "", read: -Infinity, least: Infinity });
  }
  return robots.get(name);
}

function take(message, socket) {
  if (message.type === "result" && message.id && message.ok) taken(message.id, message.data.tasks);
  if (message.robot === undefined) return;
  const known = shown(message.robot);
  const { section, tasks } = known;
  if (message.type === "up") {
    Object.assign(known, { state: "up", read: -Infinity, least: Infinity });
    socket.send(JSON.stringify({ id: message.robot, command: "list", robot: message.robot }));
  }
  if (message.type === "away") known.state = "away";
  if (message.type === "ages") {
    const now = performance.now() / 1000;
    known.least = Math.min(known.least, now - message.t); // what comes later than this was on its way for long
    known.read = message.state === null ? -Infinity : known.least + message.t - message.state;
  }
  if (message.type === "robot") {
    const battery = message.battery === null ? "" : `, battery ${Math.round(message.battery)}%`;
    known.state = (message.hindrance || "ready") + battery;
    section.querySelector(".release").hidden = !message.stopped;
  }
  if (message.type === "change") {
    if (OVER.includes(message.state)) tasks.delete(message.task);
    else tasks.set(message.task, message.state);
    list(section, tasks);
  }
  show(known);
}

function show({ section, state, read }) {
  const age = performance.now() / 1000 - read;
  const isOld = !["away", "no connection", ""].includes(state) && age > OLD;
  const old = isOld ? (age === Infinity ? " (not read yet)" : ` (${Math.floor(age)} s old)`) : "";
  if (section.querySelector(".state").textContent !== state + old) section.querySelector(".state").textContent = state + old;
}

function list(section, tasks) {
  const line = ([task, state]) => Object.assign(document.createElement("li"), { textContent: `Task ${task}: ${state}` });
  section.querySelector(".tasks").replaceChildren(...[...tasks].map(line));
}

function taken(name, listed) {
  const { section, tasks } = shown(name);
  tasks.clear();
  for (const task of listed) tasks.set(task.id, task.state);
  list(section, tasks);
}

function follow() {
  const socket = new WebSocket(`${location.origin.replace("http", "ws")}/api/ws`);
  socket.addEventListener("open", () => socket.send(JSON.stringify({ type: "subscribe", topics: ["robot", "tasks"], rate: 2 })));
  socket.addEventListener("message", (event) => take(JSON.parse(event.data), socket));
  socket.addEventListener("close", (event) => {
    if (event.code === 4001) return location.assign("/login");
    for (const known of robots.values()) show(Object.assign(known, { state: "no connection" }));
    setTimeout(follow, 1000);
  });
}

document.querySelector("#leave").addEventListener("click", async () => {
  await send("/api/logout", {});
  location.assign("/login");
});

const me = await fetch("/api/me");
if (!me.ok) location.assign("/login");
else {
  const { user, role, csrf: token, stop: port = 0 } = await me.json();
  csrf = token;
  stopPort = port;
  document.querySelector("#who").textContent = `${user} (${role})`;
  follow();
  setInterval(() => robots.forEach(show), 250);
}
